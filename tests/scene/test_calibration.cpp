// The main scene (scenes/centre.nff) has the imbalance of the paper's scene; scenes/README.md states this imbalance.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

RingResult render_on_spa(Session& session, const Scene& scene, std::uint32_t p) {
    RingSettings settings;
    settings.machine = machine_named("spa");
    settings.format = settings.machine.format;
    settings.bounces = settings.machine.bounces;
    settings.mapping = make_mapping(cyclic_mapping(p), {256, 256}, settings.machine.pes.value());
    return RingRenderer(session, scene, settings).render();
}

TEST_CASE("the centre scene has the imbalance of the paper's scene, 1.58 +- 0.03", "[calibration]") {
    Session session(choose_device(""));
    const Scene scene = parse_nff(file_contents(RAYA_SOURCE_DIR "/scenes/centre.nff"), "centre");
    const Load column_load = render_on_spa(session, scene, 0).load,
               cyclic_load = render_on_spa(session, scene, 16).load;
    CHECK(column_load.per_pe.size() == 256);
    CHECK(column_load.mean == cyclic_load.mean);
    CHECK(column_load.imbalance >= 1.55);
    CHECK(column_load.imbalance <= 1.61);
    const std::string readme = file_contents(RAYA_SOURCE_DIR "/scenes/README.md");
    CHECK_THAT(readme, Catch::Contains(fmt::format("**{:.3f}**", column_load.imbalance)));
    CHECK_THAT(readme, Catch::Contains(fmt::format("**{:.3f}**", cyclic_load.imbalance)));
}

}  // namespace
}  // namespace raya
