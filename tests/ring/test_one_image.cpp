// An image depends neither on the distribution of the work over PEs, nor on lanes, group size or the optimiser.
#include <catch2/catch.hpp>
#include <random>

#include "tests/kernels/unoptimised.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

// Returns a scene with every kind of object and surface: the scene `polygons` with the objects of three other scenes.
Scene mixed_scene() {
    Scene scene = project_scene("polygons");
    for (const char* name : {"cones", "glass", "mirrors"}) {
        const Scene added = project_scene(name);
        const int shift = static_cast<int>(scene.surfaces.size());
        scene.surfaces.insert(scene.surfaces.end(), added.surfaces.begin(), added.surfaces.end());
        const auto add_objects = [&](auto& objects, auto added_objects) {
            for (auto& object : added_objects) object.surface += shift;
            objects.insert(objects.end(), added_objects.begin(), added_objects.end());
        };
        add_objects(scene.spheres, added.spheres);
        add_objects(scene.planes, added.planes);
        add_objects(scene.cones, added.cones);
        add_objects(scene.polygons, added.polygons);
    }
    return scene;
}

struct ImageAndCounts {
    std::string hash;
    EventCounts events;
    bool operator==(const ImageAndCounts&) const = default;
};

ImageAndCounts image_and_counts_of(const RingResult& result) { return {pixel_hash(result.image), result.events}; }

}  // namespace

TEST_CASE("lanes, group size and the optimiser change no bit of the image and no count", "[ring][slow]") {
    const Scene scene = mixed_scene();
    const std::string format = GENERATE("fp32", "spa22");
    CAPTURE(format);
    const ImageAndCounts expected =
        image_and_counts_of(render_scene(scene, {.lanes = 1, .group = 1, .format = format}));
    CHECK(expected.events[RAYA_PRIMARY] == 64 * 48);
    for (const auto kind : {RAYA_REFLECTED, RAYA_REFRACTED, RAYA_SHADOW_HITS, RAYA_HIGHLIGHTS, RAYA_SPHERE_TESTS,
                            RAYA_PLANE_TESTS, RAYA_POLYGON_TESTS, RAYA_CONE_TESTS})
        CHECK(expected.events[kind] > 0);
    const RingCase cases[] = {{.lanes = 16, .group = 3},
                              {.lanes = 4, .group = 1},
                              {.lanes = 1, .group = 1, .more_options = {"-cl-opt-disable"}},
                              {.lanes = 8, .group = 1},
                              {.lanes = 16, .group = 1},
                              {.lanes = 1, .group = 64},
                              {.lanes = 4, .group = 16},
                              {.lanes = 16, .group = 1, .more_options = {"-cl-opt-disable"}}};
    for (RingCase c : quick_of(3, cases)) {
        if (!c.more_options.empty() && !tests_unoptimised(c.lanes)) continue;
        c.format = format;
        CAPTURE(c.lanes, c.group, c.more_options);
        CHECK(image_and_counts_of(render_scene(scene, c)) == expected);
    }
}

TEST_CASE("PEs, offset, fold and machine change no bit of the image and no count", "[ring]") {
    const Scene scene = mixed_scene();
    const std::string format = GENERATE("fp32", "spa22");
    CAPTURE(format);
    const ImageAndCounts expected = image_and_counts_of(render_scene(scene, {.pes = 1, .offset = 0, .format = format}));
    for (const std::uint32_t pes : {1u, 7u, 64u, 256u, 1000u, 64u * 48u})
        for (const Fold fold : {Fold::kCyclic, Fold::kBlock})
            for (const std::uint32_t offset : {0u, 16u, 63u}) {
                CAPTURE(pes, fold, offset);
                CHECK(image_and_counts_of(render_scene(
                          scene, {.pes = pes, .offset = offset, .fold = fold, .format = format})) == expected);
            }
}

TEST_CASE("the mapping's kind changes no bit of the image and no count, with and without antialiasing", "[ring]") {
    const Scene scene = mixed_scene();
    const auto method = GENERATE(AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample);
    RingCase c{.width = 24, .height = 18, .pes = 1, .offset = 0};
    c.antialias.method = method;
    c.group = 1;
    const ImageAndCounts expected = image_and_counts_of(render_scene(scene, c));
    struct Row {
        MappingRule mapping;
        std::uint32_t pes;
        std::uint32_t supersampling_group;  // group size with supersampling, 1 or 4; with the filter: 5 - this size
    };
    // If there are more PEs than rows or tiles, some PEs are idle.
    const Row rows[] = {{rows_mapping(), 5, 1},      {rows_mapping(), 40, 4},      {blocks_mapping(), 5, 4},
                        {blocks_mapping(), 40, 1},   {grid_mapping(3, 4), 12, 4},  {grid_mapping(20, 5), 100, 1},
                        {tiles_mapping(6, 3), 7, 1}, {tiles_mapping(8, 9), 40, 4}, {random_mapping(7), 13, 1},
                        {random_mapping(1), 432, 4}};
    for (const Row& row : rows)
        for (const std::uint32_t group : {1u, 4u}) {
            const bool smoothed = method != AntialiasMethod::kNone;
            if (smoothed && (group == row.supersampling_group) == (method == AntialiasMethod::kFilter)) continue;
            c.mapping = row.mapping;
            c.pes = row.pes;
            c.group = group;
            CAPTURE(antialias_name(method), mapping_text(row.mapping), c.pes, group);
            if (smoothed && row.mapping.kind == RAYA_RANDOM)
                CHECK_THROWS_WITH(render_scene(scene, c),
                                  Catch::Contains("--mapping random") &&
                                      Catch::Contains("the neighbours of a pixel are on random PEs"));
            else
                CHECK(image_and_counts_of(render_scene(scene, c)) == expected);
        }
}

TEST_CASE("images of any size are traced completely, even if pixels do not fill all lanes", "[ring]") {
    const Scene scene = project_scene("glass");
    const std::uint32_t seed = 20251;
    std::mt19937 random(seed);
    const auto between = [&](std::uint32_t low, std::uint32_t high) {
        return std::uniform_int_distribution<std::uint32_t>(low, high)(random);
    };
    for (int i = 0; i < 40; ++i) {
        RingCase c;
        c.width = between(1, 40);
        c.height = between(1, 40);
        c.pes = between(1, c.width * c.height);
        c.offset = between(0, c.width - 1);
        c.fold = i % 2 ? Fold::kBlock : Fold::kCyclic;
        CAPTURE(seed, i, c.width, c.height, c.pes, c.offset, c.fold);
        const ImageAndCounts distributed = image_and_counts_of(render_scene(scene, c));
        c.pes = 1;
        c.lanes = 1;
        CHECK(distributed == image_and_counts_of(render_scene(scene, c)));
    }
}

TEST_CASE("a share larger than a PE's memory is gathered block by block, with the same image", "[ring]") {
    const Scene scene = project_scene("centre");
    const RingResult whole = render_scene(scene, {.width = 128, .height = 128, .pes = 128, .machine = "spa"});
    const RingResult blocks = render_scene(scene, {.width = 128, .height = 128, .pes = 1, .machine = "spa"});
    CHECK(whole.communication.gathers == 1);
    CHECK(blocks.communication.gathers > 1);
    CHECK(blocks.communication.gather_words == 3 * 128 * 128);
    CHECK(blocks.pe_memory.bytes() <= 32 * 1024);
    CHECK(image_and_counts_of(blocks) == image_and_counts_of(whole));
}

TEST_CASE("a second render with the same renderer gives the same result", "[ring]") {
    Session session(choose_device(""));
    RingRenderer renderer(session, project_scene("cones"), settings_of(RingCase{}));
    const RingResult first = renderer.render(), second = renderer.render();
    CHECK(image_and_counts_of(first) == image_and_counts_of(second));
    CHECK(second.communication.broadcasts == 1);
    CHECK(first.load.per_pe == second.load.per_pe);
}

}  // namespace raya
