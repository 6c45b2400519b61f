// The image files of a render: attributes, and reproducible bytes.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "host/base/whole_file.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/scene/scaled_scene.hpp"

namespace raya {
namespace {

TEST_CASE("render: two renders with equal options write equal bytes", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr", ".pfm", ".ppm", ".tif", ".jpg");
    const std::string cost_extension = extension == ".exr" ? ".exr" : ".pfm";
    CAPTURE(extension, cost_extension);
    const RenderFiles first("centre", {}, extension, cost_extension), second("centre", {}, extension, cost_extension);
    CHECK(file_contents(first.image()) == file_contents(second.image()));
    CHECK(file_contents(first.cost()) == file_contents(second.cost()));
    CHECK(first.report()["image"]["hash"] == second.report()["image"]["hash"]);
}

TEST_CASE("render --machine grande: without a report the image is the same, and the summary has no load", "[cli]") {
    const ScratchFolder folder;
    const auto lines = [&](const Arguments& more) {
        Arguments arguments = {
            "render", scene_file("polygons"), "--machine", "grande", "--accel", "bvh", "--size", "32", "--lanes", "16",
            "-o",     folder / "x.ppm"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        REQUIRE(run.code == 0);
        std::map<std::string, std::string> by_name;
        std::istringstream text(run.out);
        for (std::string line; std::getline(text, line);) by_name[line.substr(0, line.find(' '))] = line;
        return by_name;
    };
    const auto quick = lines({}), counted = lines({"--report", folder / "r.json"});
    CHECK(quick.at("rays") == counted.at("rays"));
    CHECK(quick.at("image") == counted.at("image"));
    for (const char* name : {"load", "model"}) {
        CHECK_FALSE(quick.contains(name));
        CHECK(counted.contains(name));
    }
    CHECK_THAT(counted.at("bvh"), Catch::Contains("tests"));
    CHECK_THAT(quick.at("bvh"), !Catch::Contains("tests"));
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

TEST_CASE("render: PNG and EXR have the settings as attributes", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr");
    const RenderFiles files("centre", {"--offset", "3"}, extension, ".exr");
    const double u = files.report()["load"]["imbalance"];
    for (const std::string& path : {files.image(), files.cost()}) {
        CAPTURE(path);
        const auto image = OIIO::ImageInput::open(path);
        REQUIRE(image);
        const auto attribute = [&](const char* key) { return std::string(image->spec().get_string_attribute(key)); };
        CHECK(attribute("raya:scene") == "centre.nff");
        CHECK(attribute("raya:machine") == "spa");
        CHECK(attribute("raya:mapping") == "cyclic");
        CHECK(attribute("raya:offset") == "3");
        CHECK(attribute("raya:format") == "e6m15");
        CHECK(std::stod(attribute("raya:u")) == Approx(u).margin(0.5e-6));  // printed with six decimal places
    }
}

TEST_CASE("render: no file contains a date, or the name of a host or program", "[cli]") {
    const std::string extension = GENERATE(".png", ".exr", ".pfm", ".tif", ".jpg");
    CAPTURE(extension);
    std::array<char, 256> host{};
    REQUIRE(::gethostname(host.data(), host.size() - 1) == 0);
    const RenderFiles files("centre", {}, extension, extension == ".pfm" ? extension : ".exr");
    for (const std::string& path : {files.image(), files.cost()}) {
        const std::string bytes = file_contents(path);
        for (const std::string key : {"DateTime", "tIME", "HostComputer", "Software", "owner"})
            CHECK_FALSE(contains(bytes, key));
        const std::string name = host.data();
        if (name.size() >= 6) CHECK_FALSE(contains(bytes, name));  // pixels may contain a shorter name by chance
    }
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

TEST_CASE("render: warns of objects that the format cannot represent, and refuses a scene of only such objects",
          "[cli]") {
    const ScratchFolder folder;
    const std::string scene = folder / "far.nff";
    const auto render = [&](const std::string& spheres, const std::string& format) {
        write_whole_file(scene, "v\nfrom 0 -1e6 0\nat 0 0 0\nup 0 0 1\nangle 1\nhither 1\nresolution 8 8\n" + spheres);
        return run_raya({"render", scene, "-o", folder / "x.pfm", "--lanes", "4", "--pes", "8", "--format", format,
                         "--report", folder / "x.json"});
    };
    const RunOutcome warned = render("s 0 0 0 1000\ns 9 9 9 1e-5\n", "spa22");
    INFO(warned.describe());
    CHECK(warned.code == 0);
    CHECK_THAT(warned.messages(),
               Catch::StartsWith("raya: warning: far.nff: 1 spheres, cones or checkers are invisible") &&
                   Catch::Contains("the minimum of e6m15 in a scene with lengths up to 1e+06"));
    const Document report = Document::parse(file_contents(folder / "x.json"));
    REQUIRE(report["warnings"].size() == 1);
    CHECK_THAT(warned.err, Catch::Contains(report["warnings"][0].get<std::string>()));
    const RunOutcome refused = render("s 9 9 9 1e-5\n", "spa22");
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Catch::Contains("1e-05 to 1e+06") && Catch::Contains("remedy: --format fp32"));
    CHECK(render("s 9 9 9 1e-5\n", "fp32").code == 0);
}

TEST_CASE("render: warns of lines of other NFF dialects, also in the report; --strict refuses them", "[cli]") {
    const ScratchFolder folder;
    const std::string scene = folder / "t.nff";
    write_whole_file(scene,
                     "v\nfrom 0 -5 1\nat 0 0 1\nup 0 0 1\nangle 40\nhither 1\nresolution 8 8\nla 1 1 1\nla 0 0 0\n"
                     "p 3\n0 0 0\n0 0 0\n1 1 1\ns 0 0 0 1\n");
    const Arguments arguments = {"render", scene,   "-o", folder / "x.pfm", "--lanes",
                                 "4",      "--pes", "8",  "--report",       folder / "x.json"};
    const RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(run.messages() == "raya: warning: " + scene + ":8: entity 'la' of another dialect, skipped (2 in all)\n" +
                                "raya: warning: " + scene + ":10: polygon without area, left out\n");
    const Document report = Document::parse(file_contents(folder / "x.json"));
    REQUIRE(report["skipped"].size() == 2);
    CHECK(report["skipped"][0] ==
          Document{{"what", "entity 'la' of another dialect, skipped"}, {"count", 2}, {"line", 8}});
    CHECK(report["warnings"].size() == 2);
    Arguments strict = arguments;
    strict.push_back("--strict");
    CHECK(run_raya(strict).code == 2);
    for (const Arguments& command :
         {Arguments{"bench", scene, "--strict"}, Arguments{"explore", scene, "--strict", "-o", folder / "s.html"}}) {
        const RunOutcome refused = run_raya(command);
        INFO(refused.describe());
        CHECK(refused.code == 2);
        CHECK_THAT(refused.err, Catch::Contains("t.nff:8: unknown entity 'la'"));
    }
    CHECK(folder.entries() == 3);
}

TEST_CASE("render: refuses an output file that is another output or the scene under another name", "[cli]") {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "d");
    std::filesystem::create_symlink("x.pfm", folder / "link.pfm");
    for (const auto& [first_name, second_name] :
         {std::pair<std::string, std::string>{"x.pfm", "./x.pfm"}, {"x.pfm", "d/../x.pfm"}, {"link.pfm", "x.pfm"}}) {
        CAPTURE(first_name, second_name);
        const RunOutcome run = run_raya({"render", scene_file("planes"), "-o", folder / first_name, "--report",
                                         (folder.path() / second_name).string()});
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Catch::Contains("the same file as"));
    }
    const std::string scene = folder / "scene.nff";
    std::filesystem::copy(scene_file("planes"), scene);
    const RunOutcome run = run_raya({"render", scene, "-o", folder / "x.pfm", "--report", folder / "d/../scene.nff"});
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Catch::Contains("would overwrite the input SCENE"));
    CHECK(file_contents(scene) == file_contents(scene_file("planes")));
    CHECK(folder.entries() == 3);
}

TEST_CASE("render: replaces existing files", "[cli]") {
    const ScratchFolder folder;
    const std::string image = folder / "x.pfm";
    for (const std::string size : {"9x7", "4x3"}) {
        const RunOutcome run =
            run_raya({"render", scene_file("planes"), "-o", image, "--size", size, "--pes", "2", "--lanes", "4"});
        INFO(run.describe());
        REQUIRE(run.code == 0);
    }
    CHECK(file_contents(image).size() == std::string("PF\n4 3\n-1.0\n").size() + 4 * 3 * 3 * sizeof(float));
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
