// The fields of packets, and the order in which a pixel's contributions are added.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "kernels/shared/packet.h"
#include "tests/torus/random_torus.hpp"

using namespace raya;

namespace {

constexpr std::uint32_t kLastLevel = 31;  // level of a ray after the maximum number of bounces

struct Contribution {
    std::uint32_t path, state;
    bool operator==(const Contribution&) const = default;
};

// The contributions of a random ray tree in the order of a recursive ray tracer: those of a ray, then those of its
// reflected subtree, then those of its refracted subtree. Chains of only reflections or only refractions often reach
// the last level.
struct RandomTree {
    SplitMix random;
    std::uint32_t last_level = kLastLevel;
    std::uint32_t max_contributions = 400;  // the tree stops growing at this number
    std::vector<Contribution> contributions{};

    void add(std::uint32_t path, std::uint32_t level, std::uint32_t light) {
        contributions.push_back({path, raya_state(RAYA_KIND_RETURN, level, light)});
    }

    void add_subtree(std::uint32_t path, std::uint32_t level) {
        add(path, level, 0);
        for (std::uint32_t light = 1; light <= 3; ++light)
            if (random.next() % 2) add(path, level, light);
        if (random.next() % 16 == 0) add(path, level, RAYA_MAX_LIGHTS);
        if (level == last_level || contributions.size() > max_contributions) return;
        // Of 64 values, 14 add both rays, 24 only a reflected ray, 24 only a refracted ray and 2 no ray.
        const std::uint64_t choice = random.next() % 64;
        if (choice < 38) add_subtree(raya_path_reflected(path), level + 1);
        if (choice < 14 || (choice >= 38 && choice < 62)) add_subtree(raya_path_refracted(path, level), level + 1);
    }
};

std::vector<Contribution> shuffled(std::vector<Contribution> all, SplitMix& random) {
    for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random_below(random, i)]);
    return all;
}

}  // namespace

TEST_CASE("contributions sort into the depth-first order of the ray tree, reflected before refracted", "[torus]") {
    std::uint32_t deepest = 0;
    std::size_t largest = 0;
    for (std::uint64_t seed = 1; seed <= 500; ++seed) {
        SplitMix random(seed);
        RandomTree tree{random, 1 + random_below(random, kLastLevel)};
        tree.add_subtree(0, 0);
        std::vector<Contribution> sorted = shuffled(tree.contributions, random);
        std::sort(sorted.begin(), sorted.end(), [](const Contribution& a, const Contribution& b) {
            return raya_comes_before(a.path, a.state, b.path, b.state);
        });
        CAPTURE(seed, tree.last_level, sorted.size());
        CHECK(sorted == tree.contributions);
        for (const Contribution& c : sorted) deepest = std::max(deepest, raya_state_level(c.state));
        largest = std::max(largest, sorted.size());
    }
    CHECK(deepest == kLastLevel);
    CHECK(largest > 100);
}

TEST_CASE("the contributions of a complete tree of ten levels sort into the tree's order", "[torus]") {
    struct CompleteTree {
        std::vector<Contribution> contributions{};
        void add_subtree(std::uint32_t path, std::uint32_t level) {
            for (const std::uint32_t light : {0u, 1u})
                contributions.push_back({path, raya_state(RAYA_KIND_RETURN, level, light)});
            if (level == 9) return;
            add_subtree(raya_path_reflected(path), level + 1);
            add_subtree(raya_path_refracted(path, level), level + 1);
        }
    } tree;
    tree.add_subtree(0, 0);
    SplitMix random(7);
    std::vector<Contribution> sorted = shuffled(tree.contributions, random);
    std::sort(sorted.begin(), sorted.end(), [](const Contribution& a, const Contribution& b) {
        return raya_comes_before(a.path, a.state, b.path, b.state);
    });
    CHECK(sorted.size() == 2046);
    CHECK(sorted == tree.contributions);
}

TEST_CASE("a path has one bit per level, from the highest bit down", "[torus]") {
    std::uint32_t path = 0;
    for (std::uint32_t level = 0; level < kLastLevel; ++level) {
        CHECK(raya_path_refracted(0, level) == 1u << (31 - level));
        CHECK(raya_path_reflected(path) == path);
        path = raya_path_refracted(path, level);
    }
    CHECK(path == 0xfffffffeu);
}

TEST_CASE("kind, level, light and flags of a packet's state do not overlap", "[torus]") {
    const std::uint32_t flags = RAYA_STATE_WIDE | RAYA_STATE_FOUND | RAYA_STATE_FRESH | RAYA_STATE_CHARGED;
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
        SplitMix random(seed);
        const std::uint32_t kind = random_below(random, RAYA_KINDS), level = random_below(random, kLastLevel + 1);
        const std::uint32_t light = random_below(random, RAYA_MAX_LIGHTS + 1);
        const std::uint32_t plain = raya_state(kind, level, light);
        CAPTURE(seed, kind, level, light);
        CHECK((plain & flags) == 0);
        for (const std::uint32_t state : {plain, plain | flags}) {
            CHECK(raya_state_kind(state) == kind);
            CHECK(raya_state_level(state) == level);
            CHECK(raya_state_light(state) == light);
            CHECK(raya_packet_words(state) == (kind == RAYA_KIND_RETURN ? 8u : 16u));
        }
    }
    CHECK(raya_state_light(raya_state(RAYA_KIND_SHADOW, kLastLevel, RAYA_MAX_LIGHTS)) == RAYA_MAX_LIGHTS);
}
