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
std::uint64_t launch_bytes(const RingSettings& s, const RingResult& r, const std::string& label) {
    const std::uint64_t words = r.words_local ? r.communication.broadcast_words * s.mapping.pes : 0;
    const std::uint64_t counters = std::uint64_t{s.mapping.pes} * r.group_size * RAYA_EVENTS;
    return launches_of(r, label) * (sizeof(std::uint32_t) * words + 2 * sizeof(std::uint64_t) * counters);
}

KernelWork trace_work(const RingSettings& s, const RingResult& r, const Phase& phase, bool first_pass) {
    const std::uint64_t pixels = std::uint64_t{s.mapping.width} * s.mapping.height;
    KernelWork work = work_of(phase.name, phase.events);
    const std::uint64_t written_bytes = (kColourBytes + sizeof(std::uint64_t)) * (first_pass ? pixels : r.recomputed);
    const std::uint64_t read_bytes = first_pass ? 0 : pixels + kColourBytes * r.recomputed;
    work.bytes = launch_bytes(s, r, phase.name) + written_bytes + read_bytes;
    return work;
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
    for (std::size_t i = 0; i < result.phases.size(); ++i)
        works.push_back(trace_work(settings, result, result.phases[i], i == 0));
    const std::uint64_t width = settings.mapping.width, height = settings.mapping.height;
    // Numbers of pairs of a pixel and its left or right neighbour, and of a pixel and its upper or lower neighbour.
    const std::uint64_t horizontal = 2 * (width - 1) * height, vertical = 2 * width * (height - 1);
    if (settings.antialias.method == AntialiasMethod::kFilter) {
        works.push_back(neighbour_work("filter.sum_rows", horizontal, 1, 3));
        works.push_back(neighbour_work("filter.sum_columns", vertical, 1, 3));
        works.push_back(neighbour_work("filter.take_means", width * height, 1, 2));
    }
    // Operations per component, as in compare_cycles(): 4 to clamp both colours to 0..1, 1 difference, 1 comparison.
    if (settings.antialias.method == AntialiasMethod::kSupersample)
        works.push_back(neighbour_work("supersample.compare", horizontal + vertical, 4 + 1 + 1, 2));
    return works;
}

}  // namespace raya
