// Options as they are written: words, and values by the type that they fill.
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

/// The parser's complaint about `arguments` of a command with one option, --it, that fills `value`; "" where it fits.
template <class Value>
std::string complaint(Value& value, const std::string& text) {
    CLI::App app;
    add_value(app, "--it", value, "A value")->type_name("N");  // the placeholder of the help decides nothing
    std::vector<std::string> arguments = {text, "--it"};       // CLI11 takes them from the end
    try {
        app.parse(arguments);
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("links, methods, points and sampling are read, and other words refused", "[parse]") {
    for (const Links links : {Links::kTorus3d, Links::kTorus2d}) CHECK(parse_links(links_name(links)) == links);
    for (const AntialiasMethod method :
         {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample})
        CHECK(parse_antialias(antialias_name(method)) == method);
    CHECK(parse_points("axes") == RAYA_POINTS_AXES);
    CHECK(parse_points("diagonals") == RAYA_POINTS_DIAGONALS);
    CHECK(parse_exchange("ring") == ExchangeWay::kRing);
    CHECK(parse_exchange("bus") == ExchangeWay::kBus);
    CHECK(parse_exchange("bus-broadcast") == ExchangeWay::kBroadcast);
    CHECK(parse_sampling("centres") == Sampling::kCentres);
    CHECK(parse_sampling("corners") == Sampling::kCorners);
    for (const std::string text : {"", "torus", "torus4d", "Torus3d", "torus3d ", "none ", "axis", "centers"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_links(text), UserError);
        CHECK_THROWS_WITH(parse_links(text),
                          Contains("--links " + text + ":") && Contains("torus3d") && Contains("torus2d"));
        CHECK_THROWS_WITH(parse_antialias(text), Contains("--antialias " + text + ":") && Contains("supersample"));
        CHECK_THROWS_WITH(parse_exchange(text), Contains("--exchange " + text + ":") && Contains("bus-broadcast"));
        CHECK_THROWS_WITH(parse_points(text), Contains("--points " + text + ":") && Contains("axes or diagonals"));
        CHECK_THROWS_WITH(parse_sampling(text), Contains("--sampling " + text + ":") && Contains("centres or corners"));
    }
}

TEST_CASE("an image size is a side or two", "[parse]") {
    CHECK(parse_image_size("512") == ImageSize{512, 512});
    CHECK(parse_image_size("512x256") == ImageSize{512, 256});
    for (const std::string text : {"", "x", "0", "512x", "1x2x3", "-1", "12y"})
        CHECK_THROWS_WITH(parse_image_size(text), Contains("--size " + text + ":") && Contains("N or WxH"));
}

TEST_CASE("the type of an option's value decides what it takes, not what its help calls it", "[parse]") {
    std::optional<std::uint32_t> whole;
    CHECK(complaint(whole, "7").empty());
    CHECK(whole == 7u);
    for (const std::string text : {"-1", "+1", "1.5", "x", "1 "})
        CHECK_THAT(
            complaint(whole, text),
            Equals("--it " + text + (text == "-1" ? ": out of range" : ": not a whole number") + "; --it: A value"));
    CHECK_THAT(complaint(whole, "4294967296"), Contains("--it 4294967296: out of range"));
    std::uint64_t plain = 0;
    CHECK_THAT(complaint(plain, "-1"), Contains("out of range"));
    CHECK_THAT(complaint(plain, "18446744073709551616"), Contains("out of range"));
    CHECK(complaint(plain, "18446744073709551615").empty());
    CHECK(plain == UINT64_MAX);
    std::vector<std::uint32_t> several;
    CHECK_THAT(complaint(several, "x"), Contains("not a whole number"));
    int number = 0;  // a range of its own is for its command to check
    CHECK(complaint(number, "-1").empty());
    CHECK(number == -1);
    std::optional<double> real;
    CHECK(complaint(real, "-1.5").empty());
    CHECK(real == -1.5);
    CHECK_THAT(complaint(real, "1.5x"), Contains("--it 1.5x: not a number"));
    CHECK_THAT(complaint(real, "1e999"), Contains("--it 1e999: out of range"));
    std::string word;
    CHECK(complaint(word, "x").empty());
    CHECK(word == "x");
    CHECK_THAT(complaint(whole, ""), Contains("must not be empty"));
    CHECK_THAT(complaint(word, ""), Contains("must not be empty"));
    CHECK_THAT(complaint(real, ""), Contains("must not be empty"));
}
