// Damaged JSON files: every reader refuses them or prints a warning, in one line with file name and line number. No
// reader ends with an internal error.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "host/report/bench_report.hpp"
#include "host/tune/store.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;

struct Damage {
    std::string text, reason;  // reason: expected part of the message
};

// Returns texts that the JSON parser, and therefore every reader, refuses.
std::vector<Damage> malformed_texts() {
    const auto nested_lists = [](std::size_t levels) { return std::string(levels, '['); };
    return {{"", "x.json: not valid JSON: parse error at line 1"},
            {"\n \n", "x.json: not valid JSON: parse error at line 3"},
            {"{\"kind\":\n1e400}", "x.json: outside the range of double precision: number overflow parsing '1e400'"},
            {"{\"kind\":\n-1e400}", "x.json: outside the range of double precision: number overflow parsing '-1e400'"},
            {"{\"kind\": [1" + std::string(400, '0') + "]}",
             "x.json: outside the range of double precision: number overflow parsing '1000"},
            {"{\"kind\": \"raya bench\",\n", "x.json: not valid JSON: parse error at line 2"},
            {"{\"kind\": \"raya bench\"}\n}", "x.json: not valid JSON: parse error at line 2"},
            {std::string("{\"kind\": \"raya bench\"}\n\0", 24), "x.json: not valid JSON: it contains a zero byte"},
            {std::string("{\"kind\": \"raya\0bench\"}", 23), "x.json: not valid JSON: it contains a zero byte"},
            {"{\"kind\": \"\xff\xfe\"}", "x.json: not valid JSON: parse error at line 1"},
            {"{\"kind\": \"\\ud800\"}", "x.json: not valid JSON: parse error at line 1"},
            {"{\"kind\": \"a\nb\"}", "x.json: not valid JSON: parse error at line 2"},
            {"{\"kind\": \"raya bench\",\n\"kind\": 1}", "x.json: member 'kind' occurs twice in a JSON object"},
            {nested_lists(101), "x.json: nested more than 100 levels deep"},
            {nested_lists(1'000'000), "x.json: nested more than 100 levels deep"},
            {"NaN", "x.json: not valid JSON: parse error at line 1"},
            {"{'kind': 1}", "x.json: not valid JSON: parse error at line 1"}};
}

// Returns valid JSON texts that are not reports.
std::vector<std::string> other_json_texts() {
    return {"null",
            "3",
            "[]",
            "\"raya bench\"",
            "{}",
            "{\"kind\": 3}",
            "{\"kind\": []}",
            "{\"kind\": \"" + std::string(1'000'000, 'k') + "\"}"};
}

std::string refusal(const auto& read) {
    try {
        read();
    } catch (const UserError& error) {
        return error.what();
    }
    return "accepted";
}

TEST_CASE("readers of JSON: the messages about damaged files name file and line", "[cli][json]") {
    const ScratchFolder folder;
    const std::string file = folder / "x.json";
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    unsetenv("RAYA_TUNED");
    const DeviceInfo device;
    const std::filesystem::path tuned_file = tuned_path(device);
    const auto check = [&](const Damage& damage) {
        CAPTURE(damage.text.substr(0, 60), damage.reason);
        std::ofstream(file, std::ios::binary) << damage.text;
        std::ofstream(tuned_file, std::ios::binary) << damage.text;
        std::string warning;
        CHECK_FALSE(stored_choices([&](const std::string& text) { warning = text; })(device, {}));
        const std::string reason_in_cache = tuned_file.string() + damage.reason.substr(std::string("x.json").size());
        CHECK_THAT(warning, Contains("ignored"));
        const std::vector<std::string> messages = {refusal([&] { page_of_report(damage.text, "x.json"); }),
                                                   refusal([&] { read_bench_report(file); }), warning};
        for (const std::string& message : messages) {
            CAPTURE(message);
            CHECK_THAT(message, Contains(&message == &messages.back() ? reason_in_cache : damage.reason));
            CHECK(message.find('\n') == std::string::npos);
            CHECK(message.size() < 600);
        }
    };
    for (const Damage& damage : malformed_texts()) check(damage);
    for (const std::string& text : other_json_texts()) check({text, "x.json"});
    unsetenv("XDG_CACHE_HOME");
    setenv("RAYA_TUNED", "off", 1);
}

TEST_CASE("page, bench: exit with 2 for a JSON number outside the range of a double", "[cli][json]") {
    const ScratchFolder folder;
    const std::string file = folder / "x.json";
    std::ofstream(file) << "{\"kind\": \"raya bench\",\n\"rows\": [1e400]}";
    const std::string reason =
        "x.json: outside the range of double precision: number overflow parsing '1e400'; remedy: ";
    const RunOptions no_device = {.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}};
    const std::vector<std::vector<std::string>> commands = {{"page", file, "-o", folder / "x.html"},
                                                            {"bench", scene_file("planes"), "--compare", file}};
    for (const std::vector<std::string>& command : commands) {
        const RunOutcome run = run_raya(command, command[0] == "page" ? no_device : RunOptions{});
        INFO(run.describe());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Contains(reason));
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
        CHECK(folder.entries() == 1);
    }
}

TEST_CASE("page: refuses a report of more than 64 MB", "[cli][json]") {
    const ScratchFolder folder;
    const std::string file = folder / "x.json";
    std::ofstream(file) << "[1]";
    std::filesystem::resize_file(file, 65'000'000);
    const RunOutcome run = run_raya({"page", file, "-o", folder / "x.html"});
    INFO(run.describe());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Contains(file + ": cannot be read: larger than 64000000 bytes"));
}

}  // namespace
}  // namespace raya
