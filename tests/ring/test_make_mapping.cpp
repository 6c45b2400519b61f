// Mappings of an image onto PEs: parameters and text of a mapping, and the error messages for invalid mappings.
#include <catch2/catch.hpp>
#include <cstdint>

#include "host/error.hpp"
#include "host/ring/mapping.hpp"

using namespace raya;
using Catch::Contains;

namespace {

bool same(const raya_mapping& a, const raya_mapping& b) {
    return a.width == b.width && a.height == b.height && a.pes == b.pes && a.parameter == b.parameter &&
           a.kind == b.kind;
}

}  // namespace

TEST_CASE("a mapping has the image's size, the number of PEs and the rule's parameter", "[mapping]") {
    const auto mapping = [](const MappingRule& rule, std::uint32_t pes = 64) {
        return make_mapping(rule, {320, 200}, pes);
    };
    CHECK(same(mapping(cyclic_mapping(16)), {320, 200, 64, 16, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping(cyclic_mapping(319)), {320, 200, 64, 319, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping(column_mapping()), {320, 200, 64, 0, RAYA_FOLD_CYCLIC}));
    CHECK(same(mapping(cyclic_mapping(16, Fold::kBlock)), {320, 200, 64, 16, RAYA_FOLD_BLOCK}));
    CHECK(same(mapping(column_mapping(Fold::kBlock)), {320, 200, 64, 0, RAYA_FOLD_BLOCK}));
    CHECK(same(mapping(rows_mapping(), 64'000), {320, 200, 64'000, 0, RAYA_ROWS}));
    CHECK(same(mapping(blocks_mapping()), {320, 200, 64, 0, RAYA_BLOCKS}));
    CHECK(same(mapping(grid_mapping(4, 16)), {320, 200, 64, raya_pair(4, 16), RAYA_GRID}));
    CHECK(same(mapping(tiles_mapping(16, 8)), {320, 200, 64, raya_pair(16, 8), RAYA_TILES}));
    CHECK(same(mapping(random_mapping(0xffffffffu)), {320, 200, 64, 0xffffffffu, RAYA_RANDOM}));
    CHECK(make_mapping(column_mapping(), {16'384, 16'384}, 268'435'456).pes == 268'435'456);
    CHECK(make_mapping(grid_mapping(16'384, 16'384), {16'384, 16'384}, 268'435'456).pes == 268'435'456);
}

TEST_CASE("the text of a mapping identifies it, except for the fold", "[mapping]") {
    CHECK(mapping_text(cyclic_mapping(16)) == "cyclic:16");
    CHECK(mapping_text(cyclic_mapping(16, Fold::kBlock)) == "cyclic:16");
    CHECK(mapping_text(column_mapping()) == "cyclic:0");
    CHECK(mapping_text(rows_mapping()) == "rows");
    CHECK(mapping_text(blocks_mapping()) == "blocks");
    CHECK(mapping_text(grid_mapping(8, 9)) == "grid:8x9");
    CHECK(mapping_text(tiles_mapping(32, 50)) == "tiles:32x50");
    CHECK(mapping_text(random_mapping(99)) == "random:99");
}

TEST_CASE("an invalid mapping is refused with the valid range or a valid value", "[mapping]") {
    const auto check_error = [](const MappingRule& rule, const ImageSize& image, std::uint32_t pes,
                                const auto& message) {
        CHECK_THROWS_AS(make_mapping(rule, image, pes), UserError);
        CHECK_THROWS_WITH(make_mapping(rule, image, pes), message);
    };
    check_error(column_mapping(), {0, 8}, 1, Contains("--size 0x8") && Contains("1..16384"));
    check_error(column_mapping(), {8, 0}, 1, Contains("--size 8x0") && Contains("1..16384"));
    check_error(column_mapping(), {16'385, 8}, 8, Contains("--size 16385x8"));
    check_error(column_mapping(), {65'536, 65'536}, 8, Contains("--size 65536x65536"));  // W H overflows 32 bits
    check_error(column_mapping(), {8, 6}, 0, Contains("--pes 0") && Contains("1..48"));
    check_error(rows_mapping(), {8, 6}, 49, Contains("--pes 49") && Contains("1..48"));
    check_error(cyclic_mapping(8), {8, 6}, 8, Contains("--mapping cyclic:8") && Contains("0..7"));
    check_error(grid_mapping(3, 4), {8, 6}, 8,
                Contains("--pes 8 with --mapping grid:3x4") && Contains("12 PEs") && Contains("or use 12"));
    check_error(grid_mapping(7, 7), {8, 6}, 49, Contains("--mapping grid:7x7: 49 PEs") && Contains("1..48"));
    check_error(tiles_mapping(9, 25), {320, 200}, 8,
                Contains("--mapping tiles:9x25") && Contains("320 x 200") && Contains("tiles:8x25"));
    check_error(tiles_mapping(320, 99), {320, 200}, 8, Contains("tiles:320x100"));
    // Of the divisors of 200, 2 and 4 are equally near to 3; the message suggests the smaller one.
    check_error(tiles_mapping(16'384, 3), {7, 200}, 8, Contains("tiles:7x2"));
}
