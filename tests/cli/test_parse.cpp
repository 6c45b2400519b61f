// Parsing of option values: keywords, and numbers of different types.
#include <catch2/catch.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"

using namespace raya;
using Catch::Contains;
using Catch::Equals;

namespace {

/// Parses "--it TEXT" for an option --it that sets `value`. Returns the parser's error message, "" if there is none.
template <class Value>
std::string refusal_of_value(Value& value, const std::string& text) {
    CLI::App app;
    add_value(app, "--it", value, "A value")->type_name("N");  // the placeholder must have no effect
    std::vector<std::string> arguments = {text, "--it"};       // CLI11 expects the arguments in reverse
    try {
        app.parse(arguments);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("parse_choice: accepts only the names of values", "[parse]") {
    const Choices<int> choices = {{"ring", 1}, {"bus", 2}, {"bus-broadcast", 3}};
    for (const auto& [name, value] : choices) CHECK(parse_choice("--x", name, choices) == value);
    for (const std::string text : {"bu", "Ring", "ring ", "bus-"})
        CHECK_THROWS_WITH(parse_choice("--x", text, choices), "--x " + text + ": must be ring, bus or bus-broadcast");
    CHECK_THROWS_WITH(parse_choice("--x", "", choices), "--x must not be empty: it must be ring, bus or bus-broadcast");
}

TEST_CASE("parse_image_size: reads N and WxH", "[parse]") {
    CHECK(parse_image_size("512") == ImageSize{512, 512});
    CHECK(parse_image_size("512x256") == ImageSize{512, 256});
    for (const std::string text : {"", "x", "0", "512x", "1x2x3", "-1", "12y"})
        CHECK_THROWS_WITH(parse_image_size(text), Contains("--size " + text + ":") && Contains("N or WxH"));
}

TEST_CASE("add_value: the type of the variable decides what a value may be, not the placeholder in help", "[parse]") {
    std::optional<std::uint32_t> optional_count;
    CHECK(refusal_of_value(optional_count, "7").empty());
    CHECK(optional_count == 7u);
    for (const std::string text : {"-1", "+1", "1.5", "x", "1 "})
        CHECK_THAT(
            refusal_of_value(optional_count, text),
            Equals("--it " + text + (text == "-1" ? ": out of range" : ": not a whole number") + "; --it: A value"));
    CHECK_THAT(refusal_of_value(optional_count, "4294967296"), Contains("--it 4294967296: out of range"));
    std::uint64_t large_count = 0;
    CHECK_THAT(refusal_of_value(large_count, "-1"), Contains("out of range"));
    CHECK_THAT(refusal_of_value(large_count, "18446744073709551616"), Contains("out of range"));
    CHECK(refusal_of_value(large_count, "18446744073709551615").empty());
    CHECK(large_count == UINT64_MAX);
    std::vector<std::uint32_t> counts;
    CHECK_THAT(refusal_of_value(counts, "x"), Contains("not a whole number"));
    int signed_number = 0;  // the command checks the range, not the parser
    CHECK(refusal_of_value(signed_number, "-1").empty());
    CHECK(signed_number == -1);
    std::optional<double> optional_real;
    CHECK(refusal_of_value(optional_real, "-1.5").empty());
    CHECK(optional_real == -1.5);
    CHECK_THAT(refusal_of_value(optional_real, "1.5x"), Contains("--it 1.5x: not a number"));
    CHECK_THAT(refusal_of_value(optional_real, "1e999"), Contains("--it 1e999: out of range"));
    std::string string;
    CHECK(refusal_of_value(string, "x").empty());
    CHECK(string == "x");
    CHECK_THAT(refusal_of_value(optional_count, ""), Contains("must not be empty"));
    CHECK_THAT(refusal_of_value(string, ""), Contains("must not be empty"));
    CHECK_THAT(refusal_of_value(optional_real, ""), Contains("must not be empty"));
}
