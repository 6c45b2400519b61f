// Objects in parts that rotate on the ring (host/ring/turns.hpp). Random renders: tests/property.
#include <algorithm>
#include <catch2/catch.hpp>

#include "host/error.hpp"
#include "host/ring/turns.hpp"
#include "host/scene/generate.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

RingSettings split_settings(std::uint32_t parts, const std::string& machine = "spa") {
    return settings_of(
        {.width = 32, .height = 24, .pes = 24, .machine = machine, .lanes = 4, .record_costs = true, .split = parts});
}

RingResult rendered(const Scene& scene, const RingSettings& settings) {
    Session session(choose_device(""));
    return RingRenderer(session, scene, settings).render();
}

PackedJob job_of(const Scene& scene, const RingSettings& settings) {
    return pack_for_ring(scene, settings, length_scale(scene, settings.format));
}

std::uint64_t sum_of_costs(const RingResult& result) {
    std::uint64_t sum = 0;
    for (const std::uint64_t cycles : result.cost().cycles) sum += cycles;
    return sum;
}

TEST_CASE("every number of parts gives the image and counts of one part; rotations and words follow the formula",
          "[ring][split]") {
    for (const char* const name : quick(2, {"centre", "planes", "cones"})) {
        const Scene scene = project_scene(name);
        const RingResult whole = rendered(scene, split_settings(1));
        CHECK((whole.parts == 1 && whole.turns() == 0 && whole.events[RAYA_RESUMED] == 0));
        for (const std::uint32_t parts : {2u, 3u, 12u, 24u}) {
            CAPTURE(name, parts);
            const RingResult result = rendered(scene, split_settings(parts));
            CHECK(pixel_hash(result.image) == pixel_hash(whole.image));
            for (std::size_t e = 0; e < RAYA_EVENTS; ++e)
                if (e != RAYA_RESUMED) CHECK(result.events[e] == whole.events[e]);
            const std::uint64_t resumed = cycles_of_events()[RAYA_RESUMED] * result.events[RAYA_RESUMED];
            CHECK(result.events[RAYA_RESUMED] > 0);
            CHECK(sum_of_costs(result) == sum_of_costs(whole) + resumed);
            CHECK(result.phases[0].barrier_cycles() >= result.load.max);
            const Communication& c = result.communication;
            CHECK(result.parts == parts);
            CHECK(c.rotations == result.turns() * (parts - 1));
            CHECK(c.rotation_words == c.rotations * 24 * result.pe_memory.part_words);
            CHECK(c.broadcasts == 1 + parts);
            CHECK(c.broadcast_words == result.pe_memory.job_words + parts * result.pe_memory.part_words);
            CHECK(result.pe_memory.bytes() <= 32 * 1024);
        }
    }
}

TEST_CASE("a PE holds fewer ray trees the less memory it has, and then a render takes more turns", "[ring][split]") {
    const Scene scene = project_scene("centre");
    RingSettings settings = split_settings(4);
    const RingResult wide = rendered(scene, settings);
    CHECK(wide.pe_memory.trees == 48);  // one for each pixel of the largest share
    settings.machine.pe_memory_bytes = wide.pe_memory.bytes() - 4 * wide.pe_memory.tree_words * 45;
    const RingResult narrow = rendered(scene, settings);
    CHECK(narrow.pe_memory.trees == 3);
    CHECK(narrow.turns() > wide.turns());
    CHECK(pixel_hash(narrow.image) == pixel_hash(wide.image));
}

TEST_CASE("the smallest number of parts that fits a PE is chosen", "[ring][split]") {
    const Scene scene = generate_uniform(4000, {4, 4, 4});
    RingSettings settings = split_settings(0);
    const PackedJob job = job_of(scene, settings);
    const StoredScene stored = store_scene(job, settings, "s");
    REQUIRE(stored.parts);
    CHECK(stored.memory.bytes() <= 32 * 1024);
    for (std::uint32_t parts = 1; parts < stored.parts->parts; ++parts)
        if (settings.mapping.pes % parts == 0) {
            settings.split = parts;
            CHECK_THROWS_WITH(store_scene(job, settings, "s"), Catch::Contains("use a larger --split or --machine"));
        }
    settings = split_settings(0, "grande");
    CHECK(!store_scene(job, settings, "s").parts);
    settings = split_settings(0);
    settings.machine.pe_memory_bytes = 1024;
    CHECK_THROWS_WITH(store_scene(job, settings, "s"),
                      Catch::Contains("s in 24 parts: needs") && !Catch::Contains("larger --split"));
}

TEST_CASE("the parts hold every object once, in the order of their numbers", "[ring][split]") {
    for (const std::string& name : project_scenes(3)) {
        const PackedJob job = job_of(project_scene(name), split_settings(1));
        const raya_objects& all = job.header().objects;
        const std::uint32_t objects = raya_first_object(all, RAYA_OBJECT_KINDS);
        for (const std::uint32_t parts : {1u, 2u, 5u, objects, objects + 3}) {
            CAPTURE(name, parts);
            const ObjectParts divided = divide_objects(job, parts);
            std::uint32_t next = 0;
            for (std::uint32_t i = 0; i < parts; ++i) {
                const auto part = record_at<raya_part>(divided.part(i), 0);
                CHECK(part.first == next);
                const std::uint32_t count = raya_first_object(part.objects, RAYA_OBJECT_KINDS);
                CHECK((count == objects / parts || count == objects / parts + (objects % parts != 0)));
                for (std::uint32_t n = 0; n < count; ++n, ++next) {
                    REQUIRE(kind_of_object(part.objects, n) == kind_of_object(all, next));
                    const std::uint32_t* const object = &divided.part(i)[object_at(part.objects, n)];
                    CHECK(std::equal(object, object + 4, job.object(next)));
                }
            }
            CHECK(next == objects);
        }
    }
}

TEST_CASE("a number of parts that cannot rotate is refused", "[ring][split]") {
    const Scene scene = project_scene("centre");
    const auto check = [&](const char* message, const auto& change) {
        RingSettings settings = split_settings(5);
        change(settings);
        CHECK_THROWS_WITH(rendered(scene, settings), Catch::Contains(message));
    };
    check("--split 5: must divide the number of PEs, 24; use --split 4", [](RingSettings&) {});
    check("use --split 24", [](RingSettings& s) { s.split = 25; });
    check("--split 2 with --accel bvh", [](RingSettings& s) {
        s.split = 2;
        s.accel.kind = AccelKind::kBvh;
    });
    check("--split 2 with a dynamic mapping", [](RingSettings& s) {
        s.split = 2;
        s.dynamic = DynamicPlan{1, 0, 1};
    });
}

}  // namespace
}  // namespace raya
