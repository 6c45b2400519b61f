// Kernels of the neighbour exchange: a PE reads and writes only its own memory. A PE whose memory is the only one on
// the device computes the same. Injected kernel faults are detected.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/job.h"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

enum class Step { kAddNeighbours, kTakeMeans, kMarkContrasts };

struct Launch {
    raya_mapping m{};
    std::uint32_t side = 0, distance = 0, begin = 0, band = 1, capacity = 1;
};

/// The memory of PEs, block after block, followed by a guard block that no PE may read or write.
struct Memory {
    std::vector<float> arrived;       // [PE][3][band]
    std::vector<float> pixels;        // [PE][3][capacity]: pixels or sums
    std::vector<std::uint8_t> marks;  // [PE][capacity]
};

template <class T>
Buffer<T> filled(Session& session, const std::string& name, const std::vector<T>& values) {
    Buffer<T> buffer = session.buffer<T>(name, values.size());
    session.write(name, buffer, values);
    return buffer;
}

/// Returns the memory after the launch of a step on `pes` PEs from `first_pe` on.
Memory run(Kernels& kernels, Step step, const Launch& l, const Memory& before, std::uint32_t first_pe,
           std::size_t pes) {
    Session& session = kernels.session();
    raya_job job{};
    job.mapping = l.m;
    std::vector<std::uint32_t> words(kWordsOf<raya_job>);
    put_record(words, 0, job);
    const Buffer<std::uint32_t> broadcast = filled(session, "job", words);
    const Buffer<float> arrived = filled(session, "arrived", before.arrived);
    Buffer<float> pixels = filled(session, "pixels", before.pixels);
    Buffer<std::uint8_t> marks = filled(session, "marks", before.marks);
    const Uint<"side"> side{l.side};
    const Uint<"distance"> distance{l.distance};
    const Uint<"begin"> begin{l.begin};
    const Uint<"band"> band{l.band};
    const Uint<"capacity"> capacity{l.capacity};
    const Uint<"first_pe"> first{first_pe};
    const std::uint32_t group = kernels.options().group_size;
    if (step == Step::kTakeMeans) {
        auto kernel = kernels.get<TakeMeansKernel>();
        session.launch("step", kernel, pes, group, broadcast, capacity, first, pixels);
    } else if (step == Step::kAddNeighbours) {
        auto kernel = kernels.get<AddNeighboursKernel>();
        session.launch("step", kernel, pes, group, broadcast, side, distance, begin, band, capacity, first, arrived,
                       pixels);
    } else {
        auto kernel = kernels.get<MarkContrastsKernel>();
        session.launch("step", kernel, pes, group, broadcast, side, distance, begin, band, capacity, first, 0.25f,
                       arrived, pixels, marks);
    }
    Memory after = before;
    session.read("pixels", pixels, after.pixels);
    session.read("marks", marks, after.marks);
    return after;
}

/// Returns a random launch as in an exchange. In most cases the arrived block contains neighbours.
Launch random_launch(SplitMix& random) {
    Launch l{.m = small_mapping(random, 9), .side = random_below(random, RAYA_SIDES)};
    const std::vector<std::uint32_t> distances = neighbour_distances(l.m, l.side);
    l.distance = distances.empty() || random.next() % 8 == 0 ? random_below(random, l.m.pes)
                                                             : distances[random_below(random, distances.size())];
    l.capacity = largest_share(l.m);
    l.band = 1 + random_below(random, l.capacity);
    l.begin = l.band * random_below(random, (l.capacity + l.band - 1) / l.band);
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

template <class T>
std::vector<T> block_of(const std::vector<T>& words, std::size_t block, std::size_t size) {
    const auto first = words.begin() + static_cast<std::ptrdiff_t>(block * size);
    return {first, first + static_cast<std::ptrdiff_t>(size)};
}

/// Returns the memory of one PE, followed by a guard block of poison. Words of the arrived block beyond the end of the
/// sender's pixels are poison too.
Memory memory_of(const Launch& l, const Memory& all, std::size_t pe) {
    constexpr float kPoison = std::numeric_limits<float>::quiet_NaN();
    Memory memory{block_of(all.arrived, pe, 3 * l.band), block_of(all.pixels, pe, 3 * l.capacity),
                  block_of(all.marks, pe, l.capacity)};
    const raya_u32 sent = raya_share_size(raya_share_of(l.m, static_cast<raya_u32>((pe + l.distance) % l.m.pes)));
    const std::size_t valid = std::min(l.band, sent - std::min(sent, l.begin));  // number of valid values per colour
    for (std::size_t n = 0; n < memory.arrived.size(); ++n)
        if (n % l.band >= valid) memory.arrived[n] = kPoison;
    memory.arrived.resize(2 * memory.arrived.size(), kPoison);
    memory.pixels.resize(2 * memory.pixels.size(), kPoison);
    memory.marks.resize(2 * memory.marks.size(), 0xa5);
    return memory;
}

/// Returns true if a block of `a` has the same bits as a block of `b`.
bool same_block(const Launch& l, const Memory& a, std::size_t a_block, const Memory& b, std::size_t b_block) {
    const std::size_t pixels = 3 * l.capacity;
    return std::memcmp(&a.pixels[a_block * pixels], &b.pixels[b_block * pixels], 4 * pixels) == 0 &&
           block_of(a.marks, a_block, l.capacity) == block_of(b.marks, b_block, l.capacity);
}

struct Findings {
    int wrong = 0;    // number of launches in which a PE alone computed something else, or a guard block changed
    int changed = 0;  // number of PEs whose block a launch changed; if 0, the test proves nothing
};

Findings find_faults(Kernels& kernels, Step step, std::uint64_t seed, int launches) {
    SplitMix random(seed);
    Findings found;
    for (int i = 0; i < launches; ++i) {
        const Launch l = random_launch(random);
        const Memory before = random_memory(random, l), after = run(kernels, step, l, before, 0, l.m.pes);
        const std::uint32_t pe = random_below(random, l.m.pes);
        const Memory alone = memory_of(l, before, pe), after_alone = run(kernels, step, l, alone, pe, 1);
        found.wrong += !same_block(l, after, pe, after_alone, 0) || !same_block(l, alone, 1, after_alone, 1) ||
                       !same_block(l, before, l.m.pes, after, l.m.pes);
        found.changed += !same_block(l, before, pe, after, pe);
    }
    return found;
}

}  // namespace

TEST_CASE("no PE reads or writes another PE's memory", "[ring][exchange]") {
    constexpr std::uint64_t kSeed = 13;
    Session session(choose_device(""));
    for (const std::uint32_t group : {1u, 3u}) {
        Kernels kernels(session,
                        {.lanes = 1, .group_size = group, .format = parse_format(group == 1 ? "fp32" : "spa22")});
        for (const Step step : {Step::kAddNeighbours, Step::kTakeMeans, Step::kMarkContrasts}) {
            CAPTURE(kSeed, step, group);
            const Findings found = find_faults(kernels, step, kSeed + group, 200);
            CHECK(found.wrong == 0);
            CHECK(found.changed > 50);
        }
    }
}

TEST_CASE("injected accesses to another PE's memory are detected", "[ring][exchange]") {
    struct Fault {
        const char* memory;  // memory that the faulty kernel uses by mistake
        Step step;
        SourcePatch patch;
    };
    const Fault faults[] = {
        {"the block that arrived at the next PE",
         Step::kAddNeighbours,
         {"ring/arrived.clh", "arrived + (size_t)group * band", "arrived + (size_t)((group + 1) % m.pes) * band"}},
        {"memory beyond the end of the sender's share",
         Step::kAddNeighbours,
         {"ring/arrived.clh", "a.sender = raya_share_of(m, a.source)", "a.sender = a.share"}},
        {"memory of one pixel beyond the end of the share",
         Step::kTakeMeans,
         {"ring/filter.cl", "min(capacity, raya_share_size(share))", "raya_share_size(share) + 1"}},
        {"the marks of the next PE",
         Step::kMarkContrasts,
         {"ring/contrast.cl", "marks + (size_t)group * capacity", "marks + (size_t)(group + 1) * capacity"}}};
    constexpr std::uint64_t kSeed = 14;
    Session session(choose_device(""));
    for (const Fault& fault : faults) {
        CAPTURE(kSeed, fault.memory);
        Kernels kernels(session, {.lanes = 1}, {.patches = {fault.patch}});
        CHECK(find_faults(kernels, fault.step, kSeed, 60).wrong > 0);
    }
}
