// Mappings of an image onto PEs: parameters and text of a mapping. Invalid mappings:
// tests/cli/transcripts/refusals.txt.
#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>

#include "host/ring/mapping.hpp"
#include "host/ring/ring_plan.hpp"

using namespace raya;

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

TEST_CASE("use_packets: only with a BVH, fp32, no schedule, and tiles that divide the image", "[ring][mapping]") {
    const auto chosen = [](std::uint32_t width, std::uint32_t height, const std::function<void(RingSettings&)>& change,
                           bool may_change_mapping = true) {
        RingSettings s;
        s.accel.kind = AccelKind::kBvh;
        s.mapping = make_mapping(cyclic_mapping(0), {width, height}, 4);
        change(s);
        use_packets(s, may_change_mapping);
        return s.packets ? mapping_text(s.mapping) : "none";
    };
    const auto nothing = [](RingSettings&) {};
    CHECK(chosen(12, 8, nothing) == "tiles:4x4");
    CHECK(chosen(8, 6, nothing) == "tiles:8x2");
    CHECK(chosen(6, 16, nothing) == "tiles:2x8");
    CHECK(chosen(16, 7, nothing) == "tiles:16x1");
    CHECK(chosen(15, 15, nothing) == "none");
    CHECK(chosen(12, 8, nothing, false) == "none");
    CHECK(chosen(12, 8, [](RingSettings& s) { s.accel.kind = AccelKind::kGrid; }) == "none");
    CHECK(chosen(12, 8, [](RingSettings& s) { s.format = parse_format("spa22"); }) == "none");
    CHECK(chosen(12, 8, [](RingSettings& s) { s.dynamic = DynamicPlan{}; }) == "none");
    CHECK(chosen(12, 8, [](RingSettings& s) { s.antialias.method = AntialiasMethod::kFilter; }) == "none");
    const auto tiles = [](RingSettings& s) { s.mapping = make_mapping(tiles_mapping(2, 3), {12, 9}, 4); };
    CHECK(chosen(12, 9, tiles, false) == "tiles:2x3");
    CHECK(chosen(12, 9, tiles) == "tiles:2x3");
}
