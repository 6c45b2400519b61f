// A PE's grid or BVH selects the objects that are tested and never changes the image (`--accel grid`, `--accel bvh`).
#include <catch2/catch.hpp>
#include <map>
#include <numbers>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

// Returns the results that do not depend on the accelerator: the image, and all counts except those of tests,
// traversals and traversal steps.
std::string image_and_events(const RingResult& r) { return image_and_counts(r.image, r.events); }

RingResult render_with(Session& session, const Scene& scene, const RingCase& c, const Accel& accel) {
    RingSettings settings = raya::settings_of(c);
    settings.accel = accel;
    return RingRenderer(session, scene, settings).render();
}

const Accel automatic_grid{.kind = AccelKind::kGrid, .divisions = {}}, bvh{.kind = AccelKind::kBvh, .divisions = {}};

Accel grid_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return {.kind = AccelKind::kGrid, .divisions = Divisions{a, b, c}};
}

std::uint64_t tests_of(const EventCounts& e) {
    return e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS];
}

}  // namespace

TEST_CASE("a grid or BVH changes no bit of the image, for any voxels and format", "[ring][accel][slow]") {
    Session session(choose_device(""));
    const std::string name = GENERATE("centre", "glass", "polygons", "cones", "planes");
    const std::string format = GENERATE("fp32", "spa22");
    // The fast tests render one scene per format. Other tests cover the kinds of objects that these scenes do not have.
    if (!thorough() && name != (format == "fp32" ? "polygons" : "cones")) return;
    const Scene scene = project_scene(name);
    const RingCase c{.width = 32, .height = 24, .pes = 8, .format = format};
    const std::string expected = image_and_events(render_with(session, scene, c, {}));
    for (const Accel& accel :
         {bvh, automatic_grid, grid_of(1, 1, 1), grid_of(7, 3, 5), grid_of(1, 40, 2), grid_of(24, 24, 24)}) {
        CAPTURE(name, format, accel_text(accel));
        const RingResult result = render_with(session, scene, c, accel);
        CHECK(image_and_events(result) == expected);
        CHECK(result.events[RAYA_WALKS] > 0);
        if (accel.kind == AccelKind::kGrid) CHECK(result.events[RAYA_STEPS] >= result.events[RAYA_WALKS]);
    }
}

TEST_CASE("scenes of all kinds of objects have the same image with a grid or BVH, in coarse formats too",
          "[ring][accel][slow]") {
    Session session(choose_device(""));
    const std::string format = GENERATE(from_range(quick(2, {"fp32", "e5m10", "e6m15t", "e8m12", "e5m6"})));
    SplitMix random(2026);
    for (const std::uint64_t seed : quick_of(1, kSceneSeeds)) {
        const Scene scene = random_view_scene(seed);
        const RingCase c{.width = 24, .height = 20, .pes = 6, .format = format};
        const auto side = [&] { return 1 + static_cast<std::uint32_t>(random.next() % 9); };
        const std::uint32_t a = side(), b = side(), d = side();
        CAPTURE(seed, format, a, b, d);
        const std::string expected = image_and_events(render_with(session, scene, c, {}));
        CHECK(image_and_events(render_with(session, scene, c, grid_of(a, b, d))) == expected);
        CHECK(image_and_events(render_with(session, scene, c, automatic_grid)) == expected);
        CHECK(image_and_events(render_with(session, scene, c, bvh)) == expected);
    }
}

// Returns a star-shaped polygon around `centre` with 3 to 42 corners. With six or more corners it is concave.
Polygon star(SplitMix& random, const Vec3& centre, const Vec3& u, const Vec3& v, int surface) {
    Polygon polygon{{}, {}, surface};
    const auto corners = 3 + random_below(random, 40);
    for (std::uint64_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * double(i) / double(corners),
                     radius = corners > 5 && i % 2 ? 0.5 : 1;
        polygon.vertices.push_back(centre + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return polygon;
}

// Returns a scene of spheres, polygons and cones of very different sizes that touch, nest and coincide. Many of the
// polygons are axis-aligned.
Scene crowded_scene(std::uint64_t seed) {
    Scene scene = random_view_scene(kSceneSeeds[0]);
    SplitMix random(seed);
    scene.spheres.clear();
    scene.polygons.clear();
    scene.cones.clear();
    const auto place = [&] { return Vec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)); };
    const auto surface = [&] { return static_cast<int>(random_below(random, scene.surfaces.size())); };
    const auto size = [&] { return std::pow(10.0, random.uniform(-3, 0.3)); };
    for (int i = 0; i < 60; ++i) {
        const Vec3 at = place();
        const double r = size();
        scene.spheres.push_back({at, r, surface()});
        if (i % 5 == 0) scene.spheres.push_back({at, r, surface()});                      // a duplicate
        if (i % 5 == 1) scene.spheres.push_back({at, -r / 2, surface()});                 // nested, seen from inside
        if (i % 5 == 2) scene.spheres.push_back({at + Vec3(2 * r, 0, 0), r, surface()});  // touching
    }
    for (int i = 0; i < 40; ++i) {
        const Vec3 at = place();
        Vec3 u(size(), 0, 0), v(0, size(), 0);
        if (i % 2) std::swap(v.y, v.z);  // u and v stay parallel to axes
        scene.polygons.push_back({{at, at + u, at + u + v, at + v}, {}, surface()});
        scene.polygons.push_back(star(random, place(), u, v, surface()));
        const Vec3 apex = at + 0.3 * place();
        scene.cones.push_back({at, size(), apex, size(), surface()});
    }
    return scene;
}

TEST_CASE("scenes of many objects of all sizes have the same image with a BVH", "[ring][accel][slow]") {
    Session session(choose_device(""));
    const std::string format = GENERATE("fp32", "spa22");
    for (unsigned seed = 1; seed <= quick_cases(2, 200); ++seed) {
        Scene scene = crowded_scene(seed);
        if (seed % 3 == 0) scene.view.from = scene.view.at - Vec3(0, 0, 8);  // view along an axis
        const RingCase c{.width = 24, .height = 20, .pes = 6, .bounces = 3, .format = format};
        CAPTURE(seed, format);
        CHECK(image_and_events(render_with(session, scene, c, bvh)) ==
              image_and_events(render_with(session, scene, c, {})));
    }
}

TEST_CASE("counts of tests and steps do not depend on lanes, groups and PEs", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("polygons");
    const std::string format = GENERATE("fp32", "spa22");
    const Accel accel = GENERATE_COPY(grid_of(5, 4, 6), bvh);
    if (!thorough() && (format == "fp32") != (accel.kind == AccelKind::kBvh)) return;
    const RingCase c{.width = 32, .height = 24, .pes = 8, .lanes = 1, .group = 1, .format = format};
    const EventCounts expected = render_with(session, scene, c, accel).events;
    CHECK(expected[RAYA_STEPS] > 0);
    for (const auto& [lanes, group, pes] :
         quick(1, {std::array{4u, 3u, 7u}, {1u, 16u, 1u}, {8u, 3u, 32u}, {16u, 1u, 5u}})) {
        CAPTURE(format, accel_text(accel), lanes, group, pes);
        RingCase changed = c;
        changed.lanes = lanes;
        changed.group = group;
        changed.pes = pes;
        CHECK(render_with(session, scene, changed, accel).events == expected);
    }
    RingSettings in_global_memory = raya::settings_of(c);
    in_global_memory.accel = accel;
    in_global_memory.kernels.local_words = false;
    CHECK(RingRenderer(session, scene, in_global_memory).render().events == expected);
}

// Returns a scene that has, for each kind of object, twice as many copies of random objects as original objects. The
// copies have distant object numbers and random surfaces. So most rays hit several objects at equal distances.
Scene scene_with_copies(std::uint64_t seed) {
    Scene scene = random_view_scene(seed);
    SplitMix random(seed);
    const auto add_copies = [&](auto& objects) {
        auto copies = objects;
        const std::size_t count = objects.size();
        for (std::size_t i = 0; i < 2 * count; ++i) {
            auto copy = objects[random_below(random, count)];
            copy.surface = static_cast<int>(random_below(random, 3));
            copies.push_back(copy);
        }
        objects = copies;
    };
    add_copies(scene.spheres);
    add_copies(scene.polygons);
    add_copies(scene.cones);
    return scene;
}

// Returns triangles in one plane around a corner. The picture shows only a few units in the last place around the
// corner, so rays hit edges of triangles, and a box without a margin for rounding errors would miss hits.
Scene scene_of_a_corner(std::uint64_t seed) {
    SplitMix random(seed);
    Scene scene = random_view_scene(seed);
    scene.spheres.clear();
    scene.planes.clear();
    scene.polygons.clear();
    scene.cones.clear();
    const double x = whole_uniform(random, 13) - 5.5, y = whole_uniform(random, 13) - 5.5;
    for (int column = -2; column < 2; ++column)
        for (int row = -2; row < 2; ++row) {
            const Vec3 low(x + column, y + row, 0), high = low + Vec3(1, 1, 0);
            const int surface = static_cast<int>(random_below(random, 3));
            scene.polygons.push_back({{low, low + Vec3(1, 0, 0), high}, {}, surface});
            scene.polygons.push_back({{low, high, low + Vec3(0, 1, 0)}, {}, (surface + 1) % 3});
        }
    scene.view.at = Vec3(x, y, 0);
    scene.view.from = Vec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(3, 9));
    scene.view.angle_degrees = 3e-6;
    return scene;
}

TEST_CASE("rays that descend through the BVH together have the same hits", "[ring][accel][slow]") {
    Session session(choose_device(""));
    const std::uint32_t lanes = GENERATE(from_range(quick(1, {16u, 4u, 8u, 1u})));
    const auto make_scene = GENERATE(crowded_scene, scene_with_copies, scene_of_a_corner);
    for (unsigned seed = 1; seed <= quick_cases(make_scene == scene_of_a_corner ? 12 : 2, 100); ++seed) {
        Scene scene = make_scene(seed);
        if (seed % 3 == 0 && make_scene != scene_of_a_corner)
            scene.view.from = scene.view.at - Vec3(0, 0, 8);  // view along an axis
        CAPTURE(lanes, make_scene == scene_of_a_corner, seed);
        const RingCase c{
            .width = 48, .height = 40, .pes = 5, .mapping = tiles_mapping(4, 4), .lanes = lanes, .bounces = 3};
        RingSettings settings = raya::settings_of(c);
        settings.accel = bvh;
        const RingResult alone = RingRenderer(session, scene, settings).render();
        settings.packets = true;
        const RingResult together = RingRenderer(session, scene, settings).render();
        CHECK(pixel_hash(together.image) == pixel_hash(alone.image));
        for (std::size_t event = 0; event < RAYA_EVENTS; ++event)
            CHECK(together.events[event] == (event < RAYA_SPHERE_TESTS ? alone.events[event] : 0));
    }
}

TEST_CASE("of objects at equal distances, the one with the lowest number is hit, for any voxels", "[ring][accel]") {
    Session session(choose_device(""));
    const std::string format = GENERATE(from_range(quick(2, {"fp32", "spa22", "e5m6"})));
    for (const std::uint64_t seed : quick_of(1, kSceneSeeds)) {
        const Scene scene = scene_with_copies(seed);
        const RingCase c{.width = 24, .height = 20, .pes = 6, .format = format};
        const std::string expected = image_and_events(render_with(session, scene, c, {}));
        CAPTURE(seed, format);
        CHECK(image_and_events(render_with(session, scene, c, grid_of(1, 1, 1))) == expected);
        CHECK(image_and_events(render_with(session, scene, c, grid_of(8, 5, 7))) == expected);
        CHECK(image_and_events(render_with(session, scene, c, automatic_grid)) == expected);
        CHECK(image_and_events(render_with(session, scene, c, bvh)) == expected);
    }
}

// A floor of many squares, a square larger than all of them, and an infinite plane lie in the same plane: a ray hits
// them at equal distances.
TEST_CASE(
    "of a plane, a separate polygon and listed polygons at equal distances, the one with the lowest number is hit",
    "[ring][accel]") {
    Session session(choose_device(""));
    Scene scene = project_scene("planes");
    scene.planes = {{{0, 0, 1}, 0, 0}};
    // The sphere makes the box high. So a ray finds the large square in voxels before the voxel of the hit.
    scene.spheres = {{{-4, -4, 4}, 0.1, 0}};
    scene.cones.clear();
    scene.polygons = {};
    const auto add_square = [&](double x, double y, double side, int surface) {
        scene.polygons.push_back(
            {{{x, y, 0}, {x + side, y, 0}, {x + side, y + side, 0}, {x, y + side, 0}}, {}, surface});
    };
    const auto surfaces = static_cast<int>(scene.surfaces.size());
    for (int i = 0; i < 40; ++i) add_square(-4 + i % 8, -2 + i / 8, 1, i % surfaces);
    add_square(-100, -100, 200, 1 % surfaces);
    for (int i = 0; i < 40; ++i) add_square(-4 + i / 5, -2 + i % 5, 1, (i + 1) % surfaces);
    scene.view.from = {1, -6, 5};
    scene.view.at = {0, 0, 0};
    scene.view.up = {0, 0, 1};
    scene.lights = {{{2, 1, 8}, {}}};
    for (const bool plane : {true, false}) {
        if (!plane) scene.planes.clear();
        const RingCase c{.width = 32, .height = 24, .pes = 8};
        const std::string expected = image_and_events(render_with(session, scene, c, {}));
        const RingResult grid = render_with(session, scene, c, automatic_grid);
        CAPTURE(plane);
        CHECK(image_and_events(grid) == expected);
        CHECK(grid.accel->separate == 1);
        CHECK(image_and_events(render_with(session, scene, c, grid_of(9, 9, 3))) == expected);
        CHECK(image_and_events(render_with(session, scene, c, bvh)) == expected);
    }
}

// The lights lie in a ceiling of squares. So, up to rounding, a shadow ray meets the square around its light at the
// ray's end.
TEST_CASE("a hit at the end of a shadow ray does not count, in any voxel", "[ring][accel]") {
    Session session(choose_device(""));
    const std::string format = GENERATE(from_range(quick(1, {"spa22", "fp32", "e5m10"})));
    Scene scene = project_scene("planes");
    scene.planes.clear();
    scene.cones.clear();
    scene.spheres = {{{0, 0, 8}, 0.5, 0}};  // makes the box higher than the ceiling
    const auto square = [](double x, double y, double z, double side) {
        return Polygon{{{x, y, z}, {x + side, y, z}, {x + side, y + side, z}, {x, y + side, z}}, {}, 0};
    };
    scene.polygons = {square(-8, -8, 0, 16)};
    for (int i = 0; i < 256; ++i) scene.polygons.push_back(square(i % 16 - 8, i / 16 - 8, 4, 1));
    scene.lights = {{{0.5, 0.5, 4}, {}}, {{-3, 2, 4}, {}}, {{2.25, -4.75, 4}, {}}};
    scene.view.from = {1, -6, 3};
    scene.view.at = {0, 0, 0};
    scene.view.up = {0, 0, 1};
    const RingCase c{.width = 48, .height = 40, .pes = 8, .format = format};
    const RingResult plain = render_with(session, scene, c, {});
    CHECK(plain.events[RAYA_SHADOW_HITS] > 0);
    CHECK(plain.events[RAYA_LIT] > 0);
    for (const Accel& accel : {bvh, automatic_grid, grid_of(5, 6, 7), grid_of(3, 2, 16)}) {
        CAPTURE(format, accel_text(accel));
        CHECK(image_and_events(render_with(session, scene, c, accel)) == image_and_events(plain));
    }
}

TEST_CASE("supersampling with a grid or BVH gives the same pixels", "[ring][accel]") {
    Session session(choose_device(""));
    RingCase c{.width = 32, .height = 24, .pes = 8};
    c.antialias.method = AntialiasMethod::kSupersample;
    const Scene scene = project_scene("centre");
    const RingResult plain = render_with(session, scene, c, {}), grid = render_with(session, scene, c, automatic_grid);
    CHECK(plain.recomputed > 0);
    CHECK(image_and_events(grid) == image_and_events(plain));
    CHECK(image_and_events(render_with(session, scene, c, bvh)) == image_and_events(plain));
}

TEST_CASE("a grid or BVH saves 95 % of the tests of many small spheres", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = generate_balls(3);
    const RingCase c{.width = 48, .height = 48, .pes = 48};
    const RingResult plain = render_with(session, scene, c, {}), grid = render_with(session, scene, c, automatic_grid);
    CHECK(image_and_events(grid) == image_and_events(plain));
    REQUIRE(grid.accel);
    CHECK(grid.accel->separate == 1);  // the ground polygon
    CHECK(tests_of(plain.events) > 20 * tests_of(grid.events));
    CHECK(grid.pe_memory.job_words == plain.pe_memory.job_words + grid.accel->words);
    const RingResult tree = render_with(session, scene, c, bvh);
    CHECK(image_and_events(tree) == image_and_events(plain));
    CHECK(tests_of(plain.events) > 20 * tests_of(tree.events));
    CHECK(tree.pe_memory.job_words == plain.pe_memory.job_words + tree.accel->words);
}

// Each fault injected into the BVH's kernels must change an image or a count. One scene has objects of every kind, most
// of them several BVH nodes deep. In the other scene, rays hit many objects at equal distances.
TEST_CASE("every injected fault in the BVH traversal is detected", "[ring][accel][faults]") {
    Session session(choose_device(""));
    Scene copies = crowded_scene(3);  // gets 20 copies of each sphere, more than a leaf holds
    const std::vector<Sphere> spheres(copies.spheres.begin(), copies.spheres.begin() + 10);
    for (int i = 0; i < 20; ++i)
        for (const Sphere& s : spheres) copies.spheres.push_back({s.centre, 1, i < 7 ? 0 : 1});
    const std::vector<Scene> scenes = {crowded_scene(2), copies};
    RingSettings settings = raya::settings_of({.width = 24, .height = 20, .pes = 6, .bounces = 3});
    settings.accel = bvh;
    const auto results = [&](const char* format) {
        settings.format = parse_format(format);
        std::string text;
        for (const Scene& scene : scenes) {
            const RingResult result = RingRenderer(session, scene, settings).render();
            text += image_and_events(result) + std::to_string(tests_of(result.events)) + " ";
        }
        return text;
    };
    const std::map<std::string, std::string> expected = {{"fp32", results("fp32")}, {"spa22", results("spa22")}};
    struct Fault {
        SourcePatch patch;
        const char* format = "fp32";
    };
    const std::vector<Fault> faults = {
        {{"bvh/boxes.clh", "inverse < 0.0f, (index)((RAYA_BVH_HIGH", "inverse < 2.0f, (index)((RAYA_BVH_HIGH"}},
        {{"bvh/meet_leaves.clh", "p->distance.all = h.distance;", "p->distance.all = h.distance * 0.99f;"}, "spa22"},
        {{"bvh/leaves.clh", "return popcount(crossed) & 1u;", "return crossed & 1u;"}},
        {{"bvh/boxes.clh", "const mask enters = near <= far;", "const mask enters = near + 0.01f <= far;"}},
        {{"bvh/boxes.clh", "popcount(entered) - 1", "popcount(entered) - 2 + (popcount(entered) == 1)"}},
        {{"bvh/descent.clh", "!(p->entries[lane][at] > p->distance.lane[lane])",
          "!(p->entries[lane][at] * 1.01f > p->distance.lane[lane])"}},
        {{"bvh/descent.clh", "!shadow || p->object.lane[lane]", "p->object.lane[lane]"}},
        {{"bvh/leaves.clh", "number < h->object;", "number > h->object;"}},
        {{"bvh/leaves.clh", "crosses_edge(seen[2], seen[3]) ^ crosses_edge(seen[3], seen[0])",
          "crosses_edge(seen[2], seen[0])"}},
        {{"geometry/cone.clh", "choose(in & mask_not(out & (x.t_out <= x.t_in))", "choose(in & mask_not(out)"}},
        {{"bvh/meet_leaves.clh", "raya_link_number(p->link[lane]);", "raya_link_number(p->link[lane]) & ~1u;"},
         "spa22"},
        {{"bvh/ray_pool.clh", "m & mask_not(done);", "m & mask_not(done) & (r->direction.x > 0.0f);"}}};
    for (const Fault& fault : quick_of(2, faults)) {
        settings.kernels.sources.patches = {fault.patch};
        check_patches(settings.kernels.sources);
        CAPTURE(fault.patch.file, fault.patch.replace);
        CHECK(results(fault.format) != expected.at(fault.format));
    }
}

TEST_CASE("a grid that does not fit a PE is refused; the message gives the PE's memory and a remedy", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("centre");
    RingCase c{.machine = "spa"};
    CHECK_THROWS_WITH(render_with(session, scene, c, grid_of(32, 32, 32)),
                      Catch::Contains("32 KB") && Catch::Contains("--machine grande"));
    CHECK_NOTHROW(render_with(session, scene, c, grid_of(8, 8, 8)));
}

}  // namespace raya
