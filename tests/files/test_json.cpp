// Our JSON documents beside the library's own.
#include <catch2/catch.hpp>
#include <limits>

#include "tests/document.hpp"

namespace raya {

TEST_CASE("a document says what was put into it, in that order") {
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
                       {"empty", Json::list()},
                       {"object", {{"a", 1}, {"b", Json::object()}}}};
    CHECK(json.dump() == R"({"z":null,"truth":true,"small":-3,"large":18446744073709551615,"third":0.3333333333333333,)"
                         R"("text":"a \"b\"\n","list":[1.5,2.0],"array":[1,2],"none":null,"one":1,"empty":[],)"
                         R"("object":{"a":1,"b":{}}})");
    CHECK(Json::parse(json.dump()).dump(2) == read_back(json).dump(2));
    CHECK(Json("f\xfcr").dump() == "\"f\xef\xbf\xbdr\"");  // Latin-1
}

TEST_CASE("members are added once, lists grow from nothing") {
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
    CHECK_THROWS_AS(json["a"]["b"], JsonError);
    CHECK_THROWS_AS(json.push_back(1), JsonError);
}

TEST_CASE("what is read is of the kind that is asked for") {
    const Json json = Json::parse(R"({"n": 3, "x": 2.5, "m": -1, "t": "word", "l": ["a", "b"]})");
    CHECK(json.at("n").whole() == 3);
    CHECK(json.at("n").number() == 3.0);
    CHECK(json.at("m").number() == -1.0);
    CHECK(json.at("x").number() == 2.5);
    CHECK(json.at("l").texts() == std::vector<std::string>{"a", "b"});
    CHECK_THROWS_WITH(json.at("k"), "'k' is missing");
    CHECK_THROWS_WITH(json.at("t").number(), "\"word\" is no number");
    CHECK_THROWS_WITH(json.at("x").whole(), "2.5 is no whole number");
    CHECK_THROWS_WITH(json.at("m").whole(), "-1 is no number from 0 on");
    CHECK_THROWS_WITH(json.at("n").whole(2), "3 is more than 2");
    CHECK_THROWS_WITH(json.at("n").text(), "3 is no text");
    CHECK_THROWS_WITH(json.at("n").elements(), "3 is no list");
}

TEST_CASE("text that is no JSON names the byte, and what nests too deeply is refused") {
    try {
        Json::parse("{\"a\": ?}");
        FAIL();
    } catch (const JsonSyntaxError& error) {
        CHECK(error.byte == 7);
    }
    const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    CHECK(Json::parse(nested(100)).dump() == nested(100));
    CHECK_THROWS_AS(Json::parse(nested(101)), JsonError);
    CHECK_THROWS_AS(Json::parse(nested(1'000'000)), JsonError);
}

}  // namespace raya
