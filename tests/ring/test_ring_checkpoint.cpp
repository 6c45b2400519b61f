// A render that stops between two bands and resumes from a checkpoint gives the same image and counts.
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "host/error.hpp"
#include "host/ring/ring_state.hpp"
#include "tests/base/test_checkpointing.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

RingSettings settings_for(AntialiasMethod method, std::uint64_t device_pixels) {
    RingSettings settings =
        settings_of({.width = 50, .height = 37, .pes = 7, .machine = "grande", .lanes = 4, .bounces = 3});
    settings.record_costs = true;
    settings.antialias.method = method;
    settings.device_pixels = device_pixels;
    return settings;
}

// Returns the state and the settings in a checkpoint of a render with `settings`.
std::pair<RingState, StateSettings> parsed(const std::string& bytes, const RingSettings& settings) {
    const StateSettings saved = saved_settings(bytes);
    const raya_mapping& m = settings.mapping;
    const std::size_t pixels = std::size_t{m.width} * m.height,
                      in_window = m.pes * std::stoul(checkpoint_header(bytes).at("of").at("a device window of").text());
    const bool supersamples = settings.antialias.method == AntialiasMethod::kSupersample;
    RingState sizes;
    sizes.image.resize(3 * pixels);
    sizes.pixels.resize(3 * in_window);
    if (supersamples) sizes.marks.resize(in_window);
    sizes.passes.resize(supersamples ? 2 : 1);
    for (RingState::Pass& pass : sizes.passes) {
        pass.cycles.resize(in_window);
        pass.events.resize(RAYA_EVENTS * m.pes);
        pass.costs.resize(pixels);
    }
    if (supersamples) sizes.all_costs.resize(pixels);
    return {read_state(bytes, saved, sizes), saved};
}

TEST_CASE("a render that is stopped at any band and resumed gives the same image and counts", "[ring][checkpoint]") {
    const std::uint32_t seed = 20;
    CAPTURE(seed);
    std::mt19937 random(seed);
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    const std::pair<AntialiasMethod, std::uint64_t> cases[] = {{AntialiasMethod::kNone, 1 << 22},
                                                               {AntialiasMethod::kNone, 500},
                                                               {AntialiasMethod::kFilter, 1 << 22},
                                                               {AntialiasMethod::kSupersample, 1 << 22}};
    for (const auto& [method, device_pixels] : cases) {
        CAPTURE(antialias_name(method), device_pixels);
        const RingSettings settings = settings_for(method, device_pixels);
        const RingResult whole = RingRenderer(session, scene, settings).render();
        TestCheckpointing uninterrupted;
        const RingResult saved = RingRenderer(session, scene, settings).render({}, uninterrupted.checkpointing());
        check_same(saved, whole);
        CHECK(saved.earlier_s == 0);
        REQUIRE(uninterrupted.count() > 3);
        for (int stop = 1; stop <= uninterrupted.count(); stop += 1 + static_cast<int>(random() % quick_cases(9, 3))) {
            CAPTURE(stop, uninterrupted.count());
            TestCheckpointing first(stop);
            CHECK_THROWS_AS(RingRenderer(session, scene, settings).render({}, first.checkpointing()), Stopped);
            TestCheckpointing second(1 + static_cast<int>(random() % 2), first.saved());  // the render may stop again
            std::string state = first.saved();
            RingSettings other_group = settings;  // the image and the counts do not depend on the group size
            if (method == AntialiasMethod::kSupersample) other_group.kernels.group_size = 2;
            try {
                RingRenderer(session, scene, other_group).render({}, second.checkpointing());
            } catch (const Stopped&) {
                state = second.saved();
            }
            TestCheckpointing last(1 << 30, state);
            const RingResult resumed = RingRenderer(session, scene, settings).render({}, last.checkpointing());
            check_same(resumed, whole);
            CHECK(resumed.earlier_s > 0);
            CHECK(resumed.render_s > resumed.earlier_s);
            REQUIRE(last.count() < uninterrupted.count());  // finished bands are not repeated
        }
    }
}

TEST_CASE("one renderer renders with and without a checkpoint, in any order", "[ring][checkpoint]") {
    Session session(choose_device(""));
    const RingSettings settings = settings_for(AntialiasMethod::kSupersample, 1 << 22);
    RingRenderer renderer(session, project_scene("planes"), settings);
    const RingResult whole = renderer.render();
    TestCheckpointing first(3);
    CHECK_THROWS_AS(renderer.render({}, first.checkpointing()), Stopped);
    check_same(renderer.render(), whole);
    TestCheckpointing last(1 << 30, first.saved());
    check_same(renderer.render({}, last.checkpointing()), whole);
    const RingResult unsaved = renderer.render();
    check_same(unsaved, whole);
    CHECK(unsaved.earlier_s == 0);
}

TEST_CASE("a checkpoint of another render is refused with a message that names the difference", "[ring][checkpoint]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    const RingSettings settings = settings_for(AntialiasMethod::kNone, 1 << 22);
    TestCheckpointing first(2);
    CHECK_THROWS_AS(RingRenderer(session, scene, settings).render({}, first.checkpointing()), Stopped);
    const auto check_refused = [&](const Scene& other_scene, const RingSettings& changed, const char* reason) {
        CAPTURE(reason);
        TestCheckpointing second(1 << 30, first.saved());
        RingRenderer renderer(session, other_scene, changed);
        CHECK_THROWS_WITH(renderer.render({}, second.checkpointing()), Catch::Contains(reason));
    };
    Scene moved = scene;
    moved.view.from.x += 1e-3;
    check_refused(moved, settings, "was rendered with another scene, camera or light");
    const auto check_setting = [&](const char* reason, const auto& change) {
        RingSettings changed = settings;
        change(changed);
        check_refused(scene, changed, reason);
    };
    check_setting("was rendered with --bounces 3, not 2", [](RingSettings& s) { s.bounces = 2; });
    check_setting("was rendered with --cost or --mapping dynamic", [](RingSettings& s) { s.record_costs = false; });
    check_setting("was rendered with --format fp32, not e8m21",
                  [](RingSettings& s) { s.format = parse_format("e8m21"); });
    check_setting("was rendered with --accel none, not bvh", [](RingSettings& s) { s.accel.kind = AccelKind::kBvh; });
    check_setting("was rendered with --sampling centres, not corners",
                  [](RingSettings& s) { s.sampling = Sampling::kCorners; });
    check_setting("was rendered with --threshold ", [](RingSettings& s) { s.antialias.threshold *= 2; });
    check_refused(scene, settings_for(AntialiasMethod::kFilter, 1 << 22),
                  "was rendered with --antialias none, not filter");
    check_refused(scene, settings_for(AntialiasMethod::kNone, 100), "was rendered with a device window of ");
}

TEST_CASE("a checkpoint with a valid hash is refused if its vector sizes are not those of the render",
          "[ring][checkpoint]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    for (const AntialiasMethod method : {AntialiasMethod::kNone, AntialiasMethod::kSupersample}) {
        CAPTURE(antialias_name(method));
        const RingSettings settings = settings_for(method, 1 << 22);
        RingRenderer renderer(session, scene, settings);
        TestCheckpointing first(1);
        CHECK_THROWS_AS(renderer.render({}, first.checkpointing()), Stopped);
        const auto [saved, state_settings] = parsed(first.saved(), settings);
        const std::pair<const char*, std::function<void(RingState&)>> damages[] = {
            {"no pass", [](RingState& s) { s.passes.clear(); }},
            {"a pass too many", [](RingState& s) { s.passes.emplace_back(); }},
            {"no image", [](RingState& s) { s.image.clear(); }},
            {"a longer image", [](RingState& s) { s.image.resize(s.image.size() + 1); }},
            {"fewer pixels", [](RingState& s) { s.pixels.resize(1); }},
            {"more pixels", [](RingState& s) { s.pixels.resize(2 * s.pixels.size()); }},
            {"more marks", [](RingState& s) { s.marks.resize(s.marks.size() + 1); }},
            {"no cycles", [](RingState& s) { s.passes[0].cycles.clear(); }},
            {"more events", [](RingState& s) { s.passes[0].events.resize(2 * s.passes[0].events.size()); }},
            {"no costs", [](RingState& s) { s.passes[0].costs.clear(); }},
            {"more costs in all_costs", [](RingState& s) { s.all_costs.resize(s.all_costs.size() + 1); }}};
        for (const auto& [name, damage] : damages) {
            CAPTURE(name);
            RingState damaged = saved;
            damage(damaged);
            TestCheckpointing last(1 << 30, state_bytes(damaged, state_settings));
            CHECK_THROWS_WITH(renderer.render({}, last.checkpointing()), "damaged");
        }
    }
}

TEST_CASE("a checkpoint with a changed byte or a missing end is refused", "[ring][checkpoint]") {
    const std::uint32_t seed = 21;
    CAPTURE(seed);
    std::mt19937 random(seed);
    RingState state;
    state.window = 5;
    state.next = 7;
    state.part.fraction = 0.25;
    state.image = {1, 2, 3};
    state.pixels = {4};
    state.passes.resize(1);
    state.passes[0].events = {1, 2};
    const StateSettings settings = {{"name", "value \"x\""}};
    const std::string bytes = state_bytes(state, settings);
    const RingState read = read_state(bytes, settings, state);
    CHECK(read.next == 7);
    CHECK((read.image == state.image));
    CHECK((read.passes[0].events == state.passes[0].events));
    CHECK(state_bytes(read, settings) == bytes);
    for (int i = 0; i < 500; ++i) {
        std::string damaged = bytes;
        if (random() % 4 == 0)
            damaged.resize(random() % bytes.size());
        else
            damaged[random() % bytes.size()] ^= static_cast<char>(1 + random() % 255);
        CAPTURE(i);
        CHECK_THROWS_AS(read_state(damaged, settings, state), UserError);
    }
    CHECK_THROWS_WITH(read_state(bytes, {{"name", "other"}}, state), "was rendered with name value \"x\", not other");
    CHECK_THROWS_WITH(read_state(bytes, {{"new", "one"}}, state), "'new' is missing");
}

}  // namespace
}  // namespace raya
