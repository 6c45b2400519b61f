// For large images the device holds only a window of each PE's pixels at a time, which changes no result.
#include <catch2/catch.hpp>

#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

TEST_CASE("the number of pixels on the device changes no image, count, load or cost", "[ring]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    for (const char* machine : {"grande", "spa"}) {
        const RingCase c{.width = 50, .height = 37, .pes = 7, .machine = machine, .lanes = 4, .bounces = 3};
        RingSettings settings = settings_of(c);
        settings.record_costs = true;
        const RingResult whole = RingRenderer(session, scene, settings).render();
        for (const std::uint64_t pixels : {1, 7, 100, 1849, 1850}) {
            CAPTURE(machine, pixels);
            settings.device_pixels = pixels;
            const RingResult windowed = RingRenderer(session, scene, settings).render();
            CHECK(pixel_hash(windowed.image) == pixel_hash(whole.image));
            CHECK(windowed.events == whole.events);
            CHECK(windowed.load.per_pe == whole.load.per_pe);
            CHECK(windowed.cost().cycles == whole.cost().cycles);
            CHECK(windowed.communication.gathers == whole.communication.gathers);
            CHECK(windowed.communication.gather_words == whole.communication.gather_words);
            CHECK(windowed.pe_memory.bytes() == whole.pe_memory.bytes());
        }
    }
}

TEST_CASE("costs are recorded only on request, which changes no other result", "[ring]") {
    Session session(choose_device(""));
    RingSettings settings = settings_of({.width = 20, .height = 16, .pes = 5, .lanes = 4, .bounces = 3});
    const RingResult without_costs = RingRenderer(session, project_scene("planes"), settings).render();
    settings.record_costs = true;
    const RingResult with_costs = RingRenderer(session, project_scene("planes"), settings).render();
    CHECK(with_costs.cost().cycles.size() == 320);
    CHECK_THROWS_AS(without_costs.cost(), std::logic_error);
    CHECK_THROWS_AS(without_costs.phases.front().cost(), std::logic_error);
    CHECK(without_costs.load.per_pe == with_costs.load.per_pe);
    CHECK(pixel_hash(without_costs.image) == pixel_hash(with_costs.image));
    settings.record_costs = false;
    settings.dynamic = DynamicPlan{.chunk = 4};
    CHECK(RingRenderer(session, project_scene("planes"), settings).render().cost().cycles.size() == 320);
}

}  // namespace
}  // namespace raya
