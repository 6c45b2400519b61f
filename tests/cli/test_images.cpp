// The image files of a render: exposure, scales.
#include <cmath>

#include "host/base/whole_file.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/scene/scaled_scene.hpp"

namespace raya {
namespace {

TEST_CASE("render --exposure: changes the 8-bit values, not the hash; the report contains it", "[cli]") {
    const RenderFiles usual("planes", {}, ".ppm"), toned("planes", {"--exposure", "-1.5"}, ".ppm");
    CHECK((usual.report()["image"]["exposure"] == 0.0 && toned.report()["image"]["exposure"] == -1.5));
    CHECK(toned.report()["image"]["hash"] == usual.report()["image"]["hash"]);
    CHECK(file_contents(toned.image()) != file_contents(usual.image()));
}

TEST_CASE("render: loads OpenCL drivers before the image encoder module", "[cli]") {
    const ScratchFolder scratch;
    const RunOptions log_libraries{.variables = {{"LD_DEBUG", "libs"}}};
    const RunOutcome run =
        run_raya({"render", scene_file("planes"), "-o", scratch / "x.tif", "--size", "4", "--pes", "1", "--lanes", "4"},
                 log_libraries);
    CHECK(run.code == 0);
    const std::size_t driver = run.err.find("/libpocl"), module = run.err.find("raya_pictures.so");
    CHECK(driver < module);
    CHECK(module != std::string::npos);
}

TEST_CASE("render: scales a scene that exceeds the range of the format, and reports the scale's exponent", "[cli]") {
    const ScratchFolder folder;
    Scene scene = read_nff(scene_file("mirrors"));
    scene.planes.clear();
    for (const Arguments& options :
         {Arguments{"--machine", "spa", "--pes", "24"}, {"--machine", "torus", "--nodes", "2x1x1"}}) {
        std::string hash;
        for (const int power : {0, 14, -20, 60, -60}) {
            CAPTURE(options, power);
            write_whole_file(folder / "s.nff", write_nff(scaled_scene(scene, std::ldexp(1, power))));
            Arguments arguments = {"render",          folder / "s.nff", "-o", folder / "x.pfm", "--report",
                                   folder / "x.json", "--size",         "24", "--lanes",        "4"};
            arguments.insert(arguments.end(), options.begin(), options.end());
            const RunOutcome run = run_raya(arguments);
            INFO(run.describe());
            REQUIRE(run.code == 0);
            const Document report = json_of(folder / "x.json");
            const int exponent = report["machine"]["length_exponent"];
            CHECK(contains(run.out, "scale   lengths x 2^") == (exponent != 0));
            const bool exceeds_range = options[1] == "spa" ? power != 0 : std::abs(power) == 60;
            CHECK((exponent != 0) == exceeds_range);
            CHECK((exponent == 0 || (exponent < 0) == (power > 0)));
            if (power == 0) hash = report["image"]["hash"];
            CHECK(report["image"]["hash"] == hash);
        }
    }
}

}  // namespace
}  // namespace raya
