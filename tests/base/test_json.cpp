// raya's JSON documents compared with those of nlohmann/json, and the errors for invalid documents.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/base/scratch_folder.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

Json parsed(const std::string& text) { return Json::parse(text, {"x.json"}); }

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
    CHECK(Json("f\xfcr").dump() == "\"f\xef\xbf\xbdr\"");  // a byte that is not UTF-8 becomes U+FFFD
}

TEST_CASE("operator[] adds a member once, and a null becomes an object or an array on first use") {
    Json json;
    CHECK(json.is_null());
    json["a"] = 1;
    json["b"]["c"] = "x";
    json["a"] = 2;
    json["d"].push_back(3);
    json["d"].back() = 4;
    CHECK(json.dump() == R"({"a":2,"b":{"c":"x"},"d":[4]})");
    CHECK(json.find("e") == nullptr);
    CHECK(Json(5).find("e") == nullptr);
    CHECK(json.find("b")->at("c").text() == "x");
    CHECK_THROWS_WITH(json["a"]["b"], "2 is not a JSON object");
    CHECK_THROWS_AS(json.push_back(1), JsonError);
}

TEST_CASE("reading a value as another type is an error") {
    const Json json = parsed(R"({"n": 3, "x": 2.5, "m": -1, "t": "word", "l": ["a", "b"]})");
    CHECK(json.at("n").integer() == 3);
    CHECK(json.at("n").number() == 3.0);
    CHECK(json.at("m").number() == -1.0);
    CHECK(json.at("x").number() == 2.5);
    CHECK(json.at("l").strings() == std::vector<std::string>{"a", "b"});
    CHECK_THROWS_WITH(json.at("k"), "'k' is missing");
    CHECK_THROWS_WITH(json.at("t").number(), "\"word\" is not a number");
    CHECK_THROWS_WITH(json.at("l").number(), "an array is not a number");
    CHECK_THROWS_WITH(json.at("x").integer(), "2.5 is not a whole number");
    CHECK_THROWS_WITH(json.at("m").integer(), "-1 is negative");
    CHECK_THROWS_WITH(json.at("n").integer(2), "3 is more than 2");
    CHECK_THROWS_WITH(json.at("n").text(), "3 is not a string");
    CHECK_THROWS_WITH(json.at("n").elements(), "3 is not an array");
    const Json copy = json;
    CHECK(copy.dump() == json.dump());
}

TEST_CASE("a syntax error names file, line and member") {
    const auto parse_error_message = [](const std::string& text) -> std::string {
        try {
            parsed(text);
        } catch (const UserError& error) {
            return error.what();
        }
        return "accepted";
    };
    CHECK(parse_error_message("") == "x.json:1: not valid JSON (byte 1)");
    CHECK(parse_error_message("{\"a\":\n ?}") == "x.json:2: not valid JSON (byte 8)");
    CHECK(parse_error_message("[1, 2\n") == "x.json:2: not valid JSON (byte 7)");
    CHECK(parse_error_message("{}\n{}") == "x.json:2: not valid JSON (byte 4)");
    CHECK(parse_error_message(std::string("{}\n\0{}", 6)) == "x.json:2: not valid JSON (byte 4)");
    CHECK(parse_error_message("[\"\xff\"]") == "x.json:1: not valid JSON (byte 3)");
    CHECK(parse_error_message("1e400") == "x.json:1: 1e400 is outside the range of double precision");
    CHECK(parse_error_message("{\"a\": [1,\n{\"b\": -1e400}]}") ==
          "x.json:2: a[1].b: -1e400 is outside the range of double precision");
    CHECK(parse_error_message("[1" + std::string(1000, '0') + "]").size() < 120);
    CHECK(parse_error_message("{\"a\": {\"b\": 1, \"c\": 2,\n\"b\": 3}}") ==
          "x.json:2: a.b: member 'b' occurs twice in this JSON object");
    const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    CHECK(parsed(nested(100)).dump() == nested(100));
    CHECK(parse_error_message(nested(101)) == "x.json:1: nested more than 100 levels deep");
    CHECK(parse_error_message(nested(1'000'000)) == parse_error_message(nested(101)));
    CHECK(parsed("\xEF\xBB\xBF[1e-400]").elements()[0].number() == 0);
}

TEST_CASE("an error from the function that reads a document names file, line, member and remedy") {
    const auto parse_error_message = [](const std::string& text, const auto& read) -> std::string {
        try {
            read_json(text, {"x.json", "write it anew"}, read);
        } catch (const UserError& error) {
            return error.what();
        }
        return "accepted";
    };
    const std::string text =
        "{\"rows\": [\n{\"ms\": 1},\n{\"ms\": {\"best\":\n\"" + std::string(5'000'000, 'b') + "\"}}]}";
    const auto row = [](const Json& json) -> const Json& { return json.at("rows").elements()[1]; };
    CHECK(parse_error_message(text, [&](const Json& json) { return row(json).at("ms").at("best").number(); }) ==
          "x.json:4: rows[1].ms.best: \"" + std::string(39, 'b') + "... is not a number; remedy: write it anew");
    CHECK(parse_error_message(text, [&](const Json& json) { return row(json).at("hash").text(); }) ==
          "x.json:3: rows[1]: 'hash' is missing; remedy: write it anew");
    CHECK(parse_error_message(text, [](const Json& json) { return json.at("kind").text(); }) ==
          "x.json:1: 'kind' is missing; remedy: write it anew");
    CHECK(parse_error_message(text, [](const Json&) -> int { throw UserError("no such mapping"); }) ==
          "x.json: no such mapping; remedy: write it anew");
    CHECK(read_json("[3]", {"x.json"}, [](const Json& json) { return json.elements()[0].integer(); }) == 3);
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

TEST_CASE("a value of a document takes at most 24 bytes") { CHECK(sizeof(Json) <= 24); }

}  // namespace
}  // namespace raya
