// Large images: the device holds only a window of the pixels at a time. This changes no result.
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
            const RingResult parts = RingRenderer(session, scene, settings).render();
            CHECK(pixel_hash(parts.image) == pixel_hash(whole.image));
            CHECK(parts.all.events == whole.all.events);
            CHECK(parts.all.load.per_pe == whole.all.load.per_pe);
            CHECK(parts.cost().cycles == whole.cost().cycles);
            CHECK(parts.communication.gathers == whole.communication.gathers);
            CHECK(parts.communication.gather_words == whole.communication.gather_words);
            CHECK(parts.pe_memory.bytes() == whole.pe_memory.bytes());
        }
    }
}

TEST_CASE("costs are recorded only on request, which changes no other result", "[ring]") {
    Session session(choose_device(""));
    RingSettings settings = settings_of({.width = 20, .height = 16, .pes = 5, .lanes = 4, .bounces = 3});
    const RingResult not_kept = RingRenderer(session, project_scene("planes"), settings).render();
    settings.record_costs = true;
    const RingResult kept = RingRenderer(session, project_scene("planes"), settings).render();
    CHECK(kept.cost().cycles.size() == 320);
    CHECK_THROWS_AS(not_kept.cost(), std::logic_error);
    CHECK_THROWS_AS(not_kept.phases.front().cost(), std::logic_error);
    CHECK(not_kept.all.load.per_pe == kept.all.load.per_pe);
    CHECK(pixel_hash(not_kept.image) == pixel_hash(kept.image));
    settings.record_costs = false;
    settings.dynamic = DynamicPlan{.chunk = 4};
    CHECK(RingRenderer(session, project_scene("planes"), settings).render().cost().cycles.size() == 320);
}

}  // namespace
}  // namespace raya
