// Counts of antialiasing: phases, loads, rotations and their words. Neither the counts nor the pixels depend on the
// distribution of the work.
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
struct AntialiasAnswer {
    std::string image, mask;
    std::vector<EventCounts> events;  // of each phase
    std::vector<std::vector<std::uint64_t>> cost;
    std::uint64_t recomputed;
    bool operator==(const AntialiasAnswer&) const = default;
};

AntialiasAnswer antialias_answer(const RingResult& result) {
    AntialiasAnswer answer{pixel_hash(result.image), pixel_hash(result.mask), {}, {}, result.recomputed};
    for (const Phase& phase : result.phases) {
        answer.events.push_back(phase.events);
        answer.cost.push_back(phase.cost().cycles);
    }
    return answer;
}

/// By PE: the sum of the cost image over the PE's pixels.
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
    std::uint64_t all = 0;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) all += cycles[event] * phase.events[event];
    CHECK(phase.load.per_pe == loads_from_costs(phase.cost(), m));
    CHECK(std::accumulate(phase.load.per_pe.begin(), phase.load.per_pe.end(), std::uint64_t{0}) == all);
    CHECK(phase.load.max == *std::max_element(phase.load.per_pe.begin(), phase.load.per_pe.end()));
}

/// Checks that the total `all` is the sum of the phases.
void check_sums(const RingResult& result) {
    EventCounts events{};
    std::vector<std::uint64_t> loads(result.all.load.per_pe.size());
    std::vector<std::uint64_t> cost(result.cost().cycles.size());
    for (const Phase& phase : result.phases) {
        const auto add = [](auto& to, const auto& from) {
            REQUIRE(to.size() == from.size());
            std::transform(to.begin(), to.end(), from.begin(), to.begin(), std::plus<>());
        };
        add(events, phase.events);
        add(loads, phase.load.per_pe);
        add(cost, phase.cost().cycles);
    }
    CHECK(result.all.events == events);
    CHECK(result.all.load.per_pe == loads);
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
    // Pairs of lanes and group size; few, because each pair needs its own kernels.
    using Choices = std::vector<std::array<std::uint32_t, 2>>;
    const std::pair<std::string, Choices> formats[] = {{"fp32", {{1, 1}, {4, 8}, {16, 8}}},
                                                       {"spa22", {{1, 8}, {16, 1}}}};
    Session session(choose_device(""));
    for (const auto& [format, choices] : formats)
        for (const Antialias& antialias : {kFilter, kSupersample}) {
            std::vector<AntialiasAnswer> answers;
            for (const auto& [lanes, group] : choices) {
                const RingCase c{.lanes = lanes, .group = group, .format = format, .antialias = antialias};
                const RingResult result = render_case(session, c);
                answers.push_back(antialias_answer(result));
                CAPTURE(format, antialias_name(antialias.method), lanes, group);
                CHECK(answers.back() == answers.front());
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
    const RingResult one = render_case(session, c);
    const AntialiasAnswer expected = antialias_answer(one);
    CHECK(one.communication.rotations == 0);
    for (const std::uint32_t pes : {1u, 2u, 5u, 15u, 30u, 31u, 60u, 97u, 330u, 659u, 660u}) {
        c.pes = pes;
        c.offset = random_below(random, c.width);
        c.fold = random.next() % 2 ? Fold::kBlock : Fold::kCyclic;
        CAPTURE(kSeed, antialias_name(antialias.method), c.pes, c.offset, c.fold);
        const RingResult result = render_case(session, c);
        CHECK(antialias_answer(result) == expected);
        for (const Phase& phase : result.phases) check_phase(phase, settings_of(c).mapping);
        check_sums(result);
        check_words(result, c);
        CHECK((result.communication.rotations > 0) == (pes > 1));
    }
}

TEST_CASE("phases are named after their passes", "[ring][antialias]") {
    Session session(choose_device(""));
    const auto names = [&](const Antialias& antialias) {
        std::vector<std::string> all;
        for (const Phase& phase : render_case(session, {.antialias = antialias}).phases) all.push_back(phase.name);
        return all;
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
        CHECK(antialias_answer(first) == antialias_answer(second));
        CHECK(first.all.load.per_pe == second.all.load.per_pe);
        CHECK(first.communication.rotations == second.communication.rotations);
        CHECK(first.communication.rotation_words == second.communication.rotation_words);
    }
}

TEST_CASE("with one column of pixels per PE the vertical neighbours are p PEs away", "[ring][antialias]") {
    Session session(choose_device(""));
    // The left and right neighbours take one rotation each, the upper and lower ones p each (none for p = 0, when they
    // are in the PE's own block): 2 + 2 p rotations.
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
    // The last band is shorter than the others if a PE's number of pixels is odd, or if the PE owns fewer pixels than
    // others.
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
        const std::uint32_t share = whole.pe_memory.band_pixels, band = banded.pe_memory.band_pixels;
        CAPTURE(c.width, c.height, c.pes, antialias_name(c.antialias.method), share, band);
        CHECK(share == largest_share(settings_of(c).mapping));
        CHECK(band < share);
        CHECK(banded.pe_memory.bytes() <= 32 * 1024);
        CHECK(antialias_answer(banded) == antialias_answer(whole));
        CHECK(banded.communication.rotations == whole.communication.rotations * ((share + band - 1) / band));
        check_words(banded, c);
        check_words(whole, c);
    }
}

}  // namespace raya
