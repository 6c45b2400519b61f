// Ring, bus and broadcasts by PEs deliver the same neighbouring pixels, so the results have the same bits. The number
// of moves (rotations, transfers or broadcasts) has a formula for each method.
#include <catch2/catch.hpp>
#include <cstring>

#include "host/ring/bus_and_ring.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/job.h"
#include "tests/ring/grid_scene.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/ring/small_mapping.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

constexpr ExchangeMethod kExchanges[] = {ExchangeMethod::kRing, ExchangeMethod::kBus, ExchangeMethod::kBroadcast};

/// The pixels of all PEs and the size of the bands that the PEs exchange.
struct Shares {
    raya_mapping mapping{};
    std::uint32_t capacity = 1, band = 1;  // maximum numbers of pixels in a PE and in a band
    std::vector<float> pixels;             // [PE][3][capacity]
    float threshold = 0;
};

/// The results of the filter and contrast kernels, and the communication that each of them needs.
struct Smoothed {
    std::vector<float> filtered;
    std::vector<std::uint8_t> marks;
    Communication filter_communication, contrast_communication;
};

Smoothed smooth(Kernels& kernels, const Shares& s, ExchangeMethod method) {
    Session& session = kernels.session();
    raya_job job{};
    job.mapping = s.mapping;
    std::vector<std::uint32_t> words(kWordsOf<raya_job>);
    put_record(words, 0, job);
    const ExchangeSetup setup{.session = session,
                              .broadcast = session.buffer<std::uint32_t>("job", words.size()),
                              .pes = Distribution(s.mapping.pes),
                              .capacity = s.capacity};
    Buffer<std::uint32_t> broadcast = setup.broadcast;
    session.write("job", broadcast, words);
    Buffer<float> pixels = session.buffer<float>("pixels", s.pixels.size());
    session.write("pixels", pixels, s.pixels);
    Smoothed smoothed{s.pixels, std::vector<std::uint8_t>(std::size_t{s.mapping.pes} * s.capacity), {}, {}};
    NeighbourExchange for_contrast(session, smoothed.contrast_communication, s.mapping, s.capacity, s.band, method,
                                   setup.pes);
    RingContrast contrast(kernels, setup, s.threshold);
    contrast.apply(pixels, for_contrast);
    session.read("marks", contrast.marks(), smoothed.marks);
    NeighbourExchange for_filter(session, smoothed.filter_communication, s.mapping, s.capacity, s.band, method,
                                 setup.pes);
    RingFilter(kernels, setup).apply(pixels, for_filter);
    session.read("pixels", pixels, smoothed.filtered);
    return smoothed;
}

Shares random_shares(SplitMix& random, std::uint32_t largest_side) {
    Shares s;
    s.mapping = any_mapping(random, largest_side);
    if (random.next() % 16 == 0) s.mapping = {s.mapping.width, s.mapping.height, 1, 0, RAYA_FOLD_CYCLIC};
    s.capacity = largest_share(s.mapping);
    s.band = 1 + random_below(random, s.capacity);
    s.pixels.resize(3ull * s.mapping.pes * s.capacity);
    for (float& value : s.pixels) value = static_cast<float>(random_below(random, 769)) / 512 - 0.25f;
    s.threshold = 0.125f * static_cast<float>(1 + random_below(random, 6));
    return s;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

std::uint64_t moves_of(const Communication& c) { return c.rotations + c.transfers + c.pe_broadcasts; }

/// Returns the hashes of image and mask and the number of recomputed pixels. Stores the communication in `counted`.
std::string render_hashes(Session& session, RingCase c, ExchangeMethod method, Communication& counted) {
    c.antialias.exchange = method;
    const RingResult result = RingRenderer(session, grid_scene(c.height, c.sampling, 16), settings_of(c)).render();
    counted = result.communication;
    return pixel_hash(result.image) + pixel_hash(result.mask) + std::to_string(result.recomputed);
}

}  // namespace

TEST_CASE("ring, bus and broadcasts give the same bits, and their numbers of moves agree with the formulas",
          "[ring][bus]") {
    constexpr std::uint64_t kSeed = 16;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    Kernels kernels(session, {.lanes = 1, .format = parse_format("e6m15")});
    std::size_t one_pe_cases = 0, narrow_images = 0, cases_with_moves = 0;
    for (unsigned i = 0; i < quick_cases(300, 1500); ++i) {
        const Shares s = random_shares(random, i % 4 == 0 ? 2 : 12);
        const raya_mapping& m = s.mapping;
        CAPTURE(kSeed, i, m.width, m.height, m.pes, mapping_text(m), m.kind, s.capacity, s.band);
        const Smoothed by_ring = smooth(kernels, s, ExchangeMethod::kRing);
        const std::uint64_t bands = (s.capacity + s.band - 1) / s.band;
        for (const ExchangeMethod method : kExchanges) {
            CAPTURE(exchange_name(method));
            const Smoothed by_method = method == ExchangeMethod::kRing ? by_ring : smooth(kernels, s, method);
            CHECK(same_bits(by_method.filtered, by_ring.filtered));
            CHECK(by_method.marks == by_ring.marks);
            CHECK(moves_of(by_method.filter_communication) == bands * sum_of(exchange_moves(m, method, false)));
            CHECK(moves_of(by_method.contrast_communication) == bands * sum_of(exchange_moves(m, method, true)));
        }
        one_pe_cases += m.pes == 1;
        narrow_images += std::min(m.width, m.height) <= 2;
        cases_with_moves += moves_of(by_ring.filter_communication) > 0;
    }
    CHECK((one_pe_cases > 20 && narrow_images > 50 && cases_with_moves > 150));
}

TEST_CASE("a render gives the same image with ring, bus and broadcasts", "[ring][bus]") {
    constexpr std::uint64_t kSeed = 17;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    for (const char* machine : {"grande", "spa"})  // without and with bands
        for (const AntialiasMethod method : {AntialiasMethod::kFilter, AntialiasMethod::kSupersample})
            for (unsigned i = 0; i < quick_cases(2, 20); ++i) {
                const bool large = machine == std::string("spa") && i == 0;
                RingCase c{.width = large ? 45 : 1 + random_below(random, 24),
                           .height = large ? 45 : 1 + random_below(random, 24),
                           .machine = machine,
                           .format = "spa22"};
                c.pes = large ? 2 : 1 + random_below(random, c.width * c.height);
                c.offset = random_below(random, c.width);
                c.antialias.method = method;
                CAPTURE(kSeed, machine, antialias_name(method), i, c.width, c.height, c.pes, c.offset);
                Communication by_ring, by_bus, by_broadcast;
                const std::string image = render_hashes(session, c, ExchangeMethod::kRing, by_ring);
                CHECK(render_hashes(session, c, ExchangeMethod::kBus, by_bus) == image);
                CHECK(render_hashes(session, c, ExchangeMethod::kBroadcast, by_broadcast) == image);
                CHECK((by_ring.transfers == 0 && by_bus.rotations == 0 && by_broadcast.rotations == 0));
                CHECK((by_ring.rotations > 0) == (by_bus.transfers > 0));
                CHECK((by_ring.rotations > 0) == (by_broadcast.pe_broadcasts > 0));
            }
}

}  // namespace raya
