#include "host/torus/launch_plan.hpp"

#include <algorithm>

#include "host/scene/packer.hpp"
#include "kernels/shared/node_counts.h"

namespace raya {
namespace {

constexpr std::uint64_t parts(std::uint64_t all, std::uint64_t part) { return (all + part - 1) / part; }

std::vector<raya_voxel_memory> voxels_of(const raya_node& header, std::span<const std::uint32_t> words) {
    std::vector<raya_voxel_memory> voxels;
    for (std::uint32_t i = 0; i < header.voxels; ++i)
        voxels.push_back(record_at<raya_voxel_memory>(words, header.voxels_at + i * kWordsOf<raya_voxel_memory>));
    return voxels;
}

std::uint64_t objects_of(const raya_objects& o) { return std::uint64_t{o.spheres} + o.planes + o.polygons + o.cones; }

std::uint32_t most_corners(const raya_objects& objects, std::span<const std::uint32_t> words) {
    std::uint32_t most = 0;
    for (std::uint32_t i = 0; i < objects.polygons; ++i)
        most = std::max(most, words[objects.polygons_at + i * RAYA_POLYGON_WORDS + RAYA_POLYGON_CORNERS]);
    return most;
}

// Returns the units of work to generate all primary rays of a node: rows, and batches of their pixels
// (kernels/torus/pixel_rows.clh).
std::uint64_t inject_work_of(const raya_node& header, bool root_injects, std::uint64_t batch) {
    const std::uint64_t width = header.job.mapping.width, height = header.job.mapping.height;
    const auto work = [&](std::uint64_t rows, std::uint64_t columns) { return rows * (1 + parts(columns, batch)); };
    if (root_injects) return header.number == RAYA_ROOT ? work(height, width) : 0;
    const raya_u32* const w = header.window;
    return work(w[1] - w[0], w[3] - w[2]) + work(parts(height, raya_nodes(header.torus)), width);
}

}  // namespace

LaunchPlan::LaunchPlan(const TorusSettings& settings, const NodeMemories& memories, const NodeShare& share,
                       const NodeBuffers& buffers, const KernelOptions& options, const DeviceInfo& device)
    : share_(share),
      buffers_(buffers),
      lanes_(options.lanes),
      group_(options.group_size),
      loop_turns_(device.max_loop_iterations),
      work_per_launch_(settings.work_per_launch),
      exact_(options.exact_divide && device.correctly_rounded_divide_sqrt) {
    const bool root_injects = settings.inject == Injection::kRoot || raya_nodes(settings.torus) == 1;
    for (std::uint32_t slot = 0; slot < share.nodes(); ++slot) {
        const auto words = std::span<const std::uint32_t>(memories.words).subspan(memories.starts[slot]);
        const auto header = record_at<raya_node>(words, 0);
        lights_ = header.job.lights;
        Node node{.voxels = header.voxels, .most = header.job.objects.planes};
        for (const raya_voxel_memory& voxel : voxels_of(header, words)) {
            node.most = std::max(node.most, objects_of(voxel.objects));
            corners_ = std::max(corners_, most_corners(voxel.objects, words));
        }
        node.inject_work = inject_work_of(header, root_injects, std::uint64_t{lanes_} * group_);
        nodes_.push_back(node);
    }
}

void LaunchPlan::clear() {
    for (Node& node : nodes_) node.packets = 0;
}

void LaunchPlan::look(const NodeStatus& status) {
    for (std::uint32_t slot = 0; slot < nodes_.size(); ++slot) {
        const std::uint32_t node = share_.own()[slot];
        std::uint64_t packets = status.at(node, RAYA_STATUS_QUEUE);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            packets +=
                status.at(node, RAYA_STATUS_INBOX + link) +
                std::uint64_t{status.at(raya_link_end(share_.torus(), node, link ^ 1u), RAYA_STATUS_OUTBOX + link)};
        nodes_[slot].packets = std::min<std::uint64_t>(packets, buffers_.queue);
    }
}

LaunchBudget LaunchPlan::budget(const Unit& unit, std::uint64_t most, std::uint64_t all) const {
    // Ray-object tests in about a second: of a launch on two CPU cores, and of a node on one compute unit of a slow
    // GPU.
    constexpr double kTestsOfLaunch = 1e9, kTestsOfNode = 1e8;
    constexpr double kTurnsOfLaunch = 4096;  // loop iterations that do not depend on the work
    constexpr double kMostWork = 1u << 31;
    const auto whole = [&](double work) { return static_cast<std::uint32_t>(std::clamp(work, 1.0, kMostWork)); };
    const double of_launch = unit.of_test * kTestsOfLaunch / lanes_;
    double of_node = unit.of_test * kTestsOfNode / lanes_, beyond = 0;
    if (const double turns = (loop_turns_ - kTurnsOfLaunch) / unit.turns; loop_turns_ > 0 && turns < of_node) {
        of_node = turns;
        beyond = unit.beyond;
    }
    if (work_per_launch_ > 0) of_node = work_per_launch_;
    if (static_cast<double>(most) <= of_node && static_cast<double>(all) <= of_launch) return {whole(of_node), true};
    return {whole(std::min(of_node - beyond, std::max(1.0, of_launch / static_cast<double>(nodes_.size())))), false};
}

LaunchBudget LaunchPlan::inject() {
    std::uint64_t most = 0, all = 0;
    for (Node& node : nodes_) {
        most = std::max(most, node.inject_work);
        all += node.inject_work;
        node.packets = std::max<std::uint64_t>(node.packets, std::max(1u, buffers_.queue / 8));
    }
    return budget({.turns = 32, .of_test = 1.0 / 8}, most, all);
}

// In the worst case the packets of all lanes are in different voxels, which a work-item processes one after another.
std::uint64_t LaunchPlan::trace_work(const Node& node, std::uint64_t packets) const {
    const std::uint64_t batches = parts(packets, lanes_);
    const std::uint64_t steps = std::min(packets, batches * std::min<std::uint64_t>(lanes_, node.voxels + 1));
    return batches + steps * (node.most + RAYA_WORK_OF_PROCESSING(lights_));
}

LaunchBudget LaunchPlan::trace_voxel() const {
    std::uint64_t most = 0, all = 0, of_batch = 0;
    for (const Node& node : nodes_) {
        const std::uint64_t work = trace_work(node, node.packets);
        most = std::max(most, work);
        all += work;
        of_batch = std::max(of_batch, trace_work(node, lanes_));
    }
    // Loop iterations of a ray-object test, measured on llvmpipe with the ring's kernels. A sphere takes iterations of
    // the loops over batches, over hits and over spheres that the filter rejects. Refining quotients and roots takes a
    // few more, and each corner of a polygon three.
    const double turns = (exact_ ? 24 : 32) + 3.0 * corners_;
    return budget({.turns = turns, .beyond = static_cast<double>(group_ * of_batch)}, most, all);
}

constexpr double kTurnsOfMove = 8;  // loop iterations to move one batch of packets

LaunchBudget LaunchPlan::route() const {
    const std::uint64_t batches = parts(buffers_.queue, group_);
    return budget({.turns = kTurnsOfMove}, batches, batches * nodes_.size());
}

LaunchBudget LaunchPlan::accept() const {
    const std::uint64_t of_link = 1 + 2 * parts(buffers_.box, group_), batches = RAYA_LINKS * of_link;
    return budget({.turns = kTurnsOfMove, .beyond = static_cast<double>(of_link)}, batches, batches * nodes_.size());
}

}  // namespace raya
