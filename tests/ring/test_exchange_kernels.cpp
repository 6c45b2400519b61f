// Kernels of the neighbour exchange: a PE reads and writes only its own memory, so poison values in the memory of all
// other PEs change no result. Injected kernel faults are detected.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "host/ring/mapping.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/job.h"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

enum class Step { kAddNeighbours, kTakeMeans, kMarkContrasts };
constexpr Step kSteps[] = {Step::kAddNeighbours, Step::kTakeMeans, Step::kMarkContrasts};

const char* step_name(Step step) {
    return step == Step::kAddNeighbours ? "add_neighbours" : step == Step::kTakeMeans ? "take_means" : "mark_contrasts";
}

struct Launch {
    raya_mapping m{};
    std::uint32_t side = 0, distance = 0, begin = 0, band = 1, capacity = 1;
    float threshold = 0;
};

/// The memory of all PEs, block after block, followed by a guard block that no PE may read or write.
struct Memory {
    std::vector<float> arrived;       // [PE][3][band]
    std::vector<float> pixels;        // [PE][3][capacity]: pixels or sums
    std::vector<std::uint8_t> marks;  // [PE][capacity]
};

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b, std::size_t begin, std::size_t end) {
    return begin == end || std::memcmp(a.data() + begin, b.data() + begin, (end - begin) * sizeof(T)) == 0;
}

/// Returns true if the memories a and b have the same bits in the blocks `first` to `end` - 1.
bool same_blocks(const Launch& l, const Memory& a, const Memory& b, std::size_t first, std::size_t end) {
    const std::size_t band = 3 * l.band, block = 3 * l.capacity;
    return same_bits(a.arrived, b.arrived, first * band, end * band) &&
           same_bits(a.pixels, b.pixels, first * block, end * block) &&
           same_bits(a.marks, b.marks, first * l.capacity, end * l.capacity);
}

/// Runs the kernel of an exchange step, optionally with an injected fault.
class Runner {
  public:
    Runner(Session& session, Step step, std::uint32_t group, const std::string& format,
           const KernelSources& sources = {})
        : session_(session),
          step_(step),
          group_(group),
          kernels_(session, {.lanes = 1, .group_size = group, .format = parse_format(format)}, sources) {}

    /// Returns the memory after the first `groups` PEs have run.
    Memory run(const Launch& l, const Memory& before, std::size_t groups) {
        if (groups == 0) return before;
        raya_job job{};
        job.mapping = l.m;
        std::vector<std::uint32_t> words(kWordsOf<raya_job>);
        put_record(words, 0, job);
        const Buffer<std::uint32_t> broadcast = filled("job", words);
        const Buffer<float> arrived = filled("arrived", before.arrived);
        Buffer<float> pixels = filled("pixels", before.pixels);
        Buffer<std::uint8_t> marks = filled("marks", before.marks);
        launch(l, groups, broadcast, arrived, pixels, marks);
        Memory after = before;
        session_.read("arrived", arrived, after.arrived);
        session_.read("pixels", pixels, after.pixels);
        session_.read("marks", marks, after.marks);
        return after;
    }

  private:
    using Words = const Buffer<std::uint32_t>&;
    using Floats = const Buffer<float>&;

    template <class T>
    Buffer<T> filled(const std::string& name, const std::vector<T>& values) {
        Buffer<T> buffer = session_.buffer<T>(name, values.size());
        session_.write(name, buffer, values);
        return buffer;
    }

    void launch(const Launch& l, std::size_t groups, Words job, Floats arrived, Buffer<float>& pixels,
                Buffer<std::uint8_t>& marks) {
        const std::string name = step_name(step_);
        const Uint<"side"> side{l.side};
        const Uint<"distance"> distance{l.distance};
        const Uint<"begin"> begin{l.begin};
        const Uint<"band"> band{l.band};
        const Uint<"capacity"> capacity{l.capacity};
        const Uint<"first_pe"> first{0};
        if (step_ == Step::kTakeMeans) {
            auto kernel = kernels_.get<TakeMeansKernel>();
            session_.launch(name, kernel, groups, group_, job, capacity, first, pixels);
        } else if (step_ == Step::kAddNeighbours) {
            auto kernel = kernels_.get<AddNeighboursKernel>();
            session_.launch(name, kernel, groups, group_, job, side, distance, begin, band, capacity, first, arrived,
                            pixels);
        } else {
            auto kernel = kernels_.get<MarkContrastsKernel>();
            session_.launch(name, kernel, groups, group_, job, side, distance, begin, band, capacity, first,
                            l.threshold, arrived, pixels, marks);
        }
    }

    Session& session_;
    Step step_;
    std::uint32_t group_;
    Kernels kernels_;
};

/// Returns a random launch as in an exchange. In most cases the arrived block contains neighbours.
Launch random_launch(SplitMix& random) {
    Launch l{.m = small_mapping(random, 9), .side = random_below(random, RAYA_SIDES)};
    const std::vector<std::uint32_t> distances = neighbour_distances(l.m, l.side);
    l.distance = distances.empty() || random.next() % 8 == 0 ? random_below(random, l.m.pes)
                                                             : distances[random_below(random, distances.size())];
    l.capacity = largest_share(l.m);
    l.band = 1 + random_below(random, l.capacity);
    l.begin = l.band * random_below(random, (l.capacity + l.band - 1) / l.band);
    l.threshold = 0.125f * static_cast<float>(1 + random_below(random, 6));
    return l;
}

/// Returns memory with random colours from -0.25 to 1.25. Each pixel is marked with probability 1/8.
Memory random_memory(SplitMix& random, const Launch& l) {
    const auto colours = [&](std::size_t count) {
        std::vector<float> words(count);
        for (float& word : words) word = static_cast<float>(static_cast<int>(random.next() % 769) - 128) / 512;
        return words;
    };
    const std::size_t blocks = std::size_t{l.m.pes} + 1;
    Memory memory{colours(blocks * l.band * 3), colours(blocks * l.capacity * 3), {}};
    for (std::size_t n = 0; n < blocks * l.capacity; ++n) memory.marks.push_back(random.next() % 8 == 0);
    return memory;
}

/// Returns a copy of `clean` in which all memory that the PE must not read contains poison. The PE may read its own
/// memory except the stale pixels of the arrived block, which lie beyond the end of the sender's pixels.
Memory poisoned(SplitMix& random, const Launch& l, const Memory& clean, std::size_t pe) {
    const float poison = random.next() % 2 ? std::numeric_limits<float>::quiet_NaN() : 1e30f;
    Memory memory = clean;
    const raya_u32 sent = raya_share_size(raya_share_of(l.m, static_cast<raya_u32>((pe + l.distance) % l.m.pes)));
    const std::size_t valid = std::min(l.band, sent - std::min(sent, l.begin));  // number of valid values per colour
    const std::size_t band = 3 * l.band, block = 3 * l.capacity;
    for (std::size_t n = 0; n < memory.arrived.size(); ++n)
        if (n / band != pe || n % l.band >= valid) memory.arrived[n] = poison;
    for (std::size_t n = 0; n < memory.pixels.size(); ++n)
        if (n / block != pe) memory.pixels[n] = poison;
    for (std::size_t n = 0; n < memory.marks.size(); ++n)
        if (n / l.capacity != pe) memory.marks[n] = 0xa5;
    return memory;
}

struct Findings {
    int poison_read = 0;     // number of PEs whose result depends on another PE's memory or on stale words
    int stray_writes = 0;    // number of launches in which a PE wrote outside its own block
    int blocks_changed = 0;  // number of PEs whose block a launch changed; if 0, the test proves nothing
};

Findings find_faults(Runner& runner, std::uint64_t seed, int launches) {
    SplitMix random(seed);
    Findings found;
    for (int i = 0; i < launches; ++i) {
        const Launch l = random_launch(random);
        const Memory before = random_memory(random, l), after = runner.run(l, before, l.m.pes);
        for (int choice = 0; choice < 2; ++choice) {
            const std::size_t pe = random_below(random, l.m.pes);
            const Memory seen = runner.run(l, poisoned(random, l, before, pe), l.m.pes);
            Memory expected = after;  // except the arrived block, which contains poison
            const auto at = static_cast<std::ptrdiff_t>(3 * pe * l.band);
            std::copy_n(seen.arrived.begin() + at, 3 * l.band, expected.arrived.begin() + at);
            found.poison_read += !same_blocks(l, expected, seen, pe, pe + 1);
            found.blocks_changed += !same_blocks(l, before, after, pe, pe + 1);
        }
        // Memory after a run of `groups` - 1 PEs and of `groups` PEs may differ only in the block of the last PE.
        const std::size_t groups = 1 + random_below(random, l.m.pes);
        const Memory fewer_run = runner.run(l, before, groups - 1), all_run = runner.run(l, before, groups);
        found.stray_writes += !same_blocks(l, fewer_run, all_run, 0, groups - 1) ||
                              !same_blocks(l, fewer_run, all_run, groups, std::size_t{l.m.pes} + 1);
    }
    return found;
}

struct Fault {
    const char* memory;  // memory that the faulty kernel uses by mistake
    Step step;
    SourcePatch patch;
    bool reads;   // the fault must be detected by Findings::poison_read
    bool writes;  // the fault must be detected by Findings::stray_writes
};

const Fault kFaults[] = {
    {"the block that arrived at the next PE",
     Step::kAddNeighbours,
     {"ring/arrived.clh", "arrived + (size_t)group * band", "arrived + (size_t)((group + 1) % m.pes) * band"},
     true,
     false},
    {"memory beyond the end of the band",
     Step::kAddNeighbours,
     {"ring/arrived.clh", " && n - a->begin < a->band", ""},
     true,
     false},
    {"memory beyond the end of the sender's share",
     Step::kAddNeighbours,
     {"ring/arrived.clh", "a.sender = raya_share_of(m, a.source)", "a.sender = a.share"},
     true,
     false},
    {"the sums of the next PE",
     Step::kAddNeighbours,
     {"ring/filter.cl",
      "(size_t)group * capacity * 3;\n    const uint end = min(capacity, raya_share_size(block.share)",
      "(size_t)(group + 1) * capacity * 3;\n    const uint end = min(capacity, raya_share_size(block.share)"},
     false,
     true},
    {"the sums of the next PE",
     Step::kTakeMeans,
     {"ring/filter.cl", "(size_t)group * capacity * 3;\n    const uint end = min(capacity, raya_share_size(share)",
      "(size_t)(group + 1) * capacity * 3;\n    const uint end = min(capacity, raya_share_size(share)"},
     false,
     true},
    {"the sums of the first PE",
     Step::kTakeMeans,
     {"ring/filter.cl", "num_div(own_sums[i * capacity + k], pixels)", "num_div(sums[i * capacity + k], pixels)"},
     true,
     false},
    {"memory of one pixel beyond the end of the share",
     Step::kTakeMeans,
     {"ring/filter.cl", "min(capacity, raya_share_size(share))", "raya_share_size(share) + 1"},
     false,
     true},
    {"the pixels of the next PE",
     Step::kMarkContrasts,
     {"ring/contrast.cl", "pixels + (size_t)group * capacity",
      "pixels + (size_t)((group + 1) % block.mapping.pes) * capacity"},
     true,
     false},
    {"the marks of the next PE",
     Step::kMarkContrasts,
     {"ring/contrast.cl", "marks + (size_t)group * capacity", "marks + (size_t)(group + 1) * capacity"},
     false,
     true},
};

}  // namespace

TEST_CASE("no PE reads or writes another PE's memory", "[ring][exchange]") {
    constexpr std::uint64_t kSeed = 13;
    Session session(choose_device(""));
    for (const Step step : kSteps)
        for (const std::uint32_t group : {1u, 3u}) {
            const std::string format =
                group == 1 ? "fp32" : "e6m15";  // one format per group size: builds take most of the time
            CAPTURE(kSeed, step_name(step), group, format);
            Runner runner(session, step, group, format);
            const Findings found = find_faults(runner, kSeed + group, 100);
            CHECK(found.poison_read == 0);
            CHECK(found.stray_writes == 0);
            CHECK(found.blocks_changed > 50);
        }
}

TEST_CASE("injected accesses to another PE's memory are detected", "[ring][exchange]") {
    constexpr std::uint64_t kSeed = 14;
    Session session(choose_device(""));
    for (const Fault& fault : kFaults) {
        CAPTURE(kSeed, fault.memory, step_name(fault.step));
        Runner runner(session, fault.step, 1, "fp32", {.patches = {fault.patch}});
        const Findings found = find_faults(runner, kSeed, 40);
        if (fault.reads) CHECK(found.poison_read > 0);
        if (fault.writes) CHECK(found.stray_writes > 0);
    }
}
