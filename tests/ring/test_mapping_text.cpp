// Mappings as they are written: every form, its canonical text, and what is refused with which words.
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>

#include "host/error.hpp"
#include "host/ring/mapping.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;
using Catch::Contains;

namespace {

/// Image of 320 x 200 pixels, offset 16 and the cyclic fold unless the text says otherwise.
raya_mapping mapping_of(const std::string& text, std::uint32_t pes = 64) {
    return make_mapping(text, 320, 200, pes, 16, "cyclic");
}

bool same(const raya_mapping& a, const raya_mapping& b) {
    return a.width == b.width && a.height == b.height && a.pes == b.pes && a.parameter == b.parameter &&
           a.kind == b.kind;
}

}  // namespace

TEST_CASE("every form of a mapping is understood", "[mapping]") {
    CHECK(same(mapping_of("cyclic"), {320, 200, 64, 16, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping_of("cyclic:0"), {320, 200, 64, 0, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping_of("cyclic:319"), {320, 200, 64, 319, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping_of("column"), {320, 200, 64, 0, RAYA_FOLD_CYCLIC}));
    CHECK(same(make_mapping("cyclic", 320, 200, 64, 16, "block"), {320, 200, 64, 16, RAYA_FOLD_BLOCK}));
    CHECK(same(make_mapping("column", 320, 200, 64, 16, "block"), {320, 200, 64, 0, RAYA_FOLD_BLOCK}));
    CHECK(same(mapping_of("rows"), {320, 200, 64, 0, RAYA_ROWS}));
    CHECK(same(mapping_of("rows", 64'000), {320, 200, 64'000, 0, RAYA_ROWS}));
    CHECK(same(mapping_of("blocks"), {320, 200, 64, 0, RAYA_BLOCKS}));
    CHECK(same(mapping_of("grid:4x16"), {320, 200, 64, 4u << 16 | 16u, RAYA_GRID}));
    CHECK(same(mapping_of("tiles:16x8"), {320, 200, 64, 16u << 16 | 8u, RAYA_TILES}));
    CHECK(same(mapping_of("random"), {320, 200, 64, 1, RAYA_RANDOM}));
    CHECK(same(mapping_of("random:0"), {320, 200, 64, 0, RAYA_RANDOM}));
    CHECK(same(mapping_of("random:4294967295"), {320, 200, 64, 0xffffffffu, RAYA_RANDOM}));
    CHECK(make_mapping("cyclic", 16'384, 16'384, 268'435'456, 0, "cyclic").pes == 268'435'456);
    CHECK(make_mapping("grid:16384x16384", 16'384, 16'384, 268'435'456, 0, "cyclic").pes == 268'435'456);
}

TEST_CASE("a mapping's text names its PEs where it knows them", "[mapping]") {
    CHECK(parse_mapping("grid:3x50").pes() == 150u);
    CHECK(parse_mapping("grid:16384x16384").pes() == 268'435'456u);
    for (const char* text : {"cyclic", "cyclic:3", "column", "rows", "blocks", "tiles:3x50", "random"})
        CHECK_FALSE(parse_mapping(text).pes());
    CHECK(parse_mapping("cyclic:3").name == "cyclic");
    CHECK(parse_mapping("cyclic:3").has_slots());
    CHECK(parse_mapping("column").has_slots());
    CHECK_FALSE(parse_mapping("rows").has_slots());
    CHECK_FALSE(parse_mapping("random:3").has_slots());
}

TEST_CASE("the text of a mapping makes the same mapping again, and no two have the same", "[mapping]") {
    CHECK(mapping_text(mapping_of("cyclic")) == "cyclic:16");
    CHECK(mapping_text(mapping_of("column")) == "cyclic:0");
    CHECK(mapping_text(mapping_of("random")) == "random:1");
    for (const std::string text : {"cyclic:7", "rows", "blocks", "grid:8x8", "tiles:32x50", "random:99"})
        CHECK(mapping_text(mapping_of(text)) == text);
    constexpr std::uint64_t kSeed = 31;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        const raya_mapping m = any_mapping(random, 40);
        const std::string text = mapping_text(m);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, m.parameter, m.kind, text);
        CHECK(same(make_mapping(text, m.width, m.height, m.pes, 0, m.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic"), m));
    }
}

TEST_CASE("a mapping that cannot be is refused with what would be right", "[mapping]") {
    const auto refuses = [](const std::string& text, std::uint32_t width, std::uint32_t height, std::uint32_t pes,
                            std::uint32_t offset, const std::string& fold, const auto& message) {
        CHECK_THROWS_AS(make_mapping(text, width, height, pes, offset, fold), UserError);
        CHECK_THROWS_WITH(make_mapping(text, width, height, pes, offset, fold), message);
    };
    refuses("cyclic", 8, 8, 8, 0, "none", Contains("--fold none") && Contains("cyclic or block"));
    refuses("cyclic", 0, 8, 1, 0, "cyclic", Contains("--size 0x8") && Contains("1..16384"));
    refuses("cyclic", 8, 0, 1, 0, "cyclic", Contains("--size 8x0") && Contains("1..16384"));
    refuses("cyclic", 16'385, 8, 8, 0, "cyclic", Contains("--size 16385x8"));
    refuses("cyclic", 65'536, 65'536, 8, 0, "cyclic", Contains("--size 65536x65536"));  // W H overflows 32 bits
    refuses("cyclic", 8, 6, 0, 0, "cyclic", Contains("--pes 0") && Contains("1..48"));
    refuses("rows", 8, 6, 49, 0, "cyclic", Contains("--pes 49") && Contains("1..48"));
    refuses("cyclic", 8, 6, 8, 8, "cyclic", Contains("--offset 8") && Contains("0..7"));
    refuses("cyclic:8", 8, 6, 8, 0, "cyclic", Contains("--mapping cyclic:8") && Contains("0..7"));
    refuses("grid:3x4", 8, 6, 8, 0, "cyclic",
            Contains("--pes 8 with --mapping grid:3x4") && Contains("12 PEs") && Contains("or give 12"));
    refuses("grid:7x7", 8, 6, 49, 0, "cyclic", Contains("--mapping grid:7x7: 49 PEs") && Contains("1..48"));
    refuses("tiles:9x25", 320, 200, 8, 0, "cyclic",
            Contains("--mapping tiles:9x25") && Contains("320 x 200") && Contains("tiles:8x25"));
    refuses("tiles:320x99", 320, 200, 8, 0, "cyclic", Contains("tiles:320x100"));
    refuses("tiles:16384x3", 7, 200, 8, 0, "cyclic", Contains("tiles:7x2"));  // 2 and 4 are as near: the lesser
}

TEST_CASE("a mapping that is not written as it should is refused with the form", "[mapping]") {
    const auto refuses = [](const std::string& text, const std::string& form) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_mapping(text), UserError);
        CHECK_THROWS_WITH(parse_mapping(text), Contains("--mapping " + text + ":") && Contains(form));
    };
    for (const char* text : {"spiral", "", ":", "Cyclic", "cyclic ", "row", "spiral:3"})
        refuses(text, "there are cyclic, cyclic:p, column, rows, blocks, grid:AxB, tiles:WxH, random:seed");
    for (const char* text : {"cyclic:", "cyclic:x", "cyclic:-1", "cyclic:1.5", "cyclic: 1", "cyclic:16384",
                             "cyclic:4294967296", "cyclic:1:2"})
        refuses(text, "cyclic:p with an offset p 0..W-1");
    for (const char* text : {"column:", "column:0"}) refuses(text, "must be column alone");
    refuses("rows:3", "must be rows alone");
    refuses("blocks:3", "must be blocks alone");
    for (const std::string rest :
         {"", ":", ":4", ":4x", ":x4", ":0x4", ":4x0", ":4x4x4", ":16385x1", ":4X4", ":-4x4"}) {
        refuses("grid" + rest, "grid:AxB, A rows of B PEs, each 1..16384");
        refuses("tiles" + rest, "tiles:WxH, the sides of a tile in pixels, each 1..16384");
    }
    for (const char* text : {"random:", "random:x", "random:-1", "random:4294967296"})
        refuses(text, "random:seed with a seed 0..4294967295, or random");
}
