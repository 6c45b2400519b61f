// Errors for JSON documents that are invalid or have other members than expected.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/base/scratch_folder.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

const JsonSource kSource{"x.json", "write it anew"};

std::string refusal(const auto& read) {
    try {
        read();
    } catch (const UserError& error) {
        return error.what();
    }
    return "accepted";
}

TEST_CASE("a document that cannot be parsed is refused with file, line and remedy", "[json]") {
    const auto refused = [](const std::string& text) { return refusal([&] { parse_json(text, kSource); }); };
    for (const char* text : {"", "{\"a\":\n ?}", "[1, 2\n", "{}\n{}", "[\"\xff\"]"})
        CHECK_THAT(refused(text), Catch::StartsWith("x.json: not valid JSON: parse error at line ") &&
                                      Catch::EndsWith("; remedy: write it anew"));
    CHECK_THAT(refused("{\"a\":\n ?}"), Catch::Contains("at line 2, column 2"));
    CHECK_THAT(refused(std::string("{}\n\0{}", 6)), Catch::Contains("it contains a zero byte"));
    CHECK_THAT(refused("{\"a\": [1,\n{\"b\": -1e400}]}"), Catch::Contains("number overflow parsing '-1e400'"));
    CHECK(refused("[1" + std::string(1000, '0') + "]").size() < 450);
    CHECK_THAT(refused("{\"a\": {\"b\": 1, \"c\": 2,\n\"b\": 3}}"), Catch::Contains("member 'b' occurs twice"));
    CHECK(refused("[{\"b\": 1}, {\"b\": 1}, {\"c\": {\"b\": 1}, \"b\": 2}]") == "accepted");
    const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    CHECK(parse_json(nested(100), kSource).dump() == nested(100));
    CHECK_THAT(refused(nested(101)), Catch::Contains("nested more than 100 levels deep"));
    CHECK(refused(nested(1'000'000)) == refused(nested(101)));
    CHECK(parse_json("\xEF\xBB\xBF[1e-400]", kSource)[0] == 0);
}

TEST_CASE("an error from the function that reads a document names file, member and remedy", "[json]") {
    const auto refused = [](const auto& read) {
        const std::string text = R"({"rows": [{"ms": 1}, {"ms": {"best": "b"}}]})";
        return refusal([&] { read_json(text, kSource, read); });
    };
    CHECK(refused([](const Json& json) { return json.at("rows")[1].at("ms").at("best").get<double>(); }) ==
          "x.json: (/rows/1/ms/best) type must be number, but is string; remedy: write it anew");
    CHECK(refused([](const Json& json) { return json.at("rows")[1].at("hash").get<std::string>(); }) ==
          "x.json: (/rows/1) key 'hash' not found; remedy: write it anew");
    CHECK(refused([](const Json& json) { return json_integer(json.at("rows")[0].at("ms"), 0); }) ==
          "x.json: (/rows/0/ms) must be a whole number from 0 to 0; remedy: write it anew");
    CHECK_THAT(refused([](const Json& json) { return json_array(json.at("rows")[0].at("ms")).size(); }),
               Catch::Contains("(/rows/0/ms)"));
    CHECK(refused([](const Json&) -> int { throw UserError("no such mapping"); }) ==
          "x.json: no such mapping; remedy: write it anew");
    CHECK(read_json("[3]", kSource, [](const Json& json) { return json[0].get<int>(); }) == 3);
    CHECK(json_dump("f\xfcr") == "\"f\xef\xbf\xbdr\"");  // a byte that is not UTF-8 becomes U+FFFD
}

TEST_CASE("a file of more than 64 MB is refused before it is parsed", "[json]") {
    const ScratchFolder folder;
    const std::string file = folder / "x.json";
    std::ofstream(file) << "{}";
    CHECK(json_file_text(file, {file}) == "{}");
    std::filesystem::resize_file(file, kMaxJsonBytes + 1);
    CHECK_THROWS_WITH(json_file_text(file, {file}), file + ": cannot be read: larger than 64000000 bytes");
    CHECK_THROWS_WITH(json_file_text("/dev/zero", {"z"}), "z: cannot be read: not a regular file");
}

}  // namespace
}  // namespace raya
