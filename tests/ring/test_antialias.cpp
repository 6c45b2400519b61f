// Antialiasing on the ring, compared bit for bit with functions of whole images (whole_image.hpp), for random
// distributions of the image over PEs. RAYA_ANTIALIAS_CASES sets the number of cases, for example 1000.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <tuple>

#include "tests/ring/grid_scene.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/ring/whole_image.hpp"

namespace raya {
namespace {

using whole_image::count_differences;
using whole_image::value_at;

constexpr double kPixelsPerUnit = 32;

/// [size]: width, height. There are few sizes, so that few reference images are rendered. Some sides have one or two
/// pixels, so that pixels have few neighbours.
constexpr std::array<std::array<std::uint32_t, 2>, 10> kSizes = {
    {{1, 1}, {1, 9}, {8, 1}, {2, 2}, {3, 2}, {7, 5}, {17, 13}, {32, 20}, {8, 40}, {39, 40}}};

int case_count() {
    const char* given = std::getenv("RAYA_ANTIALIAS_CASES");
    return given ? std::atoi(given) : 30;
}

/// Returns a random case. The number of PEs is 1 to width * height and often divides the width.
RingCase random_case(SplitMix& random, const std::string& format) {
    const auto& size = kSizes[random_below(random, kSizes.size())];
    RingCase c{.width = size[0], .height = size[1], .format = format};
    c.pes = 1 + random_below(random, random.next() % 2 ? c.width : c.width * c.height);
    while (random.next() % 2 && c.width % c.pes) c.pes = 1 + random_below(random, c.width);
    c.offset = random_below(random, c.width);
    c.fold = random.next() % 2 ? Fold::kBlock : Fold::kCyclic;
    c.sampling = c.width % 2 ? Sampling::kCorners : Sampling::kCentres;
    return c;
}

Antialias random_supersampling(SplitMix& random) {
    constexpr std::array<double, 4> kThresholds = {0, 1, 0.125, 0.03125};
    const std::uint32_t choice = random_below(random, 8);
    return {.method = AntialiasMethod::kSupersample,
            .threshold =
                choice < kThresholds.size() ? kThresholds[choice] : std::ldexp(random_below(random, 1u << 30), -31),
            .points = random.next() % 2 ? RAYA_POINTS_AXES : RAYA_POINTS_DIAGONALS};
}

/// Reference images of the scene without antialiasing. A single PE renders each image once.
class PlainImages {
  public:
    explicit PlainImages(Session& session) : session_(session) {}

    /// Returns the image at the case's size.
    const RingResult& image_of(const RingCase& c) { return render(c, c.width, c.height, kPixelsPerUnit); }

    /// Returns the image sampled every half pixel, with a margin of half a pixel: point (2 j + 1, 2 x + 1) is the
    /// sample point of the case's pixel (j, x).
    const RingResult& fine_image_of(const RingCase& c) {
        RingCase centres = c;
        centres.sampling = Sampling::kCentres;
        return render(centres, 2 * c.width + 1, 2 * c.height + 1, 2 * kPixelsPerUnit);
    }

  private:
    const RingResult& render(const RingCase& c, std::uint32_t width, std::uint32_t height, double pixels_per_unit) {
        const auto key = std::tuple(c.format, c.sampling, width, height, pixels_per_unit);
        const auto found = images_.find(key);
        if (found != images_.end()) return found->second;
        const RingSettings settings = settings_of({.width = width,
                                                   .height = height,
                                                   .pes = 1,
                                                   .offset = 0,
                                                   .sampling = c.sampling,
                                                   .format = c.format,
                                                   .record_costs = true});
        RingRenderer renderer(session_, grid_scene(height, c.sampling, pixels_per_unit), settings);
        return images_.emplace(key, renderer.render()).first->second;
    }

    Session& session_;
    std::map<std::tuple<std::string, Sampling, std::uint32_t, std::uint32_t, double>, RingResult> images_;
};

RingResult render_grid(Session& session, RingCase c) {
    c.record_costs = true;
    return RingRenderer(session, grid_scene(c.height, c.sampling, kPixelsPerUnit), settings_of(c)).render();
}

// Offsets of a pixel's additional sample points, {down, right} in half pixels, in the order of summation.
using Offsets = std::array<std::array<int, 2>, 4>;
constexpr Offsets kAxes = {{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};
constexpr Offsets kDiagonals = {{{-1, -1}, {-1, 1}, {1, -1}, {1, 1}}};

const Offsets& offsets_of(const Antialias& antialias) {
    return antialias.points == RAYA_POINTS_AXES ? kAxes : kDiagonals;
}

/// Returns the mean of the point (row, column) of the finer image and of the four additional points around this point.
float mean_of_points(const Image& fine, int row, int column, int colour, const RingCase& c) {
    std::array<float, 5> values = {value_at(fine, row, column, colour)};
    for (std::size_t n = 0; n < 4; ++n) {
        const auto& offset = offsets_of(c.antialias)[n];
        values[n + 1] = value_at(fine, row + offset[0], column + offset[1], colour);
    }
    return whole_image::mean_of_five(values, settings_of(c).format);
}

/// Returns the plain image, in which each pixel of the mask is replaced by the mean of its five points.
Image supersampled(const Image& plain, const Image& fine, const Image& mask, const RingCase& c) {
    return whole_image::make_image(plain.width, plain.height, [&](int row, int column, int colour) {
        if (value_at(mask, row, column, 0) == 0) return value_at(plain, row, column, colour);
        return mean_of_points(fine, 2 * row + 1, 2 * column + 1, colour, c);
    });
}

/// Returns the cost of the four additional points of each pixel in the mask, in cycles; 0 for the other pixels.
std::vector<std::uint64_t> supersampling_cost(const CostImage& fine, const Image& mask, const RingCase& c) {
    std::vector<std::uint64_t> cost;
    for (int row = 0; row < mask.height; ++row)
        for (int column = 0; column < mask.width; ++column) {
            std::uint64_t sum = 0;
            for (const auto& offset : offsets_of(c.antialias))
                sum += fine.cycles[std::size_t((2 * row + 1 + offset[0]) * fine.width + 2 * column + 1 + offset[1])];
            cost.push_back(value_at(mask, row, column, 0) != 0 ? sum : 0);
        }
    return cost;
}

std::size_t marked_pixels(const Image& mask) {
    return static_cast<std::size_t>(std::count(mask.rgb.begin(), mask.rgb.end(), 1.0f)) / 3;
}

/// Returns the finer image's values at the pixels' own sample points.
Image own_points(const Image& fine) {
    return whole_image::make_image(fine.width / 2, fine.height / 2, [&](int row, int column, int colour) {
        return value_at(fine, 2 * row + 1, 2 * column + 1, colour);
    });
}

void check_supersampled(const RingResult& result, const RingResult& plain, const RingResult& fine, const RingCase& c) {
    const Image mask = whole_image::contrast_mask(plain.image, c.antialias.threshold, settings_of(c).format);
    const std::size_t marked = marked_pixels(mask);
    REQUIRE(count_differences(own_points(fine.image), plain.image) == 0);
    CHECK(count_differences(result.mask, mask) == 0);
    CHECK(result.recomputed == marked);
    CHECK(count_differences(result.image, supersampled(plain.image, fine.image, mask, c)) == 0);
    REQUIRE(result.phases.size() == 2);
    CHECK(result.phases[0].events == plain.events);
    CHECK(result.phases[0].cost().cycles == plain.cost().cycles);
    CHECK(result.phases[1].events[RAYA_PRIMARY] == 4 * marked);
    CHECK(result.phases[1].cost().cycles == supersampling_cost(fine.cost(), mask, c));
}

}  // namespace

TEST_CASE("the ring's filter gives the same pixels as the filter of the whole image", "[ring][antialias]") {
    constexpr std::uint64_t kSeed = 31;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    PlainImages plain(session);
    std::uint64_t rotations = 0;
    for (const char* format : {"fp32", "spa22"})
        for (int i = 0; i < case_count(); ++i) {
            RingCase c = random_case(random, format);
            c.antialias.method = AntialiasMethod::kFilter;
            CAPTURE(kSeed, format, i, c.width, c.height, c.pes, c.offset, c.fold);
            const RingResult result = render_grid(session, c), &expected = plain.image_of(c);
            CHECK(count_differences(result.image, whole_image::filtered(expected.image, settings_of(c).format)) == 0);
            CHECK(result.events == expected.events);
            CHECK(result.cost().cycles == expected.cost().cycles);
            CHECK(result.phases.size() == 1);
            CHECK(result.mask.rgb.empty());
            rotations += result.communication.rotations;
        }
    CHECK(rotations > 0);
}

TEST_CASE("supersampling takes the mean of five points where a neighbour differs", "[ring][antialias]") {
    constexpr std::uint64_t kSeed = 32;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    PlainImages plain(session);
    std::size_t recomputed = 0, pixels = 0, partly_marked = 0;
    for (const char* format : {"fp32", "spa22"})
        for (int i = 0; i < case_count(); ++i) {
            RingCase c = random_case(random, format);
            c.antialias = random_supersampling(random);
            CAPTURE(kSeed, format, i, c.width, c.height, c.pes, c.offset, c.fold, c.sampling == Sampling::kCorners);
            CAPTURE(c.antialias.threshold, c.antialias.points);
            const RingResult result = render_grid(session, c);
            check_supersampled(result, plain.image_of(c), plain.fine_image_of(c), c);
            const std::size_t size = std::size_t{c.width} * c.height;
            if (c.antialias.threshold == 0 && size > 1) CHECK(result.recomputed == size);
            partly_marked += result.recomputed > 0 && result.recomputed < size;
            recomputed += result.recomputed;
            pixels += size;
        }
    CHECK(recomputed > pixels / 10);  // the cases have both marked and unmarked pixels
    CHECK(recomputed < pixels * 9 / 10);
    CHECK(partly_marked > std::size_t(case_count()) / 2);
}

TEST_CASE("the additional points lie half a pixel away, for any camera", "[ring][antialias]") {
    const Scene scene = project_scene("spheres");
    Session session(choose_device(""));
    constexpr int kWidth = 33, kHeight = 21;
    for (const char* format : {"fp32", "spa22"}) {
        // Doubling the number of intervals exactly halves the steps between pixel corners. The finer image has no
        // points beyond the sample points of the outermost pixels, so these pixels, 104 of 693, are not compared.
        const RingCase fine_case{
            .width = 2 * kWidth - 1, .height = 2 * kHeight - 1, .sampling = Sampling::kCorners, .format = format};
        const Image fine = RingRenderer(session, scene, settings_of(fine_case)).render().image;
        for (const raya_u32 points : {RAYA_POINTS_AXES, RAYA_POINTS_DIAGONALS}) {
            const RingCase c{.width = kWidth,
                             .height = kHeight,
                             .sampling = Sampling::kCorners,
                             .format = format,
                             .antialias = {AntialiasMethod::kSupersample, 0, points}};
            const RingResult result = RingRenderer(session, scene, settings_of(c)).render();
            const Image expected = whole_image::make_image(kWidth, kHeight, [&](int row, int column, int colour) {
                const bool inner = row > 0 && row + 1 < kHeight && column > 0 && column + 1 < kWidth;
                if (!inner) return value_at(result.image, row, column, colour);
                return mean_of_points(fine, 2 * row, 2 * column, colour, c);
            });
            CAPTURE(format, points);
            CHECK(result.recomputed == kWidth * kHeight);
            CHECK(count_differences(result.image, expected) == 0);
        }
    }
}

TEST_CASE("pixels whose difference equals the threshold are marked; differences outside 0..1 do not count",
          "[ring][antialias]") {
    Session session(choose_device(""));
    const std::string format = GENERATE("fp32", "spa22");
    const double last_place = format == "fp32" ? 0x1p-23 : 0x1p-15;
    // Without lights, a surface of Kd = 1 shows its own colour, so the image has two colours, which differ in one
    // component.
    const auto recomputed_pixels = [&](double background, double object, double threshold, int component) {
        Scene scene = grid_scene(24, Sampling::kCentres, kPixelsPerUnit);
        scene.background = scene.surfaces[1].colour = {0.5, 0.5, 0.5};
        scene.background[component] = background;
        scene.surfaces[1] = {.colour = scene.surfaces[1].colour, .diffuse = 1};
        scene.surfaces[1].colour[component] = object;
        scene.lights.clear();
        scene.planes.clear();
        scene.spheres.resize(1);
        const RingCase c{.width = 16,
                         .height = 24,
                         .pes = 16,
                         .format = format,
                         .antialias = {.method = AntialiasMethod::kSupersample, .threshold = threshold}};
        return RingRenderer(session, scene, settings_of(c)).render().recomputed;
    };
    const std::uint64_t outline_pixels = recomputed_pixels(0, 1, 0.5, 0);
    CAPTURE(format);
    CHECK(outline_pixels > 10);
    CHECK(outline_pixels < 100);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125, 0) == outline_pixels);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125, 1) == outline_pixels);
    CHECK(recomputed_pixels(0.375, 0.25, 0.125, 2) == outline_pixels);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125 * (1 + last_place), 0) == 0);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125 * (1 + last_place / 4), 0) ==
          outline_pixels);  // a threshold is rounded to the format
    CHECK(recomputed_pixels(0.25, 0.375 - 0.25 * last_place, 0.125, 2) == 0);
    CHECK(recomputed_pixels(-7, 0, 0.125, 1) == 0);
    CHECK(recomputed_pixels(1, 9, 0.125, 0) == 0);
    CHECK(recomputed_pixels(-7, 9, 1, 1) == outline_pixels);
}

}  // namespace raya
