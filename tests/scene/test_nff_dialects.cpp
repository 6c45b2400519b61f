// NFF dialects: the entities that the reader skips, its remarks, and the errors that it reports.
#include <catch2/catch.hpp>
#include <string>

#include "host/error.hpp"
#include "host/scene/nff.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

const std::string kView = "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 1\nresolution 8 8\n";  // 7 lines
const std::string kSphere = "s 0 0 0 1\n";

struct Parsed {
    Scene scene;
    std::vector<std::string> remarks;
};

Parsed parse_lenient(const std::string& text) {
    Parsed parsed;
    std::vector<SceneRemark> nff_remarks;
    parsed.scene = parse_nff(text, "t.nff", &nff_remarks);
    for (const SceneRemark& remark : nff_remarks) parsed.remarks.push_back(remark_text("t.nff", remark));
    return parsed;
}

using Remarks = std::vector<std::string>;

TEST_CASE("polygons without area are skipped and counted", "[dialects]") {
    const Parsed parsed = parse_lenient(kView + "p 3\n0 0 0\n1 0 0\n2 0 0\n" + kSphere + "p 3\n0 0 0\n0 0 0\n2 0 0\n" +
                                        "pp 3\n1 1 1 0 0 1\n1 1 1 0 0 1\n1 1 1 0 0 1\np 2\n0 0 0\n1 0 0\np 4\n0 0 0\n1 "
                                        "1 0\n1 0 0\n0 1 0\np 3\n0 0 0\n1 0 0\n0 1 0\n");
    CHECK(parsed.remarks == Remarks{"t.nff:8: polygon without area, left out (5 in all)"});
    CHECK(parsed.scene.polygons.size() == 1);
    CHECK(parsed.scene.spheres.size() == 1);
}

TEST_CASE("a checker before a skipped polygon is skipped, too", "[dialects]") {
    const Parsed parsed =
        parse_lenient(kView + "#raya checker 1 1 1 0 0 0 1\np 3\n0 0 0\n1 0 0\n2 0 0\np 3\n0 0 0\n1 0 0\n0 1 0\n");
    REQUIRE(parsed.scene.polygons.size() == 1);
    CHECK_FALSE(parsed.scene.surfaces[0].checker);
}

TEST_CASE("non-planar polygons and patches are cut into triangles, which keep the patches' normals", "[dialects]") {
    const std::string bent = "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n";
    const Parsed flat = parse_lenient(kView + "p 4\n" + bent);
    CHECK(flat.remarks == Remarks{"t.nff:8: polygon that is not flat, cut into triangles"});
    REQUIRE(flat.scene.polygons.size() == 2);
    for (const Polygon& triangle : flat.scene.polygons) CHECK(triangle.vertices.size() == 3);
    const Parsed patch = parse_lenient(kView + "pp 4\n0 0 0 0 0 1\n1 0 0 1 0 0\n1 1 0.5 0 1 0\n0 1 0 0 0 1\n");
    REQUIRE(patch.scene.polygons.size() == 2);
    for (const Polygon& triangle : patch.scene.polygons)
        for (std::size_t i = 0; i < 3; ++i) {
            const bool second = triangle.vertices[i] == Vec3(1, 0, 0), third = triangle.vertices[i] == Vec3(1, 1, 0.5);
            CHECK(triangle.normals[i] == (second ? Vec3(1, 0, 0) : third ? Vec3(0, 1, 0) : Vec3(0, 0, 1)));
        }
    CHECK(parse_lenient(kView + "p 4\n0 0 0\n1 0 0\n1 1 0.0001\n0 1 0\n").remarks.empty());  // within the tolerance
}

TEST_CASE("objects without size and normals without length are ignored", "[dialects]") {
    const Parsed parsed = parse_lenient(kView + kSphere + "s 1 1 1 0\nc 0 0 0 0 0 0 1 0\nc 0 0 0 1 0 0 0 1\n" +
                                        "pp 3\n0 0 0 0 0 0\n1 0 0 0 0 1\n0 1 0 0 0 1\n");
    CHECK(parsed.remarks == Remarks{"t.nff:9: sphere of radius 0, left out", "t.nff:10: cone without radius, left out",
                                    "t.nff:11: cone without height, left out",
                                    "t.nff:12: patch with a normal of 0, taken as a flat polygon"});
    CHECK(parsed.scene.object_count() == 2);
    CHECK(parsed.scene.polygons[0].normals.empty());
}

TEST_CASE("entities of other dialects are skipped with the numbers that follow them", "[dialects]") {
    const Parsed parsed =
        parse_lenient("number 3\n" + kView + "la 0.2 0.2 0.2\n" + kSphere +
                      "lf 0 0 0\n1 1 1\n 0.5\ntt wood.ppm 1 2 3\n0 0 0 0 0\n1 0 0 1 0\nQ\nla 0.1 0.1 0.1  # again\n" +
                      "texture marble.tga\n" + kSphere);
    CHECK(parsed.remarks == Remarks{"t.nff:1: entity 'number' of another dialect, skipped",
                                    "t.nff:9: entity 'la' of another dialect, skipped (2 in all)",
                                    "t.nff:11: entity 'lf' of another dialect, skipped",
                                    "t.nff:14: entity 'tt' of another dialect, skipped",
                                    "t.nff:17: entity 'Q' of another dialect, skipped",
                                    "t.nff:19: entity 'texture' of another dialect, skipped"});
    CHECK(parsed.scene.spheres.size() == 2);
}

TEST_CASE("text that is not NFF is refused, and so are files without view or objects", "[dialects]") {
    for (const std::string line : {"<html>", "{ 1 2 }", "verylongword 1 2 3", "main() { return 0; }", "a/b 1"}) {
        CAPTURE(line);
        CHECK_THROWS_WITH(parse_lenient(kView + line + "\n" + kSphere), Contains("t.nff:8: unknown entity"));
    }
    CHECK_THROWS_WITH(parse_lenient("la 1 1 1\n" + kSphere), Contains("no 'v'"));
    CHECK_THROWS_WITH(parse_lenient(kView + "tt wood.ppm\n0 0 0\n"), Contains("no object"));
    // The rules for NFF's own entities stay strict in lenient mode.
    CHECK_THROWS_WITH(parse_lenient(kView + "s 0 0 0\n"), Contains("file ends"));
    CHECK_THROWS_WITH(parse_lenient(kView + "s 0 0 0 1 2\n"), Contains("follows the end"));
    CHECK_THROWS_WITH(parse_lenient(kView + kView + kSphere), Contains("second 'v'"));
}

}  // namespace
}  // namespace raya
