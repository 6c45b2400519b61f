// Counts of antialiasing: phases, loads, rotations and the words that rotations send. Neither the counts nor the pixels
// depend on the distribution of the work.
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/ring/grid_scene.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/ring/small_mapping.hpp"

namespace raya {
namespace {

constexpr Antialias kFilter{.method = AntialiasMethod::kFilter};
constexpr Antialias kSupersample{.method = AntialiasMethod::kSupersample};

RingResult render_case(Session& session, RingCase c) {
    c.record_costs = true;
    const Scene scene = grid_scene(c.height, c.sampling, 0.8 * c.height);
    return RingRenderer(session, scene, settings_of(c)).render();
}

/// The results that do not depend on PEs, mapping, lanes or group size.
struct AntialiasResults {
    std::string image, mask;
    std::vector<EventCounts> events;               // [phase]
    std::vector<std::vector<std::uint64_t>> cost;  // [phase][pixel]
    std::uint64_t recomputed;
    bool operator==(const AntialiasResults&) const = default;
};

AntialiasResults antialias_results(const RingResult& result) {
    AntialiasResults results{pixel_hash(result.image), pixel_hash(result.mask), {}, {}, result.recomputed};
    for (const Phase& phase : result.phases) {
        results.events.push_back(phase.events);
        results.cost.push_back(phase.cost().cycles);
    }
    return results;
}

/// Returns, for each PE, the sum of the costs of the PE's pixels.
std::vector<std::uint64_t> loads_from_costs(const CostImage& cost, const raya_mapping& m) {
    std::vector<std::uint64_t> loads(m.pes);
    for (std::uint32_t row = 0; row < m.height; ++row)
        for (std::uint32_t column = 0; column < m.width; ++column)
            loads[raya_owner(m, row, column)] += cost.cycles[std::size_t{row} * m.width + column];
    return loads;
}

void check_phase(const Phase& phase, const raya_mapping& m) {
    CAPTURE(phase.name);
    const auto cycles = cycles_of_events();
    std::uint64_t total = 0;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) total += cycles[event] * phase.events[event];
    CHECK(phase.load.per_pe == loads_from_costs(phase.cost(), m));
    CHECK(std::accumulate(phase.load.per_pe.begin(), phase.load.per_pe.end(), std::uint64_t{0}) == total);
    CHECK(phase.load.max == *std::max_element(phase.load.per_pe.begin(), phase.load.per_pe.end()));
}

/// Checks that the totals in `result.all` are the sums over the phases.
void check_sums(const RingResult& result) {
    EventCounts events{};
    std::vector<std::uint64_t> loads(result.load.per_pe.size());
    std::vector<std::uint64_t> cost(result.cost().cycles.size());
    for (const Phase& phase : result.phases) {
        const auto add = [](auto& sums, const auto& values) {
            REQUIRE(sums.size() == values.size());
            std::transform(sums.begin(), sums.end(), values.begin(), sums.begin(), std::plus<>());
        };
        add(events, phase.events);
        add(loads, phase.load.per_pe);
        add(cost, phase.cost().cycles);
    }
    CHECK(result.events == events);
    CHECK(result.load.per_pe == loads);
    CHECK(result.cost().cycles == cost);
}

/// Checks that each rotation sends one block of `band` pixels per PE, with 3 words per pixel.
void check_words(const RingResult& result, const RingCase& c) {
    const Communication& words = result.communication;
    CHECK(words.rotation_words == words.rotations * c.pes * 3 * result.pe_memory.band_pixels);
    CHECK(words.broadcasts == 1);
    CHECK(words.gathers == 1);
    CHECK(words.gather_words == 3ull * c.width * c.height);
}

}  // namespace

TEST_CASE("lanes and group size change no bit, mark or count of anti-aliasing", "[ring][antialias]") {
    // Pairs of lanes and group size. There are few pairs, because each pair needs its own kernels.
    using LanesAndGroups = std::vector<std::array<std::uint32_t, 2>>;
    const std::pair<std::string, LanesAndGroups> formats[] = {{"fp32", {{1, 1}, {4, 8}, {16, 8}}},
                                                              {"spa22", {{1, 8}, {16, 1}}}};
    Session session(choose_device(""));
    for (const auto& [format, pairs] : formats)
        for (const Antialias& antialias : {kFilter, kSupersample}) {
            std::vector<AntialiasResults> results;
            for (const auto& [lanes, group] : pairs) {
                const RingCase c{.lanes = lanes, .group = group, .format = format, .antialias = antialias};
                const RingResult result = render_case(session, c);
                results.push_back(antialias_results(result));
                CAPTURE(format, antialias_name(antialias.method), lanes, group);
                CHECK(results.back() == results.front());
                for (const Phase& phase : result.phases) check_phase(phase, settings_of(c).mapping);
            }
        }
}

TEST_CASE("PEs, offset and fold change no bit, mark or count of anti-aliasing", "[ring][antialias]") {
    constexpr std::uint64_t kSeed = 41;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    const Antialias antialias = GENERATE(kFilter, kSupersample);
    RingCase c{.width = 30, .height = 22, .pes = 1, .offset = 0, .format = "spa22", .antialias = antialias};
    const RingResult on_one_pe = render_case(session, c);
    const AntialiasResults expected = antialias_results(on_one_pe);
    CHECK(on_one_pe.communication.rotations == 0);
    for (const std::uint32_t pes : {1u, 2u, 5u, 15u, 30u, 31u, 60u, 97u, 330u, 659u, 660u}) {
        c.pes = pes;
        c.offset = random_below(random, c.width);
        c.fold = random.next() % 2 ? Fold::kBlock : Fold::kCyclic;
        CAPTURE(kSeed, antialias_name(antialias.method), c.pes, c.offset, c.fold);
        const RingResult result = render_case(session, c);
        CHECK(antialias_results(result) == expected);
        for (const Phase& phase : result.phases) check_phase(phase, settings_of(c).mapping);
        check_sums(result);
        check_words(result, c);
        CHECK((result.communication.rotations > 0) == (pes > 1));
    }
}

TEST_CASE("phases are named after their passes", "[ring][antialias]") {
    Session session(choose_device(""));
    const auto names = [&](const Antialias& antialias) {
        std::vector<std::string> phase_names;
        for (const Phase& phase : render_case(session, {.antialias = antialias}).phases)
            phase_names.push_back(phase.name);
        return phase_names;
    };
    CHECK(names({}) == std::vector<std::string>{"trace"});
    CHECK(names(kFilter) == std::vector<std::string>{"trace"});
    CHECK(names(kSupersample) == std::vector<std::string>{"trace", "supersample"});
}

TEST_CASE("a second anti-aliased render with the same renderer gives the same result", "[ring][antialias]") {
    Session session(choose_device(""));
    for (const Antialias& antialias : {kFilter, kSupersample}) {
        const RingCase c{.antialias = antialias, .record_costs = true};
        RingRenderer renderer(session, grid_scene(c.height, c.sampling, 40), settings_of(c));
        const RingResult first = renderer.render(), second = renderer.render();
        CAPTURE(antialias_name(antialias.method));
        CHECK(antialias_results(first) == antialias_results(second));
        CHECK(first.load.per_pe == second.load.per_pe);
        CHECK(first.communication.rotations == second.communication.rotations);
        CHECK(first.communication.rotation_words == second.communication.rotation_words);
    }
}

TEST_CASE("with one column of pixels per PE, the upper and lower neighbours are p PEs away", "[ring][antialias]") {
    Session session(choose_device(""));
    // The left and right neighbours take one rotation each, the upper and lower neighbours min(p, 256 - p) each. With
    // p = 0 the upper and lower neighbours are in the PE's own block.
    for (const auto& [offset, rotations] : {std::pair{0u, 2u}, {8u, 18u}, {16u, 34u}, {240u, 34u}}) {
        const RingCase c{.width = 256, .height = 256, .pes = 256, .offset = offset, .antialias = kFilter};
        const RingResult result = render_case(session, c);
        CAPTURE(offset);
        CHECK(result.communication.rotations == rotations);
        CHECK(result.pe_memory.band_pixels == 256);
        check_words(result, c);
    }
    const RingCase c{.width = 256, .height = 256, .pes = 256, .offset = 16, .antialias = kSupersample};
    CHECK(render_case(session, c).communication.rotations == 34);
}

TEST_CASE("if a PE's memory is short, pixels rotate in bands, with the same image", "[ring][antialias]") {
    Session session(choose_device(""));
    // The last band of a PE may be shorter than the others: the PE's number of pixels may be odd, or the PE may own
    // fewer pixels than other PEs.
    const RingCase cases[] = {{.width = 512, .height = 512, .pes = 256, .offset = 16, .antialias = kFilter},
                              {.width = 45, .height = 45, .pes = 2, .antialias = kFilter},
                              {.width = 41, .height = 77, .pes = 3, .fold = Fold::kBlock, .antialias = kFilter},
                              {.width = 45, .height = 60, .pes = 2, .antialias = kSupersample},
                              {.width = 640, .height = 64, .pes = 27, .fold = Fold::kBlock, .antialias = kSupersample},
                              {.width = 3, .height = 2600, .pes = 6, .offset = 1, .antialias = kSupersample}};
    for (RingCase c : cases) {
        c.format = "spa22";
        const RingResult whole = render_case(session, c);
        c.machine = "spa";
        const RingResult banded = render_case(session, c);
        const std::uint32_t share_size = whole.pe_memory.band_pixels, band = banded.pe_memory.band_pixels;
        CAPTURE(c.width, c.height, c.pes, antialias_name(c.antialias.method), share_size, band);
        CHECK(share_size == largest_share(settings_of(c).mapping));
        CHECK(band < share_size);
        CHECK(banded.pe_memory.bytes() <= 32 * 1024);
        CHECK(antialias_results(banded) == antialias_results(whole));
        CHECK(banded.communication.rotations == whole.communication.rotations * ((share_size + band - 1) / band));
        check_words(banded, c);
        check_words(whole, c);
    }
}

}  // namespace raya
