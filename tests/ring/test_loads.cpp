// The load of a PE is the sum of its pixels' costs: the kernels count the same events per PE and per pixel.
#include <catch2/catch.hpp>

#include "host/ring/mapping.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
TEST_CASE("each PE's load is the sum of its pixels' costs, in every phase", "[ring]") {
    const std::string scene = GENERATE("centre", "polygons", "cones");
    const auto [pes, offset] = GENERATE(table<std::uint32_t, std::uint32_t>({{1, 0}, {7, 5}, {40, 16}, {64, 3}}));
    CAPTURE(scene, pes, offset);
    RingCase c{.width = 40, .height = 24, .pes = pes, .offset = offset, .lanes = 4};
    c.antialias.method = AntialiasMethod::kSupersample;
    c.record_costs = true;
    const RingResult result = render_scene(project_scene(scene), c);
    REQUIRE(result.phases.size() == 2);
    for (const Phase& phase : result.phases) {
        CAPTURE(phase.name);
        CHECK(phase.load.per_pe == static_load(phase.cost(), settings_of(c).mapping).per_pe);
        CHECK(phase.load.max > 0);
    }
    CHECK(result.load.per_pe == static_load(result.cost(), settings_of(c).mapping).per_pe);
}

}  // namespace raya
