#include "host/ring/ring_result.hpp"

#include <stdexcept>

namespace raya {
namespace {

constexpr std::uint64_t kColourBytes = 3 * sizeof(float);

std::uint64_t launches_of(const RingResult& result, const std::string& label) {
    std::uint64_t launches = 0;
    for (const LabelSummary& c : result.commands)
        if (c.label == label && c.kind == "kernel") launches += c.launches;
    return launches;
}

// Returns the bytes of all launches with this label, except those of pixels: the job's words, if PEs copy them, and the
// counters, which are read and written.
std::uint64_t launch_bytes(const RingResult& r, const std::string& label) {
    const std::uint64_t words = r.words_local ? r.communication.broadcast_words * r.parts_of_rank : 0;
    const std::uint64_t counters = std::uint64_t{r.parts_of_rank} * r.group_size * RAYA_EVENTS;
    return launches_of(r, label) * (sizeof(std::uint32_t) * words + 2 * sizeof(std::uint64_t) * counters);
}

// `pixels`: number of pixels of this rank.
KernelWork trace_work(const RingResult& r, const Phase& phase, std::uint64_t pixels, bool first_pass) {
    KernelWork work = work_of(phase.name, phase.rank_events);
    const std::uint64_t written_bytes =
        (kColourBytes + sizeof(std::uint64_t)) * (first_pass ? pixels : r.rank_recomputed);
    const std::uint64_t read_bytes = first_pass ? 0 : pixels + kColourBytes * r.rank_recomputed;
    work.bytes = launch_bytes(r, phase.name) + written_bytes + read_bytes;
    return work;
}

// Numbers of this rank's pixels, and of pairs of such a pixel and its left or right neighbour, and of such a pixel and
// its upper or lower neighbour.
struct RankPixels {
    std::uint64_t pixels = 0, horizontal_pairs = 0, vertical_pairs = 0;
};

RankPixels pixels_of_rank(const raya_mapping& m, const RingResult& r) {
    RankPixels own;
    for (std::uint32_t i = 0; i < r.parts_of_rank; ++i) own.pixels += raya_share_size(raya_share_of(m, r.first_pe + i));
    const auto is_own = [&](std::uint32_t row, std::uint32_t column) {
        const std::uint32_t pe = raya_owner(m, row, column);
        return pe >= r.first_pe && pe < r.first_pe + r.parts_of_rank;
    };
    own.horizontal_pairs = own.vertical_pairs = 2 * own.pixels;  // less those of pixels at the image's borders
    for (std::uint32_t row = 0; row < m.height; ++row)
        own.horizontal_pairs -= is_own(row, 0) + is_own(row, m.width - 1);
    for (std::uint32_t column = 0; column < m.width; ++column)
        own.vertical_pairs -= is_own(0, column) + is_own(m.height - 1, column);
    return own;
}

// Returns the work of a kernel that, for each of `pixels` pixels, does `operations` operations on each of three colour
// components and reads or writes `colours` colours.
KernelWork neighbour_work(const std::string& label, std::uint64_t pixels, std::uint64_t operations,
                          std::uint64_t colours) {
    KernelWork work;
    work.label = label;
    work.operations = 3 * operations * pixels;
    work.bytes = colours * kColourBytes * pixels;
    return work;
}

}  // namespace

const CostImage& Phase::cost() const {
    if (!recorded_cost) throw std::logic_error("the costs of pixels were not recorded: set RingSettings::record_costs");
    return *recorded_cost;
}

double trace_seconds(const RingResult& result) {
    double ns = 0;
    for (const LabelSummary& command : result.commands)
        if (command.label == kTracePass || command.label == kSupersamplePass)
            ns += static_cast<double>(command.total_ns);
    return ns > 0 ? ns * 1e-9 : result.render_s;
}

std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result) {
    std::vector<KernelWork> works;
    const RankPixels own = pixels_of_rank(settings.mapping, result);
    for (std::size_t i = 0; i < result.phases.size(); ++i)
        works.push_back(trace_work(result, result.phases[i], own.pixels, i == 0));
    if (settings.antialias.method == AntialiasMethod::kFilter) {
        works.push_back(neighbour_work("filter.sum_rows", own.horizontal_pairs, 1, 3));
        works.push_back(neighbour_work("filter.sum_columns", own.vertical_pairs, 1, 3));
        works.push_back(neighbour_work("filter.take_means", own.pixels, 1, 2));
    }
    // Operations per component, as in compare_cycles(): 4 to clamp both colours to 0..1, 1 difference, 1 comparison.
    if (settings.antialias.method == AntialiasMethod::kSupersample)
        works.push_back(neighbour_work("supersample.compare", own.horizontal_pairs + own.vertical_pairs, 4 + 1 + 1, 2));
    return works;
}

}  // namespace raya
