// Labelled commands, their range checks and their profile. Without an OpenCL device these tests fail.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/error.hpp"
#include "host/scene/split_mix.hpp"
#include "host/verify/verify.hpp"

using namespace raya;
using Catch::Contains;

namespace {

constexpr std::size_t kMaxSize = std::numeric_limits<std::size_t>::max();

const std::string kSource = "kernel void add(global uint* a, const uint b) { a[get_global_id(0)] += b; }";

std::vector<cl_uint> consecutive_numbers(std::size_t count, cl_uint first) {
    std::vector<cl_uint> words(count);
    std::iota(words.begin(), words.end(), first);
    return words;
}

std::vector<cl_uint> contents(Session& session, const Buffer<cl_uint>& buffer) {
    std::vector<cl_uint> words(buffer.size());
    session.read("contents", buffer, words);
    return words;
}

}  // namespace

TEST_CASE("block copies move their elements and change no others", "[cl]") {
    constexpr std::uint64_t kSeed = 1;
    SplitMix random(kSeed);
    const auto random_below = [&](std::size_t end) { return std::size_t(random.next() % end); };
    Session session(choose_device(""));
    for (int i = 0; i < 300; ++i) {
        const std::size_t blocks = 1 + random_below(20), count = 1 + random_below(30);
        const auto place = [&] {
            const std::size_t offset = random_below(5);
            return Session::Blocks{offset, offset + count + random_below(5), random_below(3)};
        };
        const BlockCopy copy{place(), place(), count, blocks};
        CAPTURE(kSeed, i, blocks, count, copy.from.offset, copy.from.pitch, copy.to.offset, copy.to.pitch);
        session.clear_profile();
        const Verdict verdict = check_copies(session, {copy});
        INFO(verdict.result << verdict.fault.where);
        CHECK(verdict.outcome == Outcome::kPass);
        std::uint64_t bytes = 0;
        for (const CommandRecord& command : session.profile().commands())
            if (command.kind == "copy") bytes += command.bytes;
        CHECK(bytes == count * blocks * sizeof(cl_uint));
    }
}

TEST_CASE("block copies beyond a block or a buffer are refused before any command", "[cl]") {
    Session session(choose_device(""));
    Buffer<cl_uint> a = session.buffer<cl_uint>("a", 12), b = session.buffer<cl_uint>("b", 20);
    const auto copy = [&](Session::Blocks source, Session::Blocks target, std::size_t count, std::size_t blocks) {
        session.copy_blocks("c", a, source, b, target, count, blocks);
    };
    CHECK_THROWS_AS(copy({1, 4}, {0, 5}, 4, 3), std::out_of_range);  // reaches into the source's next block
    CHECK_THROWS_AS(copy({0, 4}, {2, 5}, 4, 3), std::out_of_range);  // reaches into the target's next block
    CHECK_THROWS_AS(copy({5, 4}, {0, 5}, 0, 3), std::out_of_range);
    CHECK_THROWS_AS(copy({0, 4}, {0, 5}, 4, 4), std::out_of_range);  // more blocks than the source has
    CHECK_THROWS_AS(copy({0, 2}, {0, 5}, 2, 5), std::out_of_range);  // more blocks than the target has
    CHECK_THROWS_AS(copy({0, 4}, {kMaxSize, 5}, 4, 3), std::out_of_range);
    CHECK_THROWS_AS(copy({2, 4}, {0, 5}, kMaxSize, 3), std::out_of_range);
    CHECK_THROWS_WITH(session.copy_blocks("band", a, {1, 4}, b, {0, 5}, 4, 3), Contains("'band'") && Contains("'a'"));
    CHECK_THROWS_WITH(session.copy_blocks("band", a, {0, 4}, b, {2, 5}, 4, 3), Contains("'band'") && Contains("'b'"));
    // pitch x blocks beyond 2^64
    CHECK_THROWS_AS(session.copy_blocks("band", a, {0, std::size_t{1} << 63}, b, {0, 5}, 1, 2), std::out_of_range);
    copy({4, 4}, {0, 5}, 0, 3);  // blocks of no elements
    copy({0, 4}, {0, 5}, 4, 0);  // no blocks
    CHECK(session.profile().commands().empty());
}

TEST_CASE("ranges beyond a buffer are refused before any command", "[cl]") {
    Session session(choose_device(""));
    Buffer<cl_uint> buffer = session.buffer<cl_uint>("words", 4);
    std::vector<cl_uint> words(4), more(5);
    CHECK_THROWS_AS(session.read("r", buffer, more), std::out_of_range);
    CHECK_THROWS_AS(session.read("r", buffer, words, 1), std::out_of_range);
    CHECK_THROWS_AS(session.read("r", buffer, words, kMaxSize), std::out_of_range);  // offset + count overflows
    CHECK_THROWS_AS(session.write("w", buffer, words, 4), std::out_of_range);
    CHECK_THROWS_AS(session.copy("c", buffer, 0, buffer, 3, 2), std::out_of_range);
    CHECK_THROWS_AS(session.copy("c", buffer, 1, buffer, 0, kMaxSize), std::out_of_range);
    CHECK_THROWS_WITH(session.read("gather", buffer, words, 1),
                      Contains("'gather'") && Contains("'words' of 4") && Contains("4 elements from element 1"));
    session.read("nothing", buffer, {}, 4);
    CHECK(session.profile().commands().empty());
}

TEST_CASE("overlapping copies are refused with label and buffers", "[cl]") {
    Session session(choose_device(""));
    Buffer<cl_uint> buffer = session.buffer<cl_uint>("words", 8);
    CHECK_THROWS_WITH(session.copy("slide", buffer, 0, buffer, 1, 4),
                      Contains("'slide'") && Contains("'words'") && Contains("CL_MEM_COPY_OVERLAP"));
}

TEST_CASE("buffers of no or too many elements are refused", "[cl]") {
    const Session session(choose_device(""));
    CHECK_THROWS_AS(session.buffer<float>("empty", 0), std::invalid_argument);
    const std::uint64_t max_bytes = session.device().max_allocation_bytes;
    const std::size_t count = std::size_t(max_bytes / sizeof(float)) + 1;
    CHECK_THROWS_AS(session.buffer<float>("huge", count), DeviceError);
    CHECK_THROWS_WITH(session.buffer<float>("huge", count), Contains("'huge'") && Contains(std::to_string(max_bytes)) &&
                                                                Contains(std::to_string(count * sizeof(float))));
    CHECK_THROWS_AS(session.buffer<double>("endless", kMaxSize), DeviceError);  // its size in bytes overflows
}

TEST_CASE("a large buffer of host elements is stored once, unless the device has memory of its own", "[cl]") {
    const std::vector<cl_uint> large = consecutive_numbers((64u << 20) / sizeof(cl_uint), 7);
    Session session(choose_device(""));
    for (const std::size_t missing : {0u, 1u}) {  // one element less is not large
        CAPTURE(missing);
        const std::span<const cl_uint> host = std::span(large).first(large.size() - missing);
        Buffer<cl_uint> buffer = session.buffer_of("words", host);
        Buffer<cl_uint> copy = session.buffer<cl_uint>("copy", host.size());
        session.write("write", buffer, host);
        session.copy("copy", buffer, 0, copy, 0, host.size());
        CHECK(std::ranges::equal(contents(session, copy), host));
        const bool shared = buffer.memory().getInfo<CL_MEM_FLAGS>() & CL_MEM_USE_HOST_PTR;
        CHECK(shared == (!session.device().separate_memory && missing == 0));
    }
}

TEST_CASE("the profile contains every command in order, with increasing times", "[cl]") {
    Session session(choose_device(""));
    auto add = session.build("add", kSource, {}).kernel<Buffer<cl_uint>&, cl_uint>("add");
    Buffer<cl_uint> a = session.buffer<cl_uint>("a", 64), b = session.buffer<cl_uint>("b", 64);
    session.write("load", a, consecutive_numbers(64, 0));
    for (cl_uint i = 0; i < 5; ++i) session.launch("add", add, 8, 8, a, i);
    session.copy("move", a, 0, b, 0, 64);
    session.launch("add", add, 4, 16, b, 1U);
    session.copy("load", a, 0, b, 0, 1);  // one label, two kinds of command
    CHECK(contents(session, b)[1] == 1 + 0 + 1 + 2 + 3 + 4 + 1);

    const Profile& profile = session.profile();
    REQUIRE(profile.timed());
    std::vector<std::string> order;
    std::uint64_t last_queued = 0;
    for (const CommandRecord& command : profile.commands()) {
        order.push_back(command.label);
        CAPTURE(order, command.kind);
        CHECK(command.queued >= last_queued);
        CHECK(command.queued > 0);
        CHECK(command.queued <= command.submitted);
        CHECK(command.submitted <= command.started);
        CHECK(command.started <= command.ended);
        last_queued = command.queued;
    }
    CHECK(order ==
          std::vector<std::string>{"load", "add", "add", "add", "add", "add", "move", "add", "load", "contents"});
    CHECK(profile.commands()[0].bytes == 256);
    CHECK(profile.commands()[1].bytes == 0);
    CHECK(profile.commands()[8].bytes == 4);

    std::vector<std::string> lines;
    for (const LabelSummary& line : profile.summary()) {
        lines.push_back(line.label + "/" + line.kind + "/" + std::to_string(line.launches));
    }
    CHECK(lines ==
          std::vector<std::string>{"load/write/1", "add/kernel/6", "move/copy/1", "load/copy/1", "contents/read/1"});
    session.clear_profile();
    CHECK(session.profile().commands().empty());
}

TEST_CASE("a summary has count, total, minimum, mean and maximum of each label", "[cl]") {
    Profile profile(true);
    profile.add({"a", "kernel", 1, 2, 10, 40, 0});
    profile.add({"b", "read", 1, 2, 50, 51, 8});
    profile.add({"a", "kernel", 1, 2, 60, 70, 0});
    const std::vector<LabelSummary> lines = profile.summary();
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].label == "a");
    CHECK(lines[0].launches == 2);
    CHECK(lines[0].total_ns == 40);
    CHECK(lines[0].min_ns == 10);
    CHECK(lines[0].mean_ns == 20.0);
    CHECK(lines[0].max_ns == 30);
    CHECK(lines[1].total_ns == 1);
    CHECK(lines[1].min_ns == 1);
}

TEST_CASE("without timing commands work and their times are zero", "[cl]") {
    Session session(choose_device(""), Timing::kOff);
    Buffer<cl_uint> buffer = session.buffer<cl_uint>("words", 4);
    session.fill("fill", buffer, 5);
    CHECK(contents(session, buffer) == std::vector<cl_uint>(4, 5));
    CHECK_FALSE(session.profile().timed());
    REQUIRE(session.profile().commands().size() == 2);
    CHECK(session.profile().commands()[0].ended == 0);
    CHECK(session.profile().summary()[0].launches == 1);
    CHECK(session.profile().summary()[0].total_ns == 0);
}

TEST_CASE("writes and reads of any size move the bytes in order; asynchronous reads too, despite later writes",
          "[cl]") {
    constexpr std::uint64_t kSeed = 20261124;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    constexpr std::size_t kWords = 1 << 15;  // 128 KB: writes of up to 64 KB are copied
    Buffer<cl_uint> buffer = session.buffer<cl_uint>("words", kWords);
    Readback<cl_uint> readback(4 * kWords);
    std::vector<cl_uint> device_words(kWords), expected;
    session.write("write", buffer, device_words);
    while (expected.size() < readback.size()) {
        const std::size_t count = random.next() % 16 ? 1 + random.next() % 200 : kWords - random.next() % 2,
                          offset = random.next() % (kWords - count + 1);
        std::vector<cl_uint> words = consecutive_numbers(count, static_cast<cl_uint>(random.next()));
        session.write("write", buffer, words, offset);
        std::ranges::copy(words, device_words.begin() + static_cast<std::ptrdiff_t>(offset));
        std::ranges::fill(words, 0xdeadbeef);  // the transfer may still be running
        const std::size_t read_count = std::min(1 + random.next() % 300, readback.size() - expected.size()),
                          first = random.next() % (kWords - read_count + 1);
        const auto part = std::span(device_words).subspan(first, read_count);
        session.read("read", buffer, first, readback, expected.size(), read_count);
        expected.insert(expected.end(), part.begin(), part.end());
        if (random.next() % 8 != 0) continue;
        std::vector<cl_uint> read_words(read_count);
        session.read("read", buffer, read_words, first);
        CHECK(std::ranges::equal(read_words, part));
    }
    session.wait("read", readback);
    CAPTURE(kSeed);
    CHECK(std::ranges::equal(readback.first(readback.size()), expected));
    CHECK_THROWS_AS(session.read("read", buffer, 0, readback, readback.size(), 1), std::out_of_range);
    CHECK_THROWS_AS(session.read("read", buffer, kWords, readback, 0, 1), std::out_of_range);
}

TEST_CASE("thousands of commands without a wait are all recorded", "[cl]") {
    Session session(choose_device(""));
    Buffer<cl_uint> buffer = session.buffer<cl_uint>("words", 1);
    for (cl_uint i = 0; i < 5000; ++i) session.fill("fill", buffer, i);
    CHECK(contents(session, buffer)[0] == 4999);
    CHECK(session.profile().commands().size() == 5001);
}

TEST_CASE("an invalid launch is refused with label, kernel and error", "[cl]") {
    Session session(choose_device(""));
    auto add = session.build("add", kSource, {}).kernel<Buffer<cl_uint>&, cl_uint>("add");
    Buffer<cl_uint> a = session.buffer<cl_uint>("a", 1);
    CHECK_THROWS_AS(session.launch("empty", add, 0, 8, a, 1U), std::invalid_argument);
    CHECK_THROWS_AS(session.launch("empty", add, 8, 0, a, 1U), std::invalid_argument);
    const std::size_t too_wide = session.device().max_group_size * 2;
    CHECK_THROWS_WITH(session.launch("wide", add, 1, too_wide, a, 1U),
                      Contains("'wide'") && Contains("'add'") && Contains("groups of 1..") && Contains("remedy"));
}

TEST_CASE("a buffer of the host's elements waits for all commands when it is destroyed", "[cl]") {
    std::vector<cl_uint> host((64u << 20) / sizeof(cl_uint), 7);
    Session session(choose_device(""));
    auto late = session
                    .build("late",
                           "kernel void late(global const uint* from, global uint* to, const uint n) {\n"
                           "    uint x = 1;\n"
                           "    for (uint i = 0; i < n; ++i) x = x * 1664525U + 1013904223U;\n"
                           "    to[0] = from[x & 3U];\n"
                           "}\n",
                           {})
                    .kernel<Buffer<cl_uint>&, Buffer<cl_uint>&, cl_uint>("late");
    Buffer<cl_uint> result = session.buffer<cl_uint>("result", 1);
    {
        const std::span<const cl_uint> all(host);
        Buffer<cl_uint> words = session.buffer_of("words", all);
        session.write("write", words, all);
        session.launch("late", late, 1, 1, words, result, 1u << 26);
        session.flush();
    }
    std::fill_n(host.begin(), 4, 9u);
    CHECK(contents(session, result)[0] == 7);
}
