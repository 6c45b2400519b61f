// The T805's time model: cycles of events and messages counted by hand, and links with traffic in both directions.
#include <catch2/catch.hpp>
#include <cstdint>

#include "host/model/budget.hpp"
#include "host/model/t805.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

// Cycles of arithmetic operations: addition 10, multiplication 15, division 20, square root 123. Each includes 4 cycles
// for its operand.
std::uint32_t arithmetic(std::uint32_t additions, std::uint32_t multiplications, std::uint32_t divisions = 0,
                         std::uint32_t roots = 0) {
    return 10 * additions + 15 * multiplications + 20 * divisions + 123 * roots;
}

// Cycles of control operations: 8 for a move, 6 for a branch, 4 for each word of a packet that is created.
std::uint32_t control(std::uint32_t moves, std::uint32_t branches, std::uint32_t packet_words = 0) {
    return 8 * moves + 6 * branches + 4 * packet_words;
}

}  // namespace

// The budgets count a sum of n products as n multiply-accumulates. The T805 needs n multiplications and n - 1
// additions, or n additions if another term is added.
TEST_CASE("additions and multiplications on a T805 agree with the budgets' multiply-accumulates", "[machine]") {
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
        CAPTURE(event);
        const Budget& budget = budgets()[event];
        CHECK(budget.multiplications <= budget.multiply_accumulates);
        CHECK(budget.additions <= budget.multiply_accumulates);
        CHECK(budget.additions + budget.multiplications >= budget.multiply_accumulates);
        CHECK((t805_cycles()[event] == 0) == (event == RAYA_PRIMARY_HITS));
    }
}

TEST_CASE("cycles of each event on a T805 agree with those counted by hand", "[machine]") {
    const auto cycles = t805_cycles();
    // 9 products; additions: 3 differences, 2 for b, 3 for l, 3 for the discriminant; one branch.
    CHECK(cycles[RAYA_SPHERE_TESTS] == arithmetic(11, 9) + control(0, 1));
    // n.D: 3 products, 2 additions; d - n.O: 3 products, 3 additions; a comparison; a division; two branches.
    CHECK(cycles[RAYA_PLANE_TESTS] == arithmetic(6, 6, 1) + control(0, 2));
    CHECK(cycles[RAYA_POLYGON_TESTS] == arithmetic(26 + 2, 12 + 0, 0) + control(2, 5));
    CHECK(cycles[RAYA_SHADOW] == arithmetic(7, 9, 1, 1) + control(4, 5, 16));
    CHECK(cycles[RAYA_PRIMARY] == arithmetic(8, 12, 1, 1) + control(16, 3, 16));
    CHECK(cycles[RAYA_REFLECTED] == arithmetic(0, 1) + control(10, 2, 16));
    CHECK(cycles[RAYA_REFRACTED] == arithmetic(13, 23, 2, 2) + control(18, 4, 16));
    CHECK(cycles[RAYA_SHADED] == arithmetic(30, 31, 1, 2) + control(2, 10, 8));
    CHECK(cycles[RAYA_LIT] == arithmetic(7, 15) + control(0, 2, 8));
    CHECK(cycles[RAYA_STEPS] == arithmetic(6, 2) + control(2, 4));
    CHECK(cycles[RAYA_WALKS] == arithmetic(25, 18, 3) + control(6, 4));
    CHECK(cycles[RAYA_DISCARDED] == arithmetic(8 + 25, 12 + 18, 1 + 3, 1) + control(2 + 6 + 6, 1 + 4 + 1));
}

// Creating a ray packet of 30 words instead of 16 takes 14 more stores. If each ray has one return of 6 words, this
// return takes two stores less than a return of 8 words, and RAYA_LIT creates no return.
TEST_CASE("an event that creates a packet includes the stores of the words that are assumed for it", "[machine]") {
    const auto default_cycles = t805_cycles(), long_packet_cycles = t805_cycles({30, true});
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
        CAPTURE(event);
        const bool makes_ray =
            event == RAYA_PRIMARY || event == RAYA_REFLECTED || event == RAYA_REFRACTED || event == RAYA_SHADOW;
        const int extra_cycles = makes_ray ? 14 * 4 : event == RAYA_SHADED ? -2 * 4 : event == RAYA_LIT ? -8 * 4 : 0;
        CHECK(static_cast<int>(long_packet_cycles[event]) - static_cast<int>(default_cycles[event]) == extra_cycles);
    }
    CHECK(PacketCharge{}.return_words() == RAYA_RETURN_WORDS);
}

// A link carries 425,000 words per second in one direction, 600,000 in both directions together.
TEST_CASE("a link carries both directions at the shared rate until the traffic in one of them ends", "[machine]") {
    CHECK(t805_link_ms(425, 0) == Approx(1).epsilon(1e-12));
    CHECK(t805_link_ms(0, 425) == Approx(1).epsilon(1e-12));
    CHECK(t805_link_ms(300, 300) == Approx(1).epsilon(1e-12));
    CHECK(t805_link_ms(300 + 425, 300) == Approx(2).epsilon(1e-12));
    CHECK(t805_link_ms(0, 0) == 0);
    constexpr std::uint64_t kSeed = 17;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        CAPTURE(kSeed, i);
        const std::uint64_t forward = random.next() >> (24 + random.next() % 40),
                            backward = random.next() >> (24 + i % 40);
        const double time = t805_link_ms(forward, backward), larger = static_cast<double>(std::max(forward, backward));
        CHECK(time == t805_link_ms(backward, forward));
        // The time lies between the times that the larger amount takes at the full rate and at the shared rate.
        CHECK(time >= larger / 425 * (1 - 1e-12));
        CHECK(time <= larger / 300 * (1 + 1e-12));
    }
}

}  // namespace raya
