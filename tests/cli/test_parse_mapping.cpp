// Parsing of --mapping and --fold: every form, its canonical text, and refused texts.
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>

#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/ring/mapping.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;
using Catch::Contains;

TEST_CASE("parse_mapping: reads every form", "[parse]") {
    const auto rule = [](const std::string& text) { return parse_mapping(text).rule; };
    CHECK(rule("cyclic:0") == cyclic_mapping(0));
    CHECK(rule("cyclic:319") == cyclic_mapping(319));
    CHECK(rule("column") == column_mapping());
    CHECK(rule("rows") == rows_mapping());
    CHECK(rule("blocks") == blocks_mapping());
    CHECK(rule("grid:4x16") == grid_mapping(4, 16));
    CHECK(rule("grid:16384x16384") == grid_mapping(16'384, 16'384));
    CHECK(rule("tiles:16x8") == tiles_mapping(16, 8));
    CHECK(rule("random") == random_mapping(1));
    CHECK(rule("random:0") == random_mapping(0));
    CHECK(rule("random:4294967295") == random_mapping(0xffffffffu));
    CHECK(parse_mapping("cyclic").rule.has_slots());
    CHECK(parse_mapping("cyclic").takes_offset_option);
    for (const char* text : {"cyclic:0", "cyclic:3", "column", "rows", "blocks", "grid:3x50", "tiles:3x50", "random"})
        CHECK_FALSE(parse_mapping(text).takes_offset_option);
    CHECK(parse_mapping("cyclic:3").name() == "cyclic");
    CHECK(parse_mapping("rows").name() == "rows");
}

TEST_CASE("parse_mapping: inverts mapping_text", "[parse]") {
    constexpr std::uint64_t kSeed = 31;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        const raya_mapping m = any_mapping(random, 40);
        const std::string text = mapping_text(m);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, m.parameter, m.kind, text);
        MappingRule rule = parse_mapping(text).rule;
        if (m.kind == RAYA_FOLD_BLOCK) rule = cyclic_mapping(rule.parameter, Fold::kBlock);
        CHECK(rule == MappingRule{m.kind, m.parameter});
    }
}

TEST_CASE("parse_mapping, parse_dynamic: refuse other texts and name the valid form", "[parse]") {
    const auto refuses = [](const auto& parse, const std::string& text, const std::string& form) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse(text), UserError);
        CHECK_THROWS_WITH(parse(text), Contains("--mapping " + text + ":") && Contains(form));
    };
    const auto mapping = [](const std::string& text) { return parse_mapping(text); };
    const auto dynamic = [](const std::string& text) { return parse_dynamic(text); };
    for (const char* text : {"spiral", "", ":", "Cyclic", "cyclic ", "row"})
        refuses(mapping, text, "mappings: cyclic, cyclic:p, column, rows, blocks, grid:AxB, tiles:WxH, random:seed");
    for (const char* text : {"cyclic:", "cyclic:-1", "cyclic:1.5", "cyclic: 1", "cyclic:16384", "cyclic:4294967296"})
        refuses(mapping, text, "cyclic:p with an offset p 0..W-1");
    for (const std::string rest : {"", ":", ":4x", ":x4", ":4x0", ":4x4x4", ":16385x1", ":4X4", ":-4x4"}) {
        refuses(mapping, "grid" + rest, "grid:AxB with A rows of B PEs, A and B 1..16384");
        refuses(mapping, "tiles" + rest, "tiles:WxH with the sides of a tile in pixels, each 1..16384");
    }
    for (const char* text : {"random:", "random:-1", "random:4294967296"}) refuses(mapping, text, "seed 0..4294967295");
    for (const char* text :
         {"dynamic", "dynamic:0", "dynamic:+1", "dynamic:1 ", "dynamic:268435457", "dynamic:4294967297", "dynamic:1,",
          "dynamic:1,1000000001", "dynamic:1,2,0.5", "dynamic:1,2,3,4", "dynamic:,1", "hybrid", "hybrid:1,0,1.01",
          "hybrid:1,0,-0", "hybrid:1,0,nan", "hybrid:1,0,0.5x", "hybrid:1,0,0.5,1,2", "cyclic:16", ""})
        refuses(dynamic, text, "dynamic:CHUNK");
}

TEST_CASE("parse_dynamic: reads dynamic and hybrid", "[parse]") {
    CHECK(parse_dynamic("dynamic:4") == DynamicPlan{4, 0, 0});
    CHECK(parse_dynamic("dynamic:1,2000") == DynamicPlan{1, 2'000, 0});
    CHECK(parse_dynamic("dynamic:268435456,1000000000") == DynamicPlan{268'435'456, 1'000'000'000, 0});
    CHECK(parse_dynamic("hybrid:8") == DynamicPlan{8, 0, 0.5});
    CHECK(parse_dynamic("hybrid:8,50") == DynamicPlan{8, 50, 0.5});
    CHECK(parse_dynamic("hybrid:8,50,0.75") == DynamicPlan{8, 50, 0.75});
    CHECK(parse_dynamic("hybrid:8,50,0") == DynamicPlan{8, 50, 0});
    CHECK(parse_dynamic("dynamic:8,50,7") == DynamicPlan{8, 50, 0, 7});
    CHECK(parse_dynamic("hybrid:8,50,0.25,7") == DynamicPlan{8, 50, 0.25, 7});
    CHECK(parse_dynamic("dynamic:8", {1, 2, 0, 3}) == DynamicPlan{8, 2, 0, 3});  // missing numbers: from the argument
    CHECK(parse_dynamic("hybrid:8,0", {1, 2, 0, 3}) == DynamicPlan{8, 0, 0.5, 3});
    constexpr std::uint64_t kSeed = 7;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        const double static_fractions[] = {0, 0.5, 1, random.uniform(0, 1)};
        const DynamicPlan plan{1 + random_below(random, kMaxChunk >> random.next() % 28),
                               random.next() % 2 * random_below(random, kMaxOverhead + 1), static_fractions[i % 4],
                               random.next() % 2 * random_below(random, kMaxOverhead + 1)};
        CAPTURE(kSeed, i, plan.chunk, plan.overhead, plan.static_fraction, plan.root_cycles, dynamic_text(plan));
        CHECK(parse_dynamic(dynamic_text(plan)) == plan);
    }
}
