// A render that stops between two bands and resumes from a checkpoint gives the same image and counts.
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "host/error.hpp"
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
        for (std::size_t i = 0; i < damages.size(); ++i) {
            CAPTURE(i);
            CheckpointBody damaged = saved;
            damages[i](damaged);
            TestCheckpointing last(1 << 30, damaged.bytes());
            CHECK_THROWS_WITH(renderer.render({}, last.checkpointing()), "damaged");
        }
    }
}

TEST_CASE("a checkpoint with a changed byte or a missing end is refused", "[ring][checkpoint]") {
    const std::uint32_t seed = 21;
    CAPTURE(seed);
    std::mt19937 random(seed);
    const StateSettings settings = {{"name", "value \"x\""}};
    const std::vector<float> image = {1, 2, 3};
    const std::vector<std::uint64_t> events = {1, 2};
    CheckpointWriter writer(settings, {.fraction = 0.25});
    writer.put(image);
    writer.put(events);
    const std::string bytes = writer.finish();
    const auto read = [&](const std::string& file, const StateSettings& of) {
        CheckpointReader reader(file, of);
        std::vector<std::uint64_t> read_events(2);
        CHECK(reader.part().fraction == 0.25);
        CHECK((reader.take_any<float>() == image));
        reader.take(read_events);
        CHECK(read_events == events);
        reader.check_end();
    };
    read(bytes, settings);
    for (int i = 0; i < 500; ++i) {
        std::string damaged = bytes;
        if (random() % 4 == 0)
            damaged.resize(random() % bytes.size());
        else
            damaged[random() % bytes.size()] ^= static_cast<char>(1 + random() % 255);
        CAPTURE(i);
        CHECK_THROWS_AS(read(damaged, settings), UserError);
    }
    CHECK_THROWS_WITH(read(bytes, {{"name", "other"}}), "was rendered with name value \"x\", not other");
    CHECK_THROWS_WITH(read(bytes, {{"new", "one"}}), "damaged header: 'new' is missing");
}

}  // namespace
}  // namespace raya
