// Modelled times, compared with times computed by hand and with those of Kohata & Ito (1993).
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/model/budget.hpp"
#include "host/model/t805.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

/// Returns a load of `max` cycles on one PE and 0 on the others.
Load load_with(std::uint64_t max, std::size_t pes = 256) {
    std::vector<std::uint64_t> per_pe(pes);
    per_pe[pes / 2] = max;
    return load_of(std::move(per_pe));
}

ModelledTime time_of(const std::vector<Load>& phases, const Communication& communication = {},
                     const SmoothingCycles& smoothing = {}) {
    return modelled_time(machine_named("spa").clock, phases, communication, smoothing);
}

constexpr double kFactor = 7 / 1.0752;  // filter: 7 ms (Tables 3 and 4); by its budget of 256 x 42 cycles: 1.0752 ms
constexpr double kSetupMs = 1.375;      // 2 ms minus the time of two rotations

Communication rotations(std::uint64_t count, std::uint64_t words_per_pe, std::uint64_t pes = 256) {
    return {.rotations = count, .rotation_words = count * words_per_pe * pes};
}

}  // namespace

// 768 words at 6 Mword/s take 0.128 ms, and the synchronisation takes 0.1845 ms. The sum is 0.3125 ms = 10 ms / 32.
TEST_CASE("exchanges with 2 and 34 rotations of 256 pixels take the 2 and 12 ms of Table 4", "[machine]") {
    const auto ms = [](const Communication& c, std::size_t pes = 256) {
        return time_of({load_with(0, pes)}, c).communication_ms;
    };
    CHECK(ms(rotations(2, 768)) == Approx(2).epsilon(1e-12));
    CHECK(ms(rotations(34, 768)) == Approx(12).epsilon(1e-12));
    CHECK(ms(rotations(10, 0)) == Approx(kSetupMs + 1.845).epsilon(1e-12));
    CHECK(ms({}) == 0);
    // Half as many PEs, each with twice the words.
    CHECK(ms(rotations(34, 1536, 128), 128) == Approx(kSetupMs + 34 * (0.1845 + 0.256)).epsilon(1e-12));
}

// The bus carries one PE's words at a time: one transfer takes as long as a rotation of all PEs.
TEST_CASE("transfers and broadcasts of PEs are sequential", "[machine]") {
    const auto ms = [](const Communication& c) { return time_of({load_with(0)}, c).communication_ms - kSetupMs; };
    CHECK(ms({.transfers = 1, .transfer_words = 768}) == Approx(0.3125).epsilon(1e-12));
    CHECK(ms({.transfers = 1024, .transfer_words = 1024 * 768}) == Approx(320).epsilon(1e-12));
    CHECK(ms({.pe_broadcasts = 256, .pe_broadcast_words = 256 * 768}) == Approx(80).epsilon(1e-12));
    CHECK(ms({.rotations = 2, .rotation_words = 2 * 256 * 768, .transfers = 3, .transfer_words = 600}) ==
          Approx(2 * 0.3125 + 3 * 0.1845 + 0.1).epsilon(1e-12));
}

TEST_CASE("an image of 256 x 256 takes 140 ms to the host and 1,130 ms to the screen, as in Table 2", "[machine]") {
    const ModelledTime time =
        time_of({load_with(0)}, {.broadcasts = 1, .broadcast_words = 1000, .gathers = 1, .gather_words = 196'608});
    CHECK(time.image_ms == Approx(140).epsilon(1e-12));
    CHECK(time_of({load_with(0, 1)}, {.gathers = 26, .gather_words = 196'608}).image_ms == time.image_ms);  // one PE
    CHECK(time.display_ms == Approx(1130).epsilon(1e-12));
    CHECK(time.objects_ms == Approx(kSetupMs + (140 - kSetupMs) * 1000 / 196'608).epsilon(1e-12));
    CHECK(time.communication_ms == 0);
    CHECK(time.compute_ms == 0);
}

TEST_CASE("in each phase the machine waits for the busiest PE of the phase", "[machine]") {
    CHECK(time_of({load_with(2'830'000)}).compute_ms == Approx(kFactor * 283).epsilon(1e-12));
    const std::vector<Load> phases = {load_of({5'000, 30'000, 10'000}), load_of({40'000, 0, 20'000})};
    CHECK(time_of(phases).compute_ms == Approx(kFactor * 7).epsilon(1e-12));  // 3 + 4 ms; sum of PE 0: 4.5 ms
    CHECK(time_of(phases).factor == Approx(kFactor).epsilon(1e-12));
}

TEST_CASE("filtering a column takes the 7 ms of Tables 3 and 4, and is part of the computing time", "[machine]") {
    const SmoothingCycles smoothing = {.filter = filter_cycles(256), .compare = compare_cycles(256)};
    const ModelledTime time = time_of({load_with(10'000)}, {}, smoothing);
    CHECK(time.filter_ms == Approx(7).epsilon(1e-12));
    CHECK(time.compare_ms == Approx(kFactor * 256 * 121e-4).epsilon(1e-12));
    CHECK(time.compute_ms == Approx(kFactor + time.filter_ms + time.compare_ms).epsilon(1e-12));
}

TEST_CASE("the parts add up to the total, and the factor scales only computing", "[machine]") {
    constexpr std::uint64_t kSeed = 9;
    SplitMix random(kSeed);
    const auto below = [&](std::uint64_t limit) { return random.next() % limit; };
    for (int i = 0; i < 500; ++i) {
        CAPTURE(kSeed, i);
        const Communication c = {1, below(100'000), below(100), 256 * below(100'000), 1, below(1'000'000)};
        const std::vector<Load> phases(1 + below(3), load_with(below(100'000'000)));
        const SmoothingCycles smoothing = {below(100'000), below(100'000)};
        MachineClock scaled = machine_named("spa").clock;
        const double ratio = random.uniform(0.5, 3);
        scaled.cycle_factor *= ratio;
        const ModelledTime time = time_of(phases, c, smoothing),
                           scaled_time = modelled_time(scaled, phases, c, smoothing);
        for (const ModelledTime& t : {time, scaled_time})
            CHECK(t.total_ms == t.objects_ms + t.compute_ms + t.communication_ms + t.image_ms + t.display_ms);
        CHECK(scaled_time.compute_ms == Approx(ratio * time.compute_ms).epsilon(1e-12));
        CHECK(scaled_time.total_ms - scaled_time.compute_ms ==
              Approx(time.total_ms - time.compute_ms).epsilon(1e-9).margin(1e-9));
    }
}

TEST_CASE("machines whose PEs hold the frame buffer take no time to transfer and display the image", "[machine]") {
    const Communication c = {.broadcasts = 1, .broadcast_words = 500, .gathers = 1, .gather_words = 196'608};
    for (const char* name : {"cap", "pixel-machine", "links"}) {
        CAPTURE(name);
        const ModelledTime time = modelled_time(machine_named(name).clock, std::vector<Load>{load_with(1'000)}, c);
        CHECK(time.image_ms == 0);
        CHECK(time.display_ms == 0);
        CHECK(time.total_ms == time.objects_ms + time.compute_ms);
    }
    CHECK(modelled_time(machine_named("cap").clock, std::vector<Load>{load_with(0)}, c).objects_ms ==
          Approx(1).epsilon(1e-12));  // 500 words of 4 bytes over a bus of 2 MB/s
}

}  // namespace raya
