// Checkpoints that must be refused: those of other renders, and damaged ones. Resumed renders: tests/property.
#include <catch2/catch.hpp>
#include <functional>

#include "host/error.hpp"
#include "tests/base/test_checkpointing.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
namespace {

RingSettings settings_for(AntialiasMethod method, std::uint64_t device_pixels) {
    RingSettings settings = settings_of({.width = 50, .height = 37, .pes = 7, .machine = "grande", .lanes = 4});
    settings.record_costs = true;
    settings.antialias.method = method;
    settings.device_pixels = device_pixels;
    return settings;
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
    check_setting("was rendered with --bounces 4, not 0", [](RingSettings& s) { s.bounces = 0; });
    check_setting("was rendered with --cost or --mapping dynamic", [](RingSettings& s) { s.record_costs = false; });
    check_setting("was rendered with --format fp32, not e6m15",
                  [](RingSettings& s) { s.format = parse_format("spa22"); });
    check_setting("was rendered with --accel none, not bvh", [](RingSettings& s) { s.accel.kind = AccelKind::kBvh; });
    check_setting("was rendered with --sampling centres, not corners",
                  [](RingSettings& s) { s.sampling = Sampling::kCorners; });
    check_setting("was rendered with --threshold ", [](RingSettings& s) { s.antialias.threshold *= 2; });
    check_refused(scene, settings_for(AntialiasMethod::kFilter, 1 << 22),
                  "was rendered with --antialias none, not filter");
    check_refused(scene, settings_for(AntialiasMethod::kNone, 100), "was rendered with a device window of ");
}

TEST_CASE("a checkpoint is refused if a byte is changed or missing, or if its vector sizes are not those of the render",
          "[ring][checkpoint]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("planes");
    for (const AntialiasMethod method : {AntialiasMethod::kNone, AntialiasMethod::kSupersample}) {
        CAPTURE(antialias_name(method));
        const RingSettings settings = settings_for(method, 1 << 22);
        RingRenderer renderer(session, scene, settings);
        TestCheckpointing first(1);
        CHECK_THROWS_AS(renderer.render({}, first.checkpointing()), Stopped);
        const CheckpointBody saved(first.saved());
        CHECK(saved.bytes() == first.saved());
        // Sizes of elements: pass, window, next, communication, image, pixels, then marks if supersampled.
        std::vector<std::size_t> vectors = {4, 4, 4, sizeof(Communication), 4, 4};
        if (method == AntialiasMethod::kSupersample) vectors.push_back(1);
        for (const std::size_t element_bytes : {8, 8, 8}) vectors.push_back(element_bytes);  // cycles, events, costs
        std::vector<std::function<void(CheckpointBody&)>> damages = {
            [](CheckpointBody& s) { s.set(8, 2u); },  // pass
            [](CheckpointBody& s) { s.body.resize(s.body.size() - 8); },
            [](CheckpointBody& s) { s.body += "moremore"; }};
        for (std::size_t k = 0; k < vectors.size(); ++k)
            for (const int change : {-1, 1}) {
                const std::size_t at =
                    saved.vector_at({vectors.begin(), vectors.begin() + static_cast<std::ptrdiff_t>(k)});
                damages.emplace_back([=](CheckpointBody& s) {
                    s.set(at, s.number<std::uint64_t>(at) + static_cast<std::uint64_t>(change));
                });
            }
        for (std::size_t at = 0; at < first.saved().size(); at += first.saved().size() / 50) {
            CAPTURE(at);
            std::string damaged = first.saved();
            damaged[at] ^= 4;
            TestCheckpointing changed(1 << 30, damaged), shorter(1 << 30, damaged.substr(0, at));
            CHECK_THROWS_AS(renderer.render({}, changed.checkpointing()), UserError);
            if (at > 0) CHECK_THROWS_AS(renderer.render({}, shorter.checkpointing()), UserError);
        }
        for (std::size_t i = 0; i < damages.size(); ++i) {
            CAPTURE(i);
            CheckpointBody damaged = saved;
            damages[i](damaged);
            TestCheckpointing last(1 << 30, damaged.bytes());
            CHECK_THROWS_WITH(renderer.render({}, last.checkpointing()), "damaged");
        }
    }
}

}  // namespace
}  // namespace raya
