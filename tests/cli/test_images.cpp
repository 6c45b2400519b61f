// The image files of a render: reproducible bytes, scales.
#include <unistd.h>

#include <array>

#include "host/base/whole_file.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/scene/scaled_scene.hpp"

namespace raya {
namespace {

TEST_CASE("render: equal renders write equal bytes, without date, host or program", "[cli]") {
    std::array<char, 256> host{};
    REQUIRE(::gethostname(host.data(), host.size() - 1) == 0);
    const std::string name = host.data();
    for (const std::string extension : {".png", ".exr", ".pfm", ".ppm", ".tif", ".jpg"}) {
        CAPTURE(extension);
        const std::string cost_extension = extension == ".exr" ? ".exr" : ".pfm";
        const RenderFiles first("centre", {"--offset", "3"}, extension, cost_extension),
            second("centre", {"--offset", "3"}, extension, cost_extension);
        CHECK(file_contents(first.image()) == file_contents(second.image()));
        CHECK(file_contents(first.cost()) == file_contents(second.cost()));
        for (const std::string& path : {first.image(), first.cost()}) {
            const std::string bytes = file_contents(path);
            for (const std::string key : {"DateTime", "tIME", "HostComputer", "Software", "owner"})
                CHECK_FALSE(contains(bytes, key));
            if (name.size() >= 6) CHECK_FALSE(contains(bytes, name));  // pixels may contain a shorter name by chance
        }
    }
}

TEST_CASE("render --exposure: changes the 8-bit values, not the hash; the report contains it", "[cli]") {
    const RenderFiles usual("planes", {}, ".ppm"), toned("planes", {"--exposure", "-1.5"}, ".ppm");
    CHECK((usual.report()["image"]["exposure"] == 0.0 && toned.report()["image"]["exposure"] == -1.5));
    CHECK(toned.report()["image"]["hash"] == usual.report()["image"]["hash"]);
    CHECK(file_contents(toned.image()) != file_contents(usual.image()));
}

TEST_CASE("render --machine grande: without a report the image is the same", "[cli]") {
    const ScratchFolder folder;
    const auto image = [&](const Arguments& more) {
        Arguments arguments = {
            "render", scene_file("polygons"), "--machine", "grande", "--accel", "bvh", "--size", "32", "--lanes", "16",
            "-o",     folder / "x.ppm"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        REQUIRE(run_raya(arguments).code == 0);
        return file_contents(folder / "x.ppm");
    };
    CHECK(image({}) == image({"--report", folder / "r.json"}));
}

TEST_CASE("render: loads OpenCL drivers before the image encoder module", "[cli]") {
    const ScratchFolder scratch;
    const RunOptions log_libraries{.variables = {{"LD_DEBUG", "libs"}}};
    const RunOutcome run =
        run_raya({"render", scene_file("planes"), "-o", scratch / "x.png", "--size", "4", "--pes", "1"}, log_libraries);
    CHECK(run.code == 0);
    const std::size_t driver = run.err.find("/libpocl"), module = run.err.find("raya_pictures.so");
    CHECK(driver < module);
    CHECK(module != std::string::npos);
}

TEST_CASE("render: scales a scene that exceeds the range of the format, and reports the scale's exponent", "[cli]") {
    const ScratchFolder folder;
    Scene scene = read_nff(scene_file("mirrors"));
    scene.planes.clear();
    const std::string original = folder / "plain.nff", large = folder / "large.nff", tiny = folder / "tiny.nff";
    write_whole_file(original, write_nff(scene));
    write_whole_file(large, write_nff(scaled_scene(scene, 0x1p14)));
    write_whole_file(tiny, write_nff(scaled_scene(scene, 0x1p-20)));
    const std::string light_years = folder / "light-years.nff", atoms = folder / "atoms.nff";
    write_whole_file(light_years, write_nff(scaled_scene(scene, 0x1p60)));
    write_whole_file(atoms, write_nff(scaled_scene(scene, 0x1p-60)));
    for (const char* machine : {"spa", "grande", "torus"}) {
        CAPTURE(machine);
        const Arguments options = {"--machine", machine, "--size", "24"};
        const auto report_of = [&](const std::string& file) {
            Arguments arguments = {"render",  file, "-o",       folder / "x.pfm",
                                   "--lanes", "4",  "--report", folder / "x.json"};
            arguments.insert(arguments.end(), options.begin(), options.end());
            if (machine == std::string("spa")) arguments.insert(arguments.end(), {"--pes", "24"});
            const RunOutcome run = run_raya(arguments);
            INFO(run.describe());
            REQUIRE(run.code == 0);
            const Document report = Document::parse(file_contents(folder / "x.json"));
            CHECK((run.out.find("scale   lengths x 2^") != std::string::npos) ==
                  (report["machine"]["length_exponent"] != 0));
            return report;
        };
        const Document unscaled_report = report_of(original), large_report = report_of(large),
                       tiny_report = report_of(tiny);
        CHECK(unscaled_report["machine"]["length_exponent"] == 0);
        CHECK((large_report["machine"]["length_exponent"] < 0) ==
              (machine == std::string("spa")));  // the other machines use fp32
        CHECK((tiny_report["machine"]["length_exponent"] > 0) == (machine == std::string("spa")));
        CHECK(large_report["image"]["hash"] == unscaled_report["image"]["hash"]);
        CHECK(tiny_report["image"]["hash"] == unscaled_report["image"]["hash"]);
        CHECK(report_of(light_years)["image"]["hash"] == unscaled_report["image"]["hash"]);
        CHECK(report_of(atoms)["image"]["hash"] == unscaled_report["image"]["hash"]);
        CHECK(unscaled_report["rays"]["primary_hits"] > 0);
    }
}

}  // namespace
}  // namespace raya
