// The order in which a pixel's contributions are added: that of the pixel's ray tree, not of their arrival. The fields
// of packets that determine this order.
#include <algorithm>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "host/torus/torus_renderer.hpp"
#include "tests/scene/random_below.hpp"

namespace raya {
namespace {

// Generates the contributions of a random ray tree in the order that is expected after sorting: depth first, reflection
// before refraction.
class RandomRayTree {
  public:
    RandomRayTree(SplitMix& random, std::vector<raya_head>& packets, std::uint32_t pixel)
        : random_(random), packets_(packets), pixel_(pixel) {}

    void add_ray(std::uint32_t path, std::uint32_t level, std::uint32_t deepest) {
        add(path, level, 0);
        for (std::uint32_t light = 1; light <= 3; ++light)
            if (below(2)) add(path, level, light);
        if (below(6) == 0) add(path, level, RAYA_MAX_LIGHTS);
        if (level == deepest) return;
        const std::uint32_t children = level < 3 ? 1 + below(3) : 1u << below(2);  // bit 0: reflected, bit 1: refracted
        if (children & 1) add_ray(raya_path_reflected(path), level + 1, deepest);
        if (children & 2) add_ray(raya_path_refracted(path, level), level + 1, deepest);
    }

    std::uint32_t below(std::uint32_t end) { return random_below(random_, end); }

  private:
    void add(std::uint32_t path, std::uint32_t level, std::uint32_t light) {
        raya_head p{};
        p.pixel = pixel_;
        p.state = raya_state(RAYA_KIND_RETURN, level, light) | (below(2) ? RAYA_STATE_FRESH : 0);
        p.path = path;
        p.weight = static_cast<float>(1 + below(1 << 23));
        for (float& colour : p.carries.colour) colour = static_cast<float>(1 + below(1 << 23));
        packets_.push_back(p);
    }

    SplitMix& random_;
    std::vector<raya_head>& packets_;
    std::uint32_t pixel_;
};

void shuffle(std::vector<raya_head>& packets, SplitMix& random) {
    for (std::size_t i = packets.size(); i > 1; --i) std::swap(packets[i - 1], packets[random_below(random, i)]);
}

std::vector<float> colours_of(const std::vector<raya_head>& packets) {
    std::vector<float> colours;
    for (const raya_head& p : packets) {
        colours.insert(colours.end(), std::begin(p.carries.colour), std::end(p.carries.colour));
        colours.push_back(p.weight);
    }
    return colours;
}

}  // namespace

TEST_CASE("contributions are sorted in depth-first order of their pixels' trees", "[torus]") {
    const std::uint64_t seed = 311;
    for (std::uint64_t i = 0; i < 300; ++i) {
        CAPTURE(seed, i);
        SplitMix random(seed + i);
        const std::uint32_t pixels = 1 + random_below(random, 12);
        std::vector<raya_head> expected;
        std::vector<std::uint32_t> starts = {0};
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
            RandomRayTree tree(random, expected, pixel);
            if (tree.below(4)) tree.add_ray(0, 0, tree.below(6) ? tree.below(6) : 31);
            starts.push_back(static_cast<std::uint32_t>(expected.size()));
        }
        std::vector<raya_head> returns = expected;
        shuffle(returns, random);
        const Contributions sorted = sort_contributions(returns, pixels);
        CHECK(sorted.starts == starts);
        CHECK((sorted.colours == colours_of(expected)));
        if (returns.empty()) continue;
        CHECK_THROWS_AS(sort_contributions(returns, returns.front().pixel), std::logic_error);  // outside the image
        returns.push_back(returns.front());
        returns.back().state ^= RAYA_STATE_FRESH;  // not part of the contribution's identity
        CHECK_THROWS_AS(sort_contributions(returns, pixels), std::logic_error);
    }
}

TEST_CASE("kind, level, light and flags of a packet's state do not overlap", "[torus]") {
    const std::uint32_t flags = RAYA_STATE_WIDE | RAYA_STATE_FOUND | RAYA_STATE_FRESH | RAYA_STATE_CHARGED;
    SplitMix random(1);
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t kind = random_below(random, RAYA_KINDS), level = random_below(random, 32);
        const std::uint32_t light = i ? random_below(random, RAYA_MAX_LIGHTS + 1) : RAYA_MAX_LIGHTS;
        const std::uint32_t plain = raya_state(kind, level, light);
        CAPTURE(kind, level, light);
        CHECK((plain & flags) == 0);
        for (const std::uint32_t state : {plain, plain | flags}) {
            CHECK(raya_state_kind(state) == kind);
            CHECK(raya_state_level(state) == level);
            CHECK(raya_state_light(state) == light);
        }
    }
}

}  // namespace raya
