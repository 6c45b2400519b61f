// Session::observe() records builds; measure_clock_offset() measures the device's clock.
#include <catch2/catch.hpp>

#include "host/cl/commands.hpp"
#include "host/cl/measure.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

constexpr const char* kSource = "kernel void put(global uint* to) { to[get_global_id(0)] = 1; }";

}  // namespace

TEST_CASE("an observed session records builds; the profile has the targets of commands", "[cl]") {
    Session session(choose_device(""));
    SpanLog log;
    session.observe(log);
    auto put = session.build("put.cl", kSource, {}).kernel<Buffer<cl_uint>&>("put");
    Buffer<cl_uint> to = session.buffer<cl_uint>("numbers", 8), target = session.buffer<cl_uint>("others", 8);
    session.launch("go", put, 4, 2, to);
    session.copy("move", to, 0, target, 0, 8);
    const std::vector<CommandRecord>& commands = session.profile().commands();
    REQUIRE(commands.size() == 2);
    CHECK(commands[0].target_name == "put");
    CHECK(commands[0].groups == 4);
    CHECK(commands[0].group_size == 2);
    CHECK(commands[1].target_name == "numbers -> others");
    CHECK(commands[1].groups == 0);
    REQUIRE(log.spans().size() == 1);
    CHECK(log.spans()[0].name == "build put.cl");
}

TEST_CASE("a clock offset maps a command's time to between the host's times before and after the command", "[cl]") {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        SplitMix random(seed);
        const std::uint64_t before = random.next() >> 8, after = before + random.next() % 1000,
                            queued = seed % 3 ? random.next() >> 8 : before + random.next() % (after - before + 1);
        CAPTURE(seed, before, after, queued);
        const ClockOffset offset = clock_offset_of(before, queued, after);
        const auto host = static_cast<std::uint64_t>(static_cast<std::int64_t>(queued) + offset.offset_ns);
        CHECK(before <= host);
        CHECK(host <= after);
        CHECK(offset.same_clock == (before <= queued && queued <= after));
        CHECK((offset.same_clock || 2 * offset.uncertainty_ns >= after - before));
    }
}

TEST_CASE("a command's times lie between the host's times before and after it", "[cl]") {
    Session session(choose_device(""));
    const ClockOffset offset = measure_clock_offset(session);
    CHECK(session.profile().commands().empty());
    Buffer<cl_uint> to = session.buffer<cl_uint>("numbers", 1 << 20);
    const std::uint64_t before = host_clock_ns();
    session.fill("fill", to, 3);
    session.finish();
    const std::uint64_t after = host_clock_ns();
    const CommandRecord& c = session.profile().commands().back();
    const auto host = [&](std::uint64_t ns) { return static_cast<std::int64_t>(ns) + offset.offset_ns; };
    const auto uncertainty = static_cast<std::int64_t>(offset.uncertainty_ns);
    CHECK(host(c.queued) >= static_cast<std::int64_t>(before) - uncertainty);
    CHECK(host(c.ended) <= static_cast<std::int64_t>(after) + uncertainty);
    Session untimed(choose_device(""), Timing::kOff);
    CHECK_THROWS_AS(measure_clock_offset(untimed), std::logic_error);
}

}  // namespace raya
