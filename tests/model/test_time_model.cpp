// Modelled times, compared with times computed by hand and with those of Kohata & Ito (1993).
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/model/budget.hpp"
#include "host/model/time_model.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

/// Returns a load of `max` cycles on one PE and 0 on the others.
Load load_with(std::uint64_t max, std::size_t pes = 256) {
    std::vector<std::uint64_t> per_pe(pes);
    per_pe[pes / 2] = max;
    return load_of(std::move(per_pe));
}

ModelledTime time_of(const std::vector<Load>& phases, const Communication& communication = {}, double factor = 1,
                     const SmoothingCycles& smoothing = {}) {
    const auto time = modelled_time(machine_named("spa"), phases, communication, factor, smoothing);
    REQUIRE(time.has_value());
    return *time;
}

Communication rotations(std::uint64_t count, std::uint64_t words_per_pe, std::uint64_t pes = 256) {
    return {.rotations = count, .rotation_words = count * words_per_pe * pes};
}

}  // namespace

// 768 words at 6 Mword/s take 0.128 ms, and the synchronisation takes 0.1845 ms. The sum is 0.3125 ms = 10 ms / 32.
TEST_CASE("rotations of a column of 256 pixels take the paper's time", "[machine]") {
    CHECK(time_of({load_with(0)}, rotations(1, 768)).communication_ms == Approx(0.3125).epsilon(1e-12));
    CHECK(time_of({load_with(0)}, rotations(34, 768)).communication_ms == Approx(10.625).epsilon(1e-12));
    CHECK(time_of({load_with(0)}, rotations(2, 768)).communication_ms == Approx(0.625).epsilon(1e-12));
    CHECK(time_of({load_with(0)}, rotations(10, 0)).communication_ms == Approx(1.845).epsilon(1e-12));
    // Half as many PEs, each with twice the words.
    CHECK(time_of({load_with(0, 128)}, rotations(34, 1536, 128)).communication_ms ==
          Approx(34 * (0.1845 + 0.256)).epsilon(1e-12));
}

// The bus carries one PE's words at a time: one transfer takes as long as a rotation of all PEs.
TEST_CASE("transfers and broadcasts of PEs are sequential", "[machine]") {
    const auto ms = [](const Communication& c) { return time_of({load_with(0)}, c).communication_ms; };
    CHECK(ms({.transfers = 1, .transfer_words = 768}) == Approx(0.3125).epsilon(1e-12));
    CHECK(ms({.transfers = 1024, .transfer_words = 1024 * 768}) == Approx(320).epsilon(1e-12));
    CHECK(ms({.pe_broadcasts = 256, .pe_broadcast_words = 256 * 768}) == Approx(80).epsilon(1e-12));
    CHECK(ms({.rotations = 2, .rotation_words = 2 * 256 * 768, .transfers = 3, .transfer_words = 600}) ==
          Approx(2 * 0.3125 + 3 * 0.1845 + 0.1).epsilon(1e-12));
}

TEST_CASE("an image of 256 x 256 takes 140 ms to the host, and objects take the same time per word", "[machine]") {
    const ModelledTime time =
        time_of({load_with(0)}, {.broadcasts = 1, .broadcast_words = 1000, .gathers = 1, .gather_words = 196'608});
    CHECK(time.image_ms == Approx(140).epsilon(1e-12));
    CHECK(time.objects_ms == Approx(140 * 1000 / 196'608.0).epsilon(1e-12));
    CHECK(time.communication_ms == 0);
    CHECK(time.compute_ms == 0);
}

// 2,830,000 cycles of 100 ns are 283 ms.
TEST_CASE("the machine waits for the busiest PE of each phase", "[machine]") {
    CHECK(time_of({load_with(2'830'000)}).compute_ms == Approx(283).epsilon(1e-12));
    const std::vector<Load> phases = {load_of({5'000, 30'000, 10'000}), load_of({40'000, 0, 20'000})};
    CHECK(time_of(phases).compute_ms == Approx(7).epsilon(1e-12));  // 3 + 4 ms; no PE computes for more than 4.5 ms
    CHECK(time_of(phases, {}, 2.5).compute_ms == Approx(17.5).epsilon(1e-12));
    CHECK(time_of(phases, {}, 2.5).factor == 2.5);
}

TEST_CASE("smoothing is part of the computing time, and also listed separately", "[machine]") {
    const SmoothingCycles smoothing = {.filter = filter_cycles(256), .compare = compare_cycles(256)};
    const ModelledTime time = time_of({load_with(10'000)}, {}, 2, smoothing);
    CHECK(time.filter_ms == Approx(2 * 256 * 42e-4).epsilon(1e-12));
    CHECK(time.compare_ms == Approx(2 * 256 * 121e-4).epsilon(1e-12));
    CHECK(time.compute_ms == Approx(2 + time.filter_ms + time.compare_ms).epsilon(1e-12));
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
        const double factor = random.uniform(0.5, 3);
        const ModelledTime unscaled = time_of(phases, c, 1, smoothing), time = time_of(phases, c, factor, smoothing);
        CHECK(time.total_ms == time.objects_ms + time.compute_ms + time.communication_ms + time.image_ms);
        CHECK(time.compute_ms == Approx(factor * unscaled.compute_ms).epsilon(1e-12));
        CHECK(time.total_ms - time.compute_ms ==
              Approx(unscaled.total_ms - unscaled.compute_ms).epsilon(1e-9).margin(1e-9));
    }
}

TEST_CASE("a machine with unknown rates has no modelled time", "[machine]") {
    const std::vector<Load> phases = {load_with(1)};
    for (const Machine& machine : machines()) {
        CAPTURE(machine.name);
        const bool known = machine.name == "spa" || machine.name == "spa1" || machine.name == "grande";
        CHECK(modelled_time(machine, phases, {}).has_value() == known);
    }
    using Rate = std::optional<double> Machine::*;
    for (const Rate rate :
         {&Machine::cycle_ns, &Machine::link_words_per_s, &Machine::rotation_sync_ms, &Machine::host_words_per_s}) {
        Machine machine = machine_named("spa");
        machine.*rate = {};
        CHECK_FALSE(modelled_time(machine, phases, {}).has_value());
    }
}

}  // namespace raya
