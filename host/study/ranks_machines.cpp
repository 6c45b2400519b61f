#include "host/study/ranks_machines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "host/ring/exchange_plan.hpp"
#include "host/ring/pe_segment.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/torus_runs.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

constexpr double kPixelBytes = 12, kWordBytes = 4;
constexpr std::uint32_t kOffset = 16;   // of the cyclic mapping, as `raya render` has it
constexpr std::uint32_t kSide = 8;      // nodes
constexpr std::uint32_t kQueue = 1024;  // packets

std::vector<std::uint32_t> powers_of_two(std::uint64_t most) {
    std::vector<std::uint32_t> powers;
    for (std::uint64_t p = 1; p <= most; p *= 2) powers.push_back(static_cast<std::uint32_t>(p));
    return powers;
}

// u of what the ranks have, where each has consecutive PEs.
double imbalance_of_segments(const std::vector<std::uint64_t>& of_pes, std::uint32_t ranks) {
    std::vector<std::uint64_t> of_ranks(ranks);
    const auto pes = static_cast<std::uint32_t>(of_pes.size());
    for (std::uint32_t pe = 0; pe < pes; ++pe) of_ranks[rank_of_pe(pes, ranks, pe)] += of_pes[pe];
    return load_of(std::move(of_ranks)).imbalance;
}

RingPart ring_part(const Costs& costs, std::uint32_t size, std::uint32_t ranks) {
    const std::uint32_t pes = std::max(size, ranks);
    const std::uint32_t offset = ranks > size ? root_offset(pes) : kOffset;
    const raya_mapping mapping = cyclic(size, size, pes, offset % size);
    return {.ranks = ranks,
            .pes = pes,
            .imbalance = imbalance_of_segments(static_load(costs.trace, mapping).per_pe, ranks),
            .rotations = sum_of(exchange_moves(mapping, ExchangeWay::kRing, false)),
            .block_bytes = kPixelBytes * largest_share(mapping),
            .image_bytes = kPixelBytes * size * size,
            .scene_bytes = kWordBytes * static_cast<double>(costs.job_words)};
}

TorusSettings torus_settings(std::uint32_t size) {
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = s.height = size;
    s.torus = make_torus({kSide, kSide, kSide}, Links::kTorus3d);
    s.voxels = {kSide, kSide, kSide};
    s.queue = kQueue;
    s.bounces = s.machine.bounces;
    s.format = s.machine.format;
    return s;
}

// Of each of so many ranks, from one render of the whole machine.
std::vector<TorusPart> torus_parts(Session& session, const Scene& scene, const TorusSettings& settings,
                                   const std::vector<std::uint32_t>& ranks) {
    std::vector<BrickCounter> counters;
    for (const std::uint32_t count : ranks) counters.emplace_back(settings.torus, count);
    const TorusResult result = TorusRenderer(session, scene, settings).render({}, {}, [&](const SuperstepDetail& step) {
        for (BrickCounter& counter : counters) counter.add(step.cycles, step.link_words);
    });
    std::vector<TorusPart> parts;
    for (const BrickCounter& counter : counters) {
        parts.push_back(counter.part());
        parts.back().status_bytes = kWordBytes * double{RAYA_STATUS_WORDS} * raya_nodes(settings.torus);
        parts.back().scene_bytes = kWordBytes * static_cast<double>(result.copied_words);
    }
    return parts;
}

}  // namespace

RankedMachine ring_on_ranks(Laboratory& lab, const LabelledScene& scene, const std::string& file, std::uint32_t size) {
    const Costs& costs = lab.costs(scene, size);
    RankedMachine machine{
        .name = "ring",
        .arguments = {file, "--machine", "grande", "--accel", "none", "--antialias", "filter", "--format",
                      format_name(format_for(scene.scene)), "--size", std::to_string(size)},
        .ranks = powers_of_two(std::min<std::uint64_t>(kMostRanks, std::uint64_t{size} * size)),
        .arrays = {},
        .predict = {},
        .trace_label = "trace"};
    auto parts = std::make_shared<std::vector<RingPart>>();
    for (const std::uint32_t ranks : machine.ranks) {
        parts->push_back(ring_part(costs, size, ranks));
        machine.arrays.push_back(fmt::format("{} PEs", parts->back().pes));
    }
    machine.predict = [parts](std::size_t i, const MeasuredWork& one, const Network& network, double processors) {
        return predict_ring(one, (*parts)[i], network, processors);
    };
    return machine;
}

RankedMachine torus_on_ranks(Session& session, const LabelledScene& scene, const std::string& file,
                             std::uint32_t size) {
    const TorusSettings settings = torus_settings(size);
    const std::string sides = sides_text({kSide, kSide, kSide});
    RankedMachine machine{.name = "torus",
                          .arguments = {file, "--machine", "torus", "--nodes", sides, "--voxels", sides, "--queue",
                                        std::to_string(kQueue), "--size", std::to_string(size)},
                          .ranks = powers_of_two(kMostRanks),
                          .arrays = {},
                          .predict = {},
                          .trace_label = "trace_voxel"};
    const std::uint32_t nodes = raya_nodes(settings.torus);
    auto parts =
        std::make_shared<std::vector<TorusPart>>(torus_parts(session, scene.scene, settings, powers_of_two(nodes)));
    const TorusPart a_node_each = parts->back();
    for (const std::uint32_t ranks : machine.ranks) {
        if (ranks > nodes) parts->push_back(cut_further(a_node_each, ranks / nodes));
        machine.arrays.push_back(ranks > nodes ? sides_text(near_cube(ranks)) + " nodes, assumed" : sides + " nodes");
    }
    machine.predict = [parts](std::size_t i, const MeasuredWork& one, const Network& network, double processors) {
        return predict_torus(one, (*parts)[i], network, processors);
    };
    return machine;
}

MeasuredWork work_of(const RankedMachine& machine, const RankedRender& one) {
    const double trace = one.device_s(machine.trace_label), device = one.device_s();
    return {trace, device - trace, std::max(0.0, one.render_s - device)};
}

}  // namespace raya
