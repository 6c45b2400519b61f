// Scenes that the program refuses. The tests of the NFF reader (tests/scene) cover all errors.
#include <filesystem>
#include <fstream>

#include "tests/cli/refusals.hpp"

namespace raya {
namespace {

const std::string kView = "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 1\nresolution 8 8\n";
const std::string kSphere = "s 0 0 0 1\n";

TEST_CASE("render: the error for an invalid scene names file, line and reason", "[cli]") {
    struct Row {
        std::string text;
        std::string message;  // "LINE: reason"
    };
    const std::string view_before_size = kView.substr(0, kView.find("8 8"));
    const std::vector<Row> rows = {
        {"nff\nversion 2.0\n", "1: this is Sense8's NFF"},
        {kSphere, "2: no 'v'"},
        {kView + "f 1 1 1 1 0 0 0 1\n", "9: no object"},
        {view_before_size + "100000 100000\n" + kSphere,
         "7: the width of 'v' is 100000: must be a whole number from 1 to 16384"},
        {kView + "s 0 0 0 0\n", "8: the radius of the sphere is zero"},
        {kView + "s 0 0 nan 1\n", "8: the centre of 's': 'nan' is not a finite number"},
        {kView + "p 3\n0 0 0\n1 0 0\n2 0 0\n", "8: the polygon "},
        {kView + "p 3\n0 0 0\n1 0 0\n", "11: the file ends before a vertex of 'p'"},
        {kView + "s 0 0 0 1 2\n", "8: '2' follows the end of 's'"},
        {kView + "teapot 1\n", "8: unknown entity 'teapot'; NFF has v b l f s p pp c"},
        {kView + "#raya torus 1\n", "8: unknown extension 'torus'"},
    };
    const ScratchFolder scenes, outputs;
    const std::string scene = scenes / "t.nff";
    for (const Row& row : rows) {
        std::ofstream(scene) << row.text;
        check_refused(outputs, render_into(outputs, scene, {"--strict"}), 2, {"raya: " + scene + ":" + row.message});
    }
}

TEST_CASE("render, bench: refuse a scene file that they cannot read", "[cli]") {
    const ScratchFolder scenes, outputs;
    const std::string missing = scenes / "missing.nff";
    check_refused(outputs, render_into(outputs, missing), 2, {missing, "cannot read the scene: No such file"});
    check_refused(outputs, render_into(outputs, scenes.path()), 2, {scenes.path(), "it is a directory, not a file"});
    check_refused(outputs, {"bench", missing}, 2, {missing, "cannot read the scene"});
}

TEST_CASE("render: the error for a scene that does not fit a PE has both sizes and the remedy", "[cli]") {
    const ScratchFolder scenes, outputs;
    const std::string scene = scenes / "balls4.nff";
    REQUIRE(run_raya({"generate", "balls", "--level", "4", "-o", scene}).code == 0);
    const std::string needed = "145.0 KB";  // 7,381 spheres of 5 words, and a few hundred words more
    check_refused(outputs, render_into(outputs, scene), 2,
                  {"balls4.nff: needs " + needed + " in every PE", "has 32 KB", "use --machine grande"});
}

}  // namespace
}  // namespace raya
