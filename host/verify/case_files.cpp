#include "host/verify/case_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <vector>

#include "host/base/json.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/cl/spirv.hpp"
#include "host/embedded.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

// Moves options "-DNAME=VALUE" from `options` to the returned lines "#define NAME VALUE".
std::string take_definitions(std::string& options) {
    std::string lines, others;
    std::istringstream in(options);
    for (std::string option; in >> option;) {
        const std::size_t equals = option.find('=');
        if (!option.starts_with("-D")) {
            others += (others.empty() ? "" : " ") + option;
        } else if (equals == std::string::npos) {
            lines += fmt::format("#define {} 1\n", option.substr(2));
        } else {
            lines += fmt::format("#define {} {}\n", option.substr(2, equals - 2), option.substr(equals + 1));
        }
    }
    options = others;
    return lines;
}

std::string case_header(const Json& launch, const std::string& options, const std::string& device) {
    const bool is_build = launch.find("kernel") == nullptr;
    std::string rows;
    if (!is_build)
        for (const Json& a : launch.at("arguments").elements())
            rows += fmt::format("    {{\"{}\", '{}', {}}},\n", a.at("name").text(), a.at("kind").text()[0],
                                a.at("bytes").integer());
    if (rows.empty()) rows = "    {\"\", 'l', 1},\n";
    return fmt::format(
        "#define KERNEL \"{}\"\n#define OPTIONS \"{}\"\n#define DEFAULT_DEVICE {}\n#define BUILD_FAILS {}\n"
        "#define GROUPS {}\n#define GROUP_SIZE {}\n\n"
        "/* The kernel's arguments. kind: 'b' buffer, 'v' value, 'l' local memory */\n"
        "static const struct argument {{\n    const char* name;\n    char kind;\n    size_t bytes;\n}} arguments[] = "
        "{{\n{}}};\n",
        is_build ? "" : launch.at("kernel").text(), options, Json(device).dump(), is_build ? 1 : 0,
        is_build ? 1 : launch.at("groups").integer(), is_build ? 1 : launch.at("group_size").integer(), rows);
}

std::vector<std::uint32_t> words_of(const fs::path& file) {
    const std::string bytes = read_file(file);
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), 4 * words.size());
    return words;
}

// Returns the first words of NAME.out that differ from NAME.expected, one line for each, at most `kShown`.
std::string differing_words(const fs::path& folder, const std::string& name) {
    constexpr std::size_t kShown = 10;
    const auto file = [&](const char* extension) { return folder / (name + extension); };
    const std::vector<std::uint32_t> got = words_of(file(".out")), expected = words_of(file(".expected"));
    const std::vector<std::uint32_t> mask =
        fs::exists(file(".mask")) ? words_of(file(".mask")) : std::vector<std::uint32_t>(expected.size(), 1);
    std::string lines;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
        if (mask[i] != 0 && got[i] != expected[i] && !(mask[i] == 2 && std::isnan(std::bit_cast<float>(got[i]))) &&
            wrong++ < kShown)
            lines += fmt::format("    {}:{} is 0x{:08x}, expected 0x{:08x}\n", name, i, got[i], expected[i]);
    return lines + fmt::format("    {}: {} of {} words wrong\n", name, wrong, expected.size());
}

constexpr const char* kReadme = R"(# {check}: a case for a bug report

{what}

| | |
|---|---|
| device | {device} ({platform}) |
| version, driver | {version}, {driver} |
| step of the check | {step} |
| build options | `{options}` |
| source of the expected words | {reference} |
| made by | {program} |

{words}
    make && ./repro          exit code 0: right; 1: wrong; 125: cannot tell (no such device, the build fails, ...)
    git bisect run sh -c 'BUILD-THE-DRIVER && CASE/repro'       finds the commit of a driver that broke it
    make reduce              reduced.cl: a smaller kernel that still fails; needs cvise and oclgrind

kernel.cl: the kernel with its included files. NAME.in: inputs; NAME.expected: correct outputs, compared
where NAME.mask, if there is one, is not 0 (2: every NaN is correct); NAME.out: outputs of the failing device. NAME is argN_BUFFER for argument N. case.h: work-groups and sizes.{right}
)";

}  // namespace

void write_case(const fs::path& folder, const DeviceChecks& device, const Check& check, const std::string& step,
                const std::string& reference, const fs::path& kernels) {
    const Json launch = Json::parse(read_file(folder / "launch.json"), {"launch.json"});
    std::string options = launch.at("options").text();
    remove_il_option(options);  // the case builds the source
    const std::string definitions = take_definitions(options), program = launch.at("program").text();
    if (!kernels.empty() && embedded_files().contains("kernels/" + program))
        write_whole_file(folder / "right.cl", kernel_source(program));
    for (const char* const name : {"kernel.cl", "right.cl"})
        if (fs::exists(folder / name)) write_whole_file(folder / name, definitions + read_file(folder / name));
    write_whole_file(folder / "case.h", case_header(launch, options, device.platform + ": " + device.name));
    for (const char* const name : {"repro.c", "Makefile", "reduce.sh"})
        write_whole_file(folder / name, embedded_files().at(std::string("host/verify/case/") + name));
    std::string words;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".expected") words += differing_words(folder, entry.path().stem().string());
    const std::string right = fs::exists(folder / "right.cl")
                                  ? " right.cl: raya's own kernel; `./repro right.cl` ends with exit code 0."
                                  : "";
    write_whole_file(folder / "README.md",
                     fmt::format(fmt::runtime(kReadme), fmt::arg("check", check.layer + " " + check.name),
                                 fmt::arg("what", check.verdict.result), fmt::arg("device", device.name),
                                 fmt::arg("platform", device.platform), fmt::arg("version", device.version),
                                 fmt::arg("driver", device.driver), fmt::arg("step", step),
                                 fmt::arg("options", launch.at("options").text()), fmt::arg("reference", reference),
                                 fmt::arg("program", name_and_version()), fmt::arg("words", words.empty() ? "" : words),
                                 fmt::arg("right", right)));
    fs::remove(folder / "launch.json");
}

}  // namespace raya
