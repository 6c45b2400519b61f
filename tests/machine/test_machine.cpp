// The machines' descriptions and the cost of what is counted.
#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "error.hpp"
#include "machine/machine.hpp"

using namespace raya;
using Catch::Contains;

TEST_CASE("the SPA is the paper's, and comes first", "[machine]") {
    const Machine& spa = machine_named("spa");  // Kohata & Ito 1993
    CHECK(machines().front().name == "spa");
    CHECK(spa.pes == 256u);
    CHECK(spa.offset == 16);
    CHECK(spa.pe_memory_bytes == 32u * 1024);
    CHECK(spa.bounces == 8);
    CHECK(spa.topology == "ring+bus");
}

TEST_CASE("grande is the same array without the limits", "[machine]") {
    const Machine& grande = machine_named("grande");
    CHECK_FALSE(grande.pes.has_value());
    CHECK_FALSE(grande.pe_memory_bytes.has_value());
    CHECK(grande.offset == machine_named("spa").offset);
    CHECK(grande.bounces == machine_named("spa").bounces);
}

TEST_CASE("every machine is found by its own name, and no other", "[machine]") {
    std::set<std::string> names;
    for (const Machine& machine : machines()) {
        CHECK(&machine_named(machine.name) == &machine);
        CHECK_FALSE(machine.title.empty());
        names.insert(machine.name);
    }
    CHECK(names.size() == machines().size());
    for (const std::string wrong : {"", "SPA", "spa ", "cray"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(machine_named(wrong), UserError);
        CHECK_THROWS_WITH(machine_named(wrong), Contains("'" + wrong + "'") && Contains("spa, grande"));
    }
}

TEST_CASE("every event costs cycles, but hits, whose cost lies in what follows them", "[machine]") {
    const auto cycles = cycles_of_events();
    for (int event = 0; event < RAYA_EVENTS; ++event) {
        const bool free = event == RAYA_PRIMARY_HITS || event == RAYA_SHADOW_HITS;
        CAPTURE(event);
        CHECK((cycles[static_cast<std::size_t>(event)] == 0) == free);
    }
    CHECK(cycles[RAYA_PLANE_TESTS] < cycles[RAYA_SPHERE_TESTS]);
    CHECK(cycles[RAYA_PLANE_TESTS] < cycles[RAYA_POLYGON_TESTS]);  // a polygon's test begins with its plane's
    CHECK(cycles[RAYA_SPHERE_TESTS] < cycles[RAYA_CONE_TESTS]);
}
