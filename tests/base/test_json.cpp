// JSON documents: what is written, and the errors for invalid documents.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/base/scratch_folder.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

Json parsed(const std::string& text) { return parse_json(text, {"x.json"}); }

TEST_CASE("a document contains the given members in the given order") {
    const Json json = {{"z", nullptr},
                       {"truth", true},
                       {"small", -3},
                       {"large", std::numeric_limits<std::uint64_t>::max()},
                       {"third", 1.0 / 3},
                       {"text", "a \"b\"\n"},
                       {"list", std::vector{1.5, 2.0}},
                       {"array", std::array{1u, 2u}},
                       {"none", std::optional<int>()},
                       {"one", std::optional<int>(1)},
                       {"empty", Json::array()},
                       {"object", {{"a", 1}, {"b", Json::object()}}}};
    CHECK(json.dump() == R"({"z":null,"truth":true,"small":-3,"large":18446744073709551615,"third":0.3333333333333333,)"
                         R"("text":"a \"b\"\n","list":[1.5,2.0],"array":[1,2],"none":null,"one":1,"empty":[],)"
                         R"("object":{"a":1,"b":{}}})");
    CHECK(parsed(json.dump()).dump(2) == read_back(json).dump(2));
    CHECK(json_dump("f\xfcr") == "\"f\xef\xbf\xbdr\"");  // a byte that is not UTF-8 becomes U+FFFD
}

TEST_CASE("reading a value as another type is an error") {
    const Json json = parsed(R"({"n": 3, "x": 2.5, "m": -1, "t": "word", "l": ["a", "b"]})");
    CHECK(json_integer(json.at("n")) == 3);
    CHECK(json_number(json.at("n")) == 3.0);
    CHECK(json_number(json.at("m")) == -1.0);
    CHECK(json_number(json.at("x")) == 2.5);
    CHECK(json_strings(json.at("l")) == std::vector<std::string>{"a", "b"});
    CHECK(find_member(json, "k") == nullptr);
    CHECK(find_member(Json(5), "k") == nullptr);
    const auto reason = [&](const auto& read) -> std::string {
        try {
            read();
        } catch (const Json::exception& error) {
            return json_reason(error);
        }
        return "accepted";
    };
    CHECK(reason([&] { json.at("k"); }) == "key 'k' not found");
    CHECK(reason([&] { json_number(json.at("t")); }) == "(/t) \"word\" is not a number");
    CHECK(reason([&] { json_number(json.at("l")); }) == "(/l) an array is not a number");
    CHECK(reason([&] { json_integer(json.at("x")); }) == "(/x) 2.5 is not a whole number");
    CHECK(reason([&] { json_integer(json.at("m")); }) == "(/m) -1 is negative");
    CHECK(reason([&] { json_integer(json.at("n"), 2); }) == "(/n) 3 is more than 2");
    CHECK(reason([&] { json_text(json.at("n")); }) == "(/n) 3 is not a string");
    CHECK(reason([&] { json_array(json.at("n")); }) == "(/n) 3 is not an array");
}

TEST_CASE("a document that cannot be parsed is refused with file and line") {
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            parsed(text);
        } catch (const UserError& error) {
            return error.what();
        }
        return "accepted";
    };
    for (const char* text : {"", "{\"a\":\n ?}", "[1, 2\n", "{}\n{}", "[\"\xff\"]"})
        CHECK_THAT(refusal(text), Catch::StartsWith("x.json: not valid JSON: parse error at line "));
    CHECK_THAT(refusal("{\"a\":\n ?}"), Catch::Contains("at line 2, column 2"));
    CHECK(refusal(std::string("{}\n\0{}", 6)) == "x.json: not valid JSON: it contains a zero byte");
    CHECK_THAT(refusal("{\"a\": [1,\n{\"b\": -1e400}]}"), Catch::Contains("number overflow parsing '-1e400'"));
    CHECK(refusal("[1" + std::string(1000, '0') + "]").size() < 420);
    CHECK(refusal("{\"a\": {\"b\": 1, \"c\": 2,\n\"b\": 3}}") == "x.json: member 'b' occurs twice in a JSON object");
    CHECK(refusal("[{\"b\": 1}, {\"b\": 1}, {\"c\": {\"b\": 1}, \"b\": 2}]") == "accepted");
    const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    CHECK(parsed(nested(100)).dump() == nested(100));
    CHECK(refusal(nested(101)) == "x.json: nested more than 100 levels deep");
    CHECK(refusal(nested(1'000'000)) == refusal(nested(101)));
    CHECK(json_number(parsed("\xEF\xBB\xBF[1e-400]")[0]) == 0);
}

TEST_CASE("an error from the function that reads a document names file, member and remedy") {
    const auto refusal = [](const std::string& text, const auto& read) -> std::string {
        try {
            read_json(text, {"x.json", "write it anew"}, read);
        } catch (const UserError& error) {
            return error.what();
        }
        return "accepted";
    };
    const std::string text = "{\"rows\": [{\"ms\": 1}, {\"ms\": {\"best\": \"" + std::string(5'000'000, 'b') + "\"}}]}";
    CHECK(refusal(text, [](const Json& json) { return json_number(json.at("rows")[1].at("ms").at("best")); }) ==
          "x.json: (/rows/1/ms/best) \"" + std::string(39, 'b') + "... is not a number; remedy: write it anew");
    CHECK(refusal(text, [](const Json& json) { return json_text(json.at("rows")[1].at("hash")); }) ==
          "x.json: (/rows/1) key 'hash' not found; remedy: write it anew");
    CHECK(refusal(text, [](const Json&) -> int { throw UserError("no such mapping"); }) ==
          "x.json: no such mapping; remedy: write it anew");
    CHECK(read_json("[3]", {"x.json"}, [](const Json& json) { return json_integer(json[0]); }) == 3);
}

TEST_CASE("a file of more than 64 MB is refused before it is parsed") {
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
