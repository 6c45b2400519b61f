#include <catch2/catch.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "tests/paths.h"

using namespace raya;

namespace {

const std::string kShortView = "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 0.5\nresolution 320 200\n";
const std::string kOneSphere = "s 0 0 0 1\n";
const std::string kTriangle = "p 3 0 0 0 1 0 0 0 1 0\n";
const std::string kChecker = "#raya checker 1 1 1 0 0 0 1\n";

struct Row {
    std::string text;
    const char* message;  // start of the expected message, "LINE: reason"
};

/// Returns the error message of parse_nff() for a text, or "accepted" if parse_nff() throws no error.
std::string error_message_of(const std::string& text) {
    try {
        parse_nff(text, "folder/t.nff");
    } catch (const UserError& error) {
        return error.what();
    }
    return "accepted";
}

void check(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        CAPTURE(row.text);
        CHECK_THAT(error_message_of(row.text), Catch::StartsWith(std::string("folder/t.nff:") + row.message));
    }
}

/// Appends each row's text to a valid view and sphere, so that the text starts on line 9, and checks the rows.
void check_entities(std::vector<Row> rows) {
    for (Row& row : rows) row.text = kShortView + kOneSphere + row.text;
    check(rows);
}

/// Returns the text of a view and a sphere with one line replaced. `old_line` must be a line of kShortView.
std::string view_with(const std::string& old_line, const std::string& new_line) {
    std::string text = kShortView + kOneSphere;
    return text.replace(text.find(old_line), old_line.size(), new_line);
}

}  // namespace

TEST_CASE("files of other formats are refused", "[nff]") {
    check({{std::string("\x89PNG\r\n\x1a\n\0\0", 10), "2: a control character: is this a binary file?"},
           {std::string("s\0 1", 4), "1: a control character"},
           {"# \x01\n", "1: a control character"},
           {"<html>", "1: unknown entity '<html>'; NFF has v b l f s p pp c; the names of meshes end in .obj,"},
           {"mtllib a.mtl\n", "1: unknown entity 'mtllib'"},
           {"{\"kind\": 1}", "1: unknown entity '{\"kind\":'"},
           {"\xFF\xFE", "1: unknown entity '\?\?'"},
           {"", "1: no 'v'"}});
}

TEST_CASE("scenes without a view or an object are refused", "[nff]") {
    check({{kOneSphere, "2: no 'v': the file has no viewpoint"},
           {kShortView, "8: no object: the image would be empty"},
           {kShortView + "f 1 1 1 1 0 0 0 1\nl 1 1 1\n", "10: no object"}});
}

TEST_CASE("invalid numbers are refused", "[nff]") {
    check_entities({{"s 0 0 zero 1", "9: the centre of 's': 'zero' is not a number"},
                    {"s 0 0 nan 1", "9: the centre of 's': 'nan' is not a finite number"},
                    {"s 0 0 0\n-inf", "10: the radius of 's': '-inf' is not a finite number"},
                    {"s 0 0 1e999 1", "9: the centre of 's': '1e999' is outside the range of double precision"},
                    {"s 0 0 1e-999 1", "9: the centre of 's': '1e-999' is outside the range"},
                    {"s 0 0 1.5x 1", "9: the centre of 's': '1.5x' has characters after the number"},
                    {"s 0 0 0x10 1", "9: the centre of 's': '0x10' has characters after the number"},
                    {"s 0 0 1,5 1", "9: the centre of 's': '1,5' has characters after the number"},
                    {"s 0 0 +-1 1", "9: the centre of 's': '+-1' is not a number"},
                    {"s 0 0 1.1e30 1", "9: the centre of 's': '1.1e30' is out of range: at most 1e+30 in magnitude"},
                    {"s 0 0 0 -2e30", "9: the radius of 's': '-2e30' is out of range"},
                    {"f 1 1 1 1 0 1e30 0 1", "9: Shine of 'f': '1e30' is out of range: at most 1e+09 in magnitude"},
                    {"b 0 0 1e10", "9: the background colour of 'b': '1e10' is out of range"}});
}

TEST_CASE("entities with too few or too many values are refused", "[nff]") {
    check_entities(
        {{"s 0 0 0\ns 0 0 0 1", "10: 's' of line 9 is incomplete: expected the radius, found 's'"},
         {"s 0 0", "9: the file ends before the centre of 's'"},
         {"p 3\n0 0 0\n1 0 0\n\n", "13: the file ends before a vertex of 'p'"},
         {"p 3\n0 0 0\n1 0 0\nf 1 1 1 1 0 0 0 1", "12: 'p' of line 9 is incomplete: expected a vertex, found 'f'"},
         {"pp 3\n0 0 0 0 0 1\n1 0 0\n", "12: the file ends before a normal of 'pp'"},
         {"c 0 0 0 1\n#raya plane 0 0 1 0\n", "10: 'c' of line 9 is incomplete: expected the apex, found '#raya'"},
         {"l 0 0 0 1 1\ns 0 0 0 1", "10: 'l' of line 9 is incomplete: expected the light's colour, found 's'"},
         {"f 1 1 1 1 0 0 0", "9: the file ends before the index of refraction of 'f'"},
         {"b 1 1", "9: the file ends before the background colour of 'b'"},
         {"s 0 0 0 1 s 0 0 0 1", "9: 's' follows the end of 's'; a new entity starts on a new line"},
         {"s 0 0 0 1 2", "9: '2' follows the end of 's'"},
         {"l 0 0 0 1 1 1\n2", "10: '2' instead of an entity: does the previous one have too many numbers?"},
         {"p 3 0 0 0 1 0 0 1 1 0\n0 1 0\n", "10: '0' instead of an entity"},
         {"poly 3", "9: unknown entity 'poly'"},
         {"S 0 0 0 1", "9: unknown entity 'S'"}});
}

TEST_CASE("invalid views are refused", "[nff]") {
    const char* range = "must be a whole number from 1 to 16384";
    check(
        {{kShortView + kShortView + kOneSphere, "8: a second 'v'"},
         {view_with("angle 40\n", ""), "7: 'v' is incomplete: 's' follows; missing parts: angle"},
         {"v\nfrom 0 0 1\nat 0 0 0", "3: 'v' is incomplete: the file ends; missing parts: up angle hither resolution"},
         {view_with("angle 40", "at 0 0 2"), "5: 'at' occurs twice in 'v'"},
         {view_with("at 0 0 1", "at 0 -5 1"), "1: 'from' and 'at' are the same point"},
         {view_with("angle 40", "angle 0"), "1: the angle is 0: must lie between 0 and 180 degrees"},
         {view_with("angle 40", "angle 180"), "1: the angle is 180"},
         {view_with("angle 40", "angle -40"), "1: the angle is -40"},
         {view_with("up 0 0 1", "up 0 2 0"), "1: 'up' is zero or parallel to the viewing direction"},
         {view_with("up 0 0 1", "up 0 -1 1e-9"), "1: 'up' is zero or parallel to the viewing direction"},
         {view_with("up 0 0 1", "up 0 0 0"), "1: 'up' is zero or parallel to the viewing direction"}});
    for (const char* size : {"0 200", "-1 200", "16385 200", "1.5 200"}) {
        const std::string message = error_message_of(view_with("320 200", size));
        CHECK_THAT(message, Catch::StartsWith("folder/t.nff:7: the width of 'v' is ") && Catch::EndsWith(range));
    }
    for (const char* size : {"320 0", "320 1e9", "320 0.5"}) {
        const std::string message = error_message_of(view_with("320 200", size));
        CHECK_THAT(message, Catch::StartsWith("folder/t.nff:7: the height of 'v' is ") && Catch::EndsWith(range));
    }
    CHECK(error_message_of(view_with("320 200", "16384 1")) == "accepted");
    CHECK(error_message_of(view_with("hither 0.5", "hither -1")) == "accepted");
}

TEST_CASE("invalid colours and surfaces are refused", "[nff]") {
    check_entities({{"b 0 -0.1 0", "9: the background colour is negative"},
                    {"b 0 0 0\nb 0 0 0", "10: a second 'b'"},
                    {"l 0 0 0 1 1 -1", "9: the light's colour is negative"},
                    {"f -1 1 1 1 0 0 0 1", "9: the colour is negative"},
                    {"f 1 1 1 -0.5 0 0 0 1", "9: Kd is -0.5: must be 0..100"},
                    {"f 1 1 1 101 0 0 0 1", "9: Kd is 101"},
                    {"f 1 1 1 1 -1 0 0 1", "9: Ks is -1"},
                    {"f 1 1 1 1 1e6 0 0 1", "9: Ks is 1000000"},
                    {"f 1 1 1 1 0 0 -0.1 1", "9: T is -0.1"},
                    {"f 1 1 1 1 0 0 200 1", "9: T is 200"},
                    {"f 1 1 1 1 0 -1 0 1", "9: Shine is -1: must not be negative"},
                    {"f 1 1 1 1 0 0 0.5 0", "9: the index of refraction is 0: must be positive where T > 0"},
                    {"f 1 1 1 1 0 0 0.5 -1.5", "9: the index of refraction is -1.5"}});
    CHECK(error_message_of(kShortView + "f 2 2 2 1 0 0 0 -1\n" + kOneSphere) == "accepted");
}

TEST_CASE("invalid spheres and cones are refused", "[nff]") {
    check_entities({{"s 0 0 0 0", "9: the radius of the sphere is zero"},
                    {"s 0 0 0 -1e-31", "9: the radius of the sphere is zero"},
                    {"c 0 0 0 0 0 0 1 0", "9: both radii of the cone are zero"},
                    {"c 0 0 0 1 0 0 1 -1", "9: one radius of the cone is negative, the other positive"},
                    {"c 0 0 0 -1 0 0 1 0.5", "9: one radius of the cone is negative"},
                    {"c 1 2 3 1\n1 2 3 2", "9: the height of the cone is zero"}});
    for (const char* cone : {"c 0 0 0 0 0 0 1 1", "c 0 0 0 -1 0 0 1 0", "c 0 0 0 0 0 0 1 -1"})
        CHECK(error_message_of(kShortView + cone) == "accepted");
}

TEST_CASE("invalid polygons are refused", "[nff]") {
    check_entities({{"p 2 0 0 0 1 0 0", "9: the number of vertices of 'p' is 2: must be a whole number from 3"},
                    {"p -3", "9: the number of vertices of 'p' is -3"},
                    {"p 3.5", "9: the number of vertices of 'p' is 3.5"},
                    {"p 4294967299 0 0 0", "9: the number of vertices of 'p' is 4294967299: must be a whole number "},
                    {"p 1000000000\n0 0 0\n", "9: the file is too short for a polygon of 1000000000 vertices"},
                    {"pp 1000\n0 0 0 0 0 1\n", "9: the file is too short for a polygon of 1000 vertices"},
                    {"p 4 0 0 0 1 0 0 1 0 0 0 0 0", "9: the polygon has fewer than three different vertices"},
                    {"p 3 1 1 1 1 1 1 1 1 1", "9: the polygon has fewer than three different vertices"},
                    {"p 3 0 0 0 0.1 0.1 0.1 0.3 0.3 0.3", "9: the polygon has no area"},
                    {"p 4 0 0 0 1 1 0 1 0 0 0 1 0", "9: the polygon has no area"},
                    {"p 3 0 0 0 1e-31 0 0 0 1e-31 0", "9: the polygon is smaller than 1e-30"},
                    {"p 4 0 0 0 1 0 0 1 1 0.1 0 1 0", "9: the polygon is not flat: a vertex lies 0.02"},
                    {"pp 4 0 0 0 0 0 1 1 0 0 0 0 1 1 1 0.1 0 0 1 0 1 0 0 0 1", "9: the polygon is not flat"},
                    {"pp 3 0 0 0 0 0 1 1 0 0 0 0 0 0 1 0 0 0 1", "9: a normal of the patch is zero"}});
}

TEST_CASE("invalid #raya extensions are refused", "[nff]") {
    check_entities(
        {{"#raya", "9: the file ends before 'plane' or 'checker' of '#raya'"},
         {"#raya\nplane 0 0 1 0", "9: the line ends before 'plane' or 'checker' of '#raya'"},
         {"#raya plan 0 0 1 0", "9: unknown extension 'plan'; raya knows '#raya plane' and '#raya checker'"},
         {"#raya plane 0 0 1\n0", "9: the line ends before the distance of '#raya plane'"},
         {"#raya plane 0 0 1\ns 0 0 0 1", "9: the line ends before the distance of '#raya plane'"},
         {"#raya plane 0 0 1 0 0", "9: '0' follows the end of '#raya plane'"},
         {"#raya plane 0 0 0 1", "9: the normal of the plane is zero"},
         {"#raya plane 0 0 1e-30 10", "9: the plane is too far from the origin"},
         {"s 0 0 0 1 #raya plane 0 0 1 0", "9: '#raya' must be the first word of its line"},
         {kChecker, "9: no plane or polygon follows this '#raya checker'"},
         {kChecker + kOneSphere, "9: no plane or polygon follows this '#raya checker'"},
         {kChecker + kChecker + kTriangle, "10: a second '#raya checker' before"},
         {"#raya checker 1 1 1 0 0 0 0\n" + kTriangle, "9: the size of the checker must be positive"},
         {"#raya checker 1 1 1 0 0 0 -1\n" + kTriangle, "9: the size of the checker must be positive"},
         {"#raya checker 1 1 1 0 0 -1 1\n" + kTriangle, "9: the second colour is negative"},
         {"#raya checker -1 1 1 0 0 0 1\n" + kTriangle, "9: the first colour is negative"},
         {"#raya checker 1 1 1 0 0 0\n" + kTriangle, "9: the line ends before the size of '#raya checker'"}});
}

TEST_CASE("files that cannot be read are refused", "[nff]") {
    CHECK_THROWS_WITH(read_nff(RAYA_SOURCE_DIR "/scenes/none.nff"),
                      Catch::EndsWith("scenes/none.nff: cannot read the scene: No such file or directory"));
    CHECK_THROWS_WITH(read_nff(RAYA_SOURCE_DIR "/scenes"),
                      Catch::EndsWith("scenes: cannot read the scene: it is a directory, not a file"));
    CHECK_THROWS_WITH(read_nff("/dev/null"), "/dev/null: cannot read the scene: not a regular file");
    CHECK_THROWS_AS(read_nff(RAYA_SOURCE_DIR "/scenes/none.nff"), UserError);
}

TEST_CASE("write_nff() refuses a checker that NFF cannot express", "[nff]") {
    Scene scene = parse_nff(kShortView + kOneSphere, "t.nff");
    scene.surfaces[0].checker = Checker{{1, 1, 1}, {0, 0, 0}, 1};
    CHECK_THROWS_WITH(write_nff(scene), "t.nff: NFF has no checkered spheres and cones; use a plane or polygon");
}
