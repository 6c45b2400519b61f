// The composer adds each pixel's contributions in the order of the pixel's ray tree, not in their order of arrival, and
// rounds once per addition.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <stdexcept>

#include "host/cl/kernel_options.hpp"
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

// Returns random contributions in the format, one list per pixel; some lists are empty. In the reduced formats,
// products and sums of the numbers are multiples of 2^-38 below 2^12, so that they are exact in double.
Contributions random_lists(SplitMix& random, const NumberFormat& format, std::uint32_t pixels) {
    Contributions lists;
    lists.starts = {0};
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        const std::uint32_t count = random_below(random, 5) ? random_below(random, 60) : 0;
        for (std::uint32_t i = 0; i < 4 * count; ++i) {
            const double number = std::ldexp(random.uniform(1, 2), -static_cast<int>(random_below(random, 4)));
            const bool zero = random_below(random, 20) == 0;
            lists.colours.push_back(zero ? 0 : round_to_format(number, format));
        }
        lists.starts.push_back(lists.starts.back() + count);
    }
    return lists;
}

// Returns c * w + sum, rounded once.
float add_to(float sum, float c, float w, const NumberFormat& format) {
    if (format.is_fp32()) return std::fma(c, w, sum);
    return round_to_format(std::fma(static_cast<double>(c), w, sum), format);
}

// Returns the expected image: red, green and blue of each pixel.
std::vector<float> sums_of(const Contributions& lists, const NumberFormat& format) {
    std::vector<float> image;
    for (std::size_t pixel = 0; pixel + 1 < lists.starts.size(); ++pixel)
        for (std::size_t colour = 0; colour < 3; ++colour) {
            float sum = 0;
            for (std::size_t i = lists.starts[pixel]; i < lists.starts[pixel + 1]; ++i)
                sum = add_to(sum, lists.colours[4 * i + colour], lists.colours[4 * i + 3], format);
            image.push_back(sum);
        }
    return image;
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
    }
}

TEST_CASE("a duplicate contribution, or one outside the image, is an error", "[torus]") {
    SplitMix random(5);
    for (int i = 0; i < 100; ++i) {
        CAPTURE(i);
        std::vector<raya_head> returns;
        for (std::uint32_t pixel = 0; pixel < 4; ++pixel) RandomRayTree(random, returns, pixel).add_ray(0, 0, 3);
        CHECK_NOTHROW(sort_contributions(returns, 4));
        CHECK_THROWS_AS(sort_contributions(returns, 3), std::logic_error);
        raya_head copy = returns[random_below(random, returns.size())];
        copy.state ^= RAYA_STATE_FRESH;  // not part of the contribution's identity
        copy.weight += 1;
        returns.push_back(copy);
        shuffle(returns, random);
        CHECK_THROWS_AS(sort_contributions(returns, 4), std::logic_error);
    }
}

TEST_CASE("an image without contributions is black", "[torus]") {
    const Contributions no_contributions = sort_contributions({}, 7);
    CHECK(no_contributions.colours.empty());
    CHECK(no_contributions.starts == std::vector<std::uint32_t>(8, 0));
    Session session(choose_device(""));
    Kernels kernels(session, {});
    Composer composer(kernels);
    CHECK(composer.compose(no_contributions) == std::vector<float>(21, 0));
}

TEST_CASE("pixels are sums in which each multiply-add rounds once", "[torus]") {
    const std::uint64_t seed = 40'961;
    SplitMix random(seed);
    const std::string name = GENERATE("fp32", "spa22", "e8m12t", "e5m6");
    KernelOptions options;
    options.format = parse_format(name);
    Session session(choose_device(""));
    Kernels kernels(session, options);
    Composer composer(kernels);
    for (int i = 0; i < 40; ++i) {
        const std::uint32_t pixels = 1 + random_below(random, 300);
        CAPTURE(seed, i, name, pixels);
        const Contributions lists = random_lists(random, options.format, pixels);
        CHECK((composer.compose(lists) == sums_of(lists, options.format)));
    }
}

}  // namespace raya
