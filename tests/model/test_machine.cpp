// Descriptions of the machines.
#include <catch2/catch.hpp>
#include <cstdint>
#include <set>
#include <string>

#include "host/error.hpp"
#include "host/model/machine.hpp"

using namespace raya;
using Catch::Contains;

TEST_CASE("the SPA is the paper's machine, and first in the list", "[machine]") {
    const Machine& spa = machine_named("spa");  // Kohata & Ito 1993
    CHECK(machines().front().name == "spa");
    CHECK(spa.pes == 256u);
    CHECK(spa.mapping == cyclic_mapping(16));
    CHECK(spa.pe_memory_bytes == 32u * 1024);
    CHECK(spa.bounces == 8);
    CHECK(spa.topology == "ring+bus");
}

TEST_CASE("the SPA's clock has the rates of the paper's tables, and so have spa1 and grande", "[machine]") {
    const MachineClock& spa = machine_named("spa").clock;
    CHECK(spa.cycle_ns == 100);
    CHECK(spa.cycle_factor == Approx(7 / 1.0752).epsilon(1e-12));
    CHECK(spa.link_words_per_s == 6e6);
    CHECK(spa.rotation_sync_ms == 0.1845);  // 10 ms / 32 - 768 / 6e6 s
    CHECK(spa.setup_ms == 1.375);           // 2 ms - 2 x 10 ms / 32
    CHECK(spa.gather_words_per_s == Approx(196'608 / 0.138625).epsilon(1e-12));
    CHECK(spa.broadcast_words_per_s == spa.gather_words_per_s);
    for (const char* name : {"spa1", "grande"}) {
        CAPTURE(name);
        CHECK(machine_named(name).clock == spa);
        CHECK(machine_named(name).mapping.has_slots());
    }
    CHECK(machine_named("spa1").pes == 1u);
    CHECK(machine_named("spa1").pe_memory_bytes == machine_named("spa").pe_memory_bytes);
}

TEST_CASE("arrays of other papers have the papers' mappings, and the SPA's number format", "[machine]") {
    struct Row {
        const char* name;
        MappingRule mapping;
        std::optional<DynamicPlan> dynamic;
        std::uint32_t pes;
    };
    for (const Row& row : {Row{"cap", grid_mapping(16, 16), {}, 256}, Row{"pixel-machine", grid_mapping(8, 8), {}, 64},
                           Row{"links", cyclic_mapping(0), DynamicPlan{.root_cycles = 568}, 256}}) {
        CAPTURE(row.name);
        const Machine& machine = machine_named(row.name);
        CHECK(machine.mapping == row.mapping);
        CHECK(machine.dynamic == row.dynamic);
        CHECK(machine.pes == row.pes);
        CHECK(machine.format == machine_named("spa").format);
        CHECK_FALSE(machine.pe_memory_bytes.has_value());
        CHECK(machine.clock.cycle_factor == machine_named("spa").clock.cycle_factor);
        CHECK_THAT(machine.title, Contains("on PEs of the SPA"));
    }
}

TEST_CASE("the machine torus is the paper's 64 transputers, and no other machine is a torus", "[machine]") {
    const Machine& torus = machine_named("torus");  // Yoshitani & Yamazaki
    CHECK(torus.pes == 64u);
    CHECK(torus.pe_memory_bytes == 4u << 20);
    CHECK(torus.bounces == 8);
    CHECK(torus.format.is_fp32());
    for (const Machine& machine : machines()) {
        CAPTURE(machine.name);
        CHECK((machine.kind == MachineKind::kTorus) == (machine.name == "torus"));
        CHECK((machine.kind == MachineKind::kTorus) == (machine.topology == "torus3d"));
    }
}

TEST_CASE("every machine is found by its exact name only", "[machine]") {
    std::set<std::string> names;
    for (const Machine& machine : machines()) {
        CHECK(&machine_named(machine.name) == &machine);
        CHECK_FALSE(machine.title.empty());
        names.insert(machine.name);
    }
    CHECK(names.size() == machines().size());
    for (const std::string name : {"", "SPA", "spa ", "cray"}) {
        CAPTURE(name);
        CHECK_THROWS_AS(machine_named(name), UserError);
        CHECK_THROWS_WITH(machine_named(name),
                          Contains("--machine " + name + ": no such machine") && Contains("spa, grande"));
    }
}

TEST_CASE("every number of every machine has a source, and every ring machine has all rates", "[machine]") {
    for (const Machine& machine : machines()) {
        CAPTURE(machine.name);
        CHECK(machine.facts.size() >= 9);
        for (const Fact& fact : machine.facts) {
            CAPTURE(fact.what);
            CHECK_FALSE(fact.value.empty());
            CHECK_FALSE(fact.source.empty());
        }
        if (machine.kind != MachineKind::kRing) continue;
        const MachineClock& c = machine.clock;
        for (const double rate : {c.cycle_ns, c.cycle_factor, c.link_words_per_s, c.broadcast_words_per_s,
                                  c.gather_words_per_s, c.display_pixels_per_s})
            CHECK(rate > 0);
    }
}
