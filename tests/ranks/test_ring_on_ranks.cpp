// The ring distributed over ranks. Pixels, costs, supersampling marks, loads and counts equal those of a single rank,
// bit for bit.
#include <catch2/catch.hpp>
#include <mutex>

#include "host/error.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/ranks/thread_ranks.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

/// Renders on `count` ranks, each with its own session; returns rank 0's result.
RingResult render_on(std::uint32_t count, const Scene& scene, const RingSettings& settings) {
    RingResult result;
    on_ranks(count, [&](Ranks& ranks) {
        Session session(choose_device(""));
        const Scene empty_scene;
        RingRenderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
        RingResult own_result = renderer.render();
        if (ranks.is_first())
            result = std::move(own_result);
        else if (!own_result.image.rgb.empty() || !own_result.mask.rgb.empty())
            throw std::logic_error("a rank other than 0 holds an image");
    });
    return result;
}

raya_mapping random_mapping(SplitMix& random) {
    const raya_mapping m = small_mapping(random, 12);
    return random.next() % 2 ? m : mapping_of_kind(random, m, RAYA_ROWS + random_below(random, 5));
}

Antialias random_antialias(SplitMix& random) {
    Antialias a;
    const AntialiasMethod methods[] = {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample};
    const ExchangeMethod exchanges[] = {ExchangeMethod::kRing, ExchangeMethod::kRing, ExchangeMethod::kBus,
                                        ExchangeMethod::kBroadcast};
    a.method = methods[random_below(random, 3)];
    a.exchange = exchanges[random_below(random, 4)];
    return a;
}

}  // namespace

TEST_CASE("random rings: image, loads and counts are the same on 1 to 8 ranks", "[ranks]") {
    constexpr std::uint64_t kSeed = 4711;
    SplitMix random(kSeed);
    std::vector<Scene> scenes;
    for (const std::string& name : project_scenes()) scenes.push_back(project_scene(name));
    std::uint32_t cases = 0, uneven_cases = 0;
    for (std::uint32_t i = 0; i < quick_cases(24, 120); ++i) {
        const Scene& scene = scenes[i % scenes.size()];
        RingSettings settings = settings_of(RingCase{.format = i % 3 ? "fp32" : "spa22"});
        settings.mapping = random_mapping(random);
        settings.antialias = random_antialias(random);
        if (settings.mapping.kind == RAYA_RANDOM)
            settings.antialias = {};  // anti-aliasing is refused, because neighbouring pixels are in different PEs
        settings.record_costs = true;
        const AccelKind kinds[] = {AccelKind::kNone, AccelKind::kGrid, AccelKind::kBvh};
        settings.accel.kind = kinds[random_below(random, 3)];
        settings.device_pixels = random.next() % 3 ? 1 << 22 : 1 + random_below(random, 60);
        if (random.next() % 4 == 0) settings.machine.pe_memory_bytes = std::uint64_t{1} << 20;
        Session session(choose_device(""));
        const RingResult single = RingRenderer(session, scene, settings).render();
        for (const std::uint32_t count : {1u, 2u, 3u, 4u, 7u, 8u}) {
            if (count > settings.mapping.pes) continue;
            CAPTURE(kSeed, i, scene.name, count, settings.mapping.pes, settings.mapping.width, settings.mapping.height,
                    settings.mapping.kind);
            check_same(single, render_on(count, scene, settings));
            uneven_cases += settings.mapping.pes % count != 0;
            ++cases;
        }
    }
    CHECK(cases > 60);
    CHECK(uneven_cases > 10);
}

TEST_CASE("rings: the work of the ranks' kernels adds up to that of a single rank", "[ranks]") {
    const Scene scene = project_scene("planes"), empty_scene;
    for (const AntialiasMethod method : {AntialiasMethod::kFilter, AntialiasMethod::kSupersample})
        for (const MappingRule& rule : {cyclic_mapping(8, Fold::kCyclic), tiles_mapping(5, 11)}) {
            RingSettings settings = settings_of(RingCase{.width = 30, .height = 22, .pes = 7, .mapping = rule});
            settings.antialias.method = method;
            const auto works_of = [&](Ranks& ranks) {
                Session session(choose_device(""));
                RingRenderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
                return ring_kernel_work(settings, renderer.render());
            };
            const std::vector<KernelWork> single = works_of(Ranks::single());
            std::vector<std::vector<KernelWork>> works(3);
            on_ranks(3, [&](Ranks& ranks) { works[ranks.rank()] = works_of(ranks); });
            for (const std::vector<KernelWork>& of_rank : works) CHECK(of_rank.front().rays < single.front().rays);
            check_sums(single, works,
                       method == AntialiasMethod::kFilter
                           ? std::vector<std::string>{"filter.sum_rows", "filter.sum_columns", "filter.take_means"}
                           : std::vector<std::string>{"supersample.compare"});
        }
}

TEST_CASE("more ranks than PEs are refused with both numbers", "[ranks]") {
    RingSettings settings = settings_of(RingCase{.width = 8, .height = 4, .pes = 3, .offset = 0});
    CHECK_THROWS_WITH(render_on(4, project_scene("spheres"), settings),
                      Catch::Contains("4 ranks for 3 PEs") && Catch::Contains("start 3 ranks or fewer"));
}

TEST_CASE("every PE belongs to one rank, and the ranks' numbers of PEs differ by at most one", "[ranks]") {
    for (const std::uint32_t pes : {1u, 2u, 5u, 8u, 256u, 1000u, 65'536u})
        for (std::uint32_t count = 1; count <= std::min(pes, 9u); ++count) {
            CAPTURE(pes, count);
            const std::vector<std::uint32_t> rank_of = ranks_of_pes(pes, count);
            CHECK(rank_of.size() == pes);
            CHECK(std::is_sorted(rank_of.begin(), rank_of.end()));
            for (std::uint32_t rank = 0; rank < count; ++rank) {
                const auto own = std::count(rank_of.begin(), rank_of.end(), rank);
                CHECK((own == pes / count || own == pes / count + 1));
            }
        }
}

TEST_CASE("elements of PEs are gathered in the order of the PEs, and scattered back", "[ranks]") {
    on_ranks(3, [](Ranks& ranks) {
        const Distribution pes({2, 0, 1, 0, 2, 2}, ranks);
        const auto count = [](std::uint32_t pe) { return std::size_t{pe} % 3; };  // PE n has n % 3 elements: 10 n + i
        std::vector<std::uint32_t> own, all;
        for (std::uint32_t pe = 0; pe < pes.all(); ++pe)
            for (std::uint32_t i = 0; i < count(pe); ++i) {
                all.push_back(10 * pe + i);
                if (pes.has(pe)) own.push_back(10 * pe + i);
            }
        CHECK(pes.total(count) == all.size());
        CHECK(pes.gather(own, count) == (ranks.is_first() ? all : std::vector<std::uint32_t>{}));
        CHECK(pes.scatter(ranks.is_first() ? all : std::vector<std::uint32_t>{}, count) == own);
        CHECK(pes.all_gather(pes.own(), 1) == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
    });
}

}  // namespace raya
