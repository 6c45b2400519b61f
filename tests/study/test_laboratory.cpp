// The laboratory: each scene is rendered once, and what it keeps of a render are the sums that the kernels count on the
// SPA itself, whatever its PEs and offset.
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
namespace {

std::uint64_t weighed(const EventCounts& events) {
    const auto cycles = cycles_of_events();
    return std::inner_product(events.begin(), events.end(), cycles.begin(), std::uint64_t{0});
}

RingResult render_on_spa(Session& session, const Scene& scene, std::uint32_t size, std::uint32_t pes, std::uint32_t p,
                         AntialiasMethod method = AntialiasMethod::kNone) {
    RingCase c{.width = size, .height = size, .pes = pes, .offset = p, .machine = "spa"};
    c.format = format_name(machine_named("spa").format);
    c.bounces = machine_named("spa").bounces;
    c.antialias.method = method;
    return RingRenderer(session, scene, settings_of(c)).render();
}

TEST_CASE("a laboratory renders once for a scene, a size and a method", "[laboratory]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const LabelledScene scene = embedded_scene("glass");
    const auto rendered = [&](const LabelledScene& one, std::uint32_t size, AntialiasMethod method) {
        session.clear_profile();
        const Costs* costs = &lab.costs(one, size, method);
        return std::pair(costs, !session.profile().summary().empty());
    };
    const auto [plain, first] = rendered(scene, 16, AntialiasMethod::kNone);
    CHECK(first);
    const auto [larger, second] = rendered(scene, 18, AntialiasMethod::kNone);
    CHECK(second);
    const auto [supersampled, third] = rendered(scene, 16, AntialiasMethod::kSupersample);
    CHECK(third);
    const auto [other, fourth] = rendered({"glass", embedded_scene("cones").scene}, 16, AntialiasMethod::kNone);
    CHECK(fourth);  // another scene, though it is called the same
    CHECK(std::set{plain, larger, supersampled, other}.size() == 4);
    CHECK(other->trace.cycles != plain->trace.cycles);
    CHECK(rendered(scene, 16, AntialiasMethod::kNone) == std::pair(plain, false));
    CHECK(rendered(embedded_scene("glass"), 18, AntialiasMethod::kNone) == std::pair(larger, false));
    CHECK(rendered(scene, 16, AntialiasMethod::kSupersample) == std::pair(supersampled, false));
    CHECK(plain->label == "glass");
    CHECK(plain->objects == scene.scene.object_count());
    CHECK(plain->trace.width == 16);
    CHECK(larger->trace.cycles.size() == 18 * 18);
    CHECK(plain->supersample.cycles.empty());
    CHECK(plain->recomputed == 0);
    CHECK(plain->device_s > 0);
}

TEST_CASE("a laboratory's size is the one asked for, else the study's", "[laboratory]") {
    Session session(choose_device(""));
    CHECK(Laboratory(session, 0).size(256) == 256);
    CHECK(Laboratory(session, 32).size(256) == 32);
    CHECK(spa_ms(6'530'000) == Approx(653).epsilon(1e-15));  // 100 ns a cycle
}

TEST_CASE("loads from the cost image are those that the SPA's PEs count, for any PEs and offset", "[laboratory]") {
    constexpr std::uint32_t kSize = 36;
    const std::string name = GENERATE("centre", "polygons", "cones");
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const Costs& costs = lab.costs(embedded_scene(name), kSize);
    CHECK(total_cycles(costs.trace) == weighed(costs.events));
    for (const auto& [pes, p] : {std::pair{kSize, 0u}, {kSize, 16u}, {10u, 3u}, {50u, 35u}}) {
        CAPTURE(name, pes, p);
        const RingResult spa = render_on_spa(session, project_scene(name), kSize, pes, p);
        const Load expected = static_load(costs.trace, cyclic(kSize, kSize, pes, p));
        CHECK(expected.per_pe == spa.all.load.per_pe);
        CHECK(costs.events == spa.all.events);
        CHECK(costs.job_words == spa.pe_memory.job_words);
    }
}

TEST_CASE("supersampling costs something where the mask says so, nothing elsewhere", "[laboratory]") {
    constexpr std::uint32_t kSize = 40;
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const LabelledScene scene = embedded_scene("centre");
    const Costs& costs = lab.costs(scene, kSize, AntialiasMethod::kSupersample);
    const RingResult spa = render_on_spa(session, scene.scene, kSize, 20, 7, AntialiasMethod::kSupersample);
    REQUIRE(costs.supersample.cycles.size() == kSize * kSize);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < costs.supersample.cycles.size(); ++i)
        wrong += (costs.supersample.cycles[i] > 0) != (spa.mask.rgb[3 * i] > 0);
    CHECK(wrong == 0);
    CHECK(costs.recomputed == spa.recomputed);
    CHECK(costs.recomputed > 0);
    CHECK(costs.recomputed < kSize * kSize);
    CHECK(total_cycles(costs.supersample) == weighed(spa.phases.back().events));
    CHECK(static_load(costs.supersample, cyclic(kSize, kSize, 20, 7)).per_pe == spa.phases.back().load.per_pe);
    CHECK(costs.trace.cycles == lab.costs(scene, kSize).trace.cycles);
    CHECK(total_cycles(costs.trace) == weighed(costs.events));
}

TEST_CASE("the paper-like scenes are ten, of 6 to 31 objects, no two alike", "[laboratory]") {
    const std::vector<LabelledScene> scenes = paper_like_scenes();
    CHECK(scenes.size() == 10);
    std::set<std::string> labels;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        CAPTURE(scenes[i].label);
        labels.insert(scenes[i].label);
        CHECK(scenes[i].scene.object_count() >= 6);
        CHECK(scenes[i].scene.object_count() <= 31);
        for (std::size_t other = 0; other < i; ++other) CHECK_FALSE(scenes[i].scene == scenes[other].scene);
    }
    CHECK(labels.size() == 10);
}

}  // namespace
}  // namespace raya
