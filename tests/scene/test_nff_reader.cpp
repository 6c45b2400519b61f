#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <string>

#include "host/base/encoding.hpp"
#include "host/scene/nff.hpp"
#include "tests/paths.h"
#include "tests/scene/spd_folder.hpp"

using namespace raya;

namespace {

const std::string kPlainView = "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.5\nresolution 320 200\n";

Scene scene_of(const std::string& entities) { return parse_nff(kPlainView + entities, "folder/t.nff"); }

}  // namespace

TEST_CASE("every entity is read as written", "[nff]") {
    const Scene s = scene_of(
        "b 0.1 0.2 0.3\nl 1 2 3\nl 4 5 6 0.7 0.8 0.9\nf 1 0.5 0.25 0.6 0.3 20 0.1 1.5\ns 1 2 3 0.5\ns 1 2 3 -0.5\n"
        "p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\npp 3\n0 0 0 0 0 2\n1 0 0 0 3 0\n0 1 0 4 0 0\nc 0 0 0 1 0 0 2 0.5\n");
    CHECK(s.name == "t.nff");
    CHECK(s.background == Colour(0.1, 0.2, 0.3));
    CHECK(s.view == View{{0, -5, 1}, {0, 0, 1}, {0, 0, 1}, 40, 0.5, 320, 200});
    CHECK(s.lights == std::vector<Light>{{{1, 2, 3}, {}}, {{4, 5, 6}, Colour(0.7, 0.8, 0.9)}});
    CHECK(s.surfaces == std::vector<Surface>{{{1, 0.5, 0.25}, 0.6, 0.3, 20, 0.1, 1.5, {}}});
    CHECK(s.spheres == std::vector<Sphere>{{{1, 2, 3}, 0.5, 0}, {{1, 2, 3}, -0.5, 0}});
    REQUIRE(s.polygons.size() == 2);
    CHECK(s.polygons[0] == Polygon{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}, 0});
    CHECK(s.polygons[1] == Polygon{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}, 0});
    CHECK(s.cones == std::vector<Cone>{{{0, 0, 0}, 1, {0, 0, 2}, 0.5, 0}});
    CHECK(s.object_count() == 5);
}

TEST_CASE("white space, comments and line ends do not change a scene", "[nff]") {
    const std::string entities = "l 1 2 3 1 1 1\nc 0 0 0 1 0 0 2 0.5\np 3\n0 0 0\n1 0 0\n0 1 0\n#raya plane 0 0 1 0\n";
    const Scene plain = scene_of(entities);
    CHECK(scene_of("l 1 2\n3\n1 1 1\n\n  c 0 0 0 1\n\t0 0 2 0.5\np\n3 0 0 0 1\n0 0 0 1 0\n  #raya plane 0 0 1 0") ==
          plain);
    CHECK(scene_of("# two\n#rayas \xC3\xA9\nl 1 2 3 # end\n1 1 1#\nc 0 0 0 1 # base\n0 0 2 0.5\n" +
                   entities.substr(entities.find('p'))) == plain);
    CHECK(parse_nff(replaced(kPlainView + entities, "\n", "\r\n"), "t.nff") == plain);
    CHECK(parse_nff(replaced(kPlainView + entities, "\n", "\r"), "t.nff") == plain);
    CHECK(parse_nff("\xEF\xBB\xBF" + kPlainView + entities, "t.nff") == plain);
    CHECK(parse_nff(entities + kPlainView, "t.nff") == plain);
    CHECK(scene_of(replaced(entities, " 1 ", " +1.0e0 ")) == plain);
}

TEST_CASE("the parts of the entity 'v' may have any order", "[nff]") {
    const Scene s =
        parse_nff("v resolution 320 200 hither 0.5 up 0 0 1\nangle 40 at 0 0 1\nfrom 0 -5 1\ns 0 0 0 1", "t.nff");
    CHECK(s.view == scene_of("s 0 0 0 1\n").view);
}

TEST_CASE("defaults: black background, white matt surface, intensity sqrt(n) / (2 n) of each of n lights", "[nff]") {
    const Scene s = scene_of("l 1 2 3\nl 3 2 1\ns 0 0 0 1\n");
    CHECK(s.background == Colour(0, 0, 0));
    CHECK(s.surfaces == std::vector<Surface>{Surface{}});
    CHECK(light_colour(s, s.lights[0]) == Colour(std::sqrt(2.0) / 4));
    CHECK(ambient_intensity(s) == std::sqrt(2.0) / 4);
}

TEST_CASE("equal surfaces are stored once, in order of first use by object number", "[nff]") {
    const Scene s = scene_of(
        "f 1 0 0 1 0 0 0 1\nc 0 0 0 1 0 0 2 0.5\nf 0 1 0 1 0 0 0 1\ns 0 0 0 1\nf 1 0 0 1 0 0 0 1\ns 1 0 0 1\n"
        "f 0 0 1 1 0 0 0 1\n");
    REQUIRE(s.surfaces.size() == 2);
    CHECK(s.surfaces[0].colour == Colour(0, 1, 0));
    CHECK(s.surfaces[1].colour == Colour(1, 0, 0));
    CHECK(s.spheres[0].surface == 0);
    CHECK(s.spheres[1].surface == 1);
    CHECK(s.cones[0].surface == 1);
}

TEST_CASE("a plane's normal and distance are normalised", "[nff]") {
    const Scene s = scene_of("#raya plane 0 3 4 10\n#raya plane 0 0 1e-300 0\n");
    REQUIRE(s.planes.size() == 2);
    CHECK((s.planes[0].normal - Vec3(0, 0.6, 0.8)).length() < 1e-15);
    CHECK(s.planes[0].distance == Approx(2).epsilon(1e-15));
    CHECK(s.planes[1].normal == Vec3(0, 0, 1));
}

TEST_CASE("a checker applies only to the next plane or polygon", "[nff]") {
    const std::string checker = "#raya checker 1 0 0 0 0 1 0.5\n", triangle = "p 3 0 0 0 1 0 0 0 1 0\n";
    const Scene s = scene_of("f 0 1 0 0.5 0.2 9 0 1\n" + checker + "s 0 0 0 1\n" + triangle + triangle + checker +
                             "#raya plane 0 0 1 0\n#raya plane 0 0 1 1\n");
    REQUIRE(s.surfaces.size() == 2);
    const Surface &plain = s.surfaces[0], &checkered = s.surfaces[1];
    CHECK(plain == Surface{{0, 1, 0}, 0.5, 0.2, 9, 0, 1, {}});
    CHECK(checkered == Surface{{0, 1, 0}, 0.5, 0.2, 9, 0, 1, Checker{{1, 0, 0}, {0, 0, 1}, 0.5}});
    CHECK(s.spheres[0].surface == 0);
    CHECK(s.polygons[0].surface == 1);
    CHECK(s.polygons[1].surface == 0);
    CHECK(s.planes[0].surface == 1);
    CHECK(s.planes[1].surface == 0);
}

TEST_CASE("repeated vertices are dropped with their normals", "[nff]") {
    const Scene s =
        scene_of("p 6 0 0 0 0 0 0 1 0 0 0 1 0 0 1 0 0 0 0\npp 4 0 0 0 1 0 0 1 0 0 0 1 0 1 0 0 0 0 1 0 1 0 1 0 0\n");
    CHECK(s.polygons[0].vertices.size() == 3);
    CHECK(s.polygons[1] == Polygon{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}}, 0});
}

TEST_CASE("polygons may be concave, small, distant and slightly non-planar", "[nff]") {
    CHECK_NOTHROW(scene_of("p 6 0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0\n"));
    CHECK_NOTHROW(scene_of("p 3 0 0 0 1e-6 0 0 0 1e-6 0\n"));
    CHECK_NOTHROW(scene_of("p 3 1e6 1e6 0 1000000.1 1e6 0 1e6 1000000.1 0\n"));
    CHECK_NOTHROW(scene_of("p 4 0 0 0 1 0 0.001 1 1 0 0 1 0.001\n"));
}

TEST_CASE("a scene is equal after writing and reading", "[nff]") {
    const Scene s = scene_of(
        "b 0.1 0.2 0.3\nl 1e-9 2.5 -3 1 2 3\nf 0.1 0.7 1e-5 0.333333333333 0 1e5 0.9 1.5\ns 0.1 0.2 "
        "0.30000000000000004 -7\n"
        "c 0 0 0 -1 0 0 2 -0.5\nf 1 1 1 1 0 0 0 -1\npp 3 0 0 0 1 2 3 1 0 0 4 5 6 0 1 0 -7 8 9\n"
        "#raya checker 1 0 0 0 0 1 0.5\np 3 0 0 0 1 0 0 0 1 0\n#raya checker 1 0 0 0 0 1 0.5\n#raya plane 1 2 3 4\n");
    CHECK(parse_nff(write_nff(s), s.name) == s);
    CHECK(write_nff(s).find("s 0.1 0.2 0.30000000000000004 -7\n") != std::string::npos);
}

TEST_CASE("the project's scenes and SPD's files are equal after writing and reading", "[nff]") {
    int files = 0;
    for (const auto& folder : {std::filesystem::path(RAYA_SOURCE_DIR "/scenes"), spd_folder()}) {
        if (!std::filesystem::is_directory(folder)) continue;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            if (entry.path().extension() != ".nff") continue;
            INFO(entry.path());
            const Scene s = read_nff(entry.path());
            CHECK(s.name == entry.path().filename());
            CHECK(parse_nff(write_nff(s), s.name) == s);
            ++files;
        }
    }
    CHECK(files >= 7);
}
