#include "host/torus/launch_plan.hpp"

#include <algorithm>

#include "host/scene/packer.hpp"
#include "kernels/shared/node_counts.h"

namespace raya {
namespace {

constexpr std::uint64_t divide_up(std::uint64_t count, std::uint64_t divisor) {
    return (count + divisor - 1) / divisor;
}

std::vector<raya_voxel_memory> voxels_of(const raya_node& header, std::span<const std::uint32_t> words) {
    std::vector<raya_voxel_memory> voxels;
    for (std::uint32_t i = 0; i < header.voxels; ++i)
        voxels.push_back(record_at<raya_voxel_memory>(words, header.voxels_at + i * kWordsOf<raya_voxel_memory>));
    return voxels;
}

std::uint64_t objects_of(const raya_objects& o) { return std::uint64_t{o.spheres} + o.planes + o.polygons + o.cones; }

std::uint32_t max_corners(const raya_objects& objects, std::span<const std::uint32_t> words) {
    std::uint32_t corners = 0;
    for (std::uint32_t i = 0; i < objects.polygons; ++i)
        corners = std::max(corners, words[objects.polygons_at + i * RAYA_POLYGON_WORDS + RAYA_POLYGON_CORNERS]);
    return corners;
}

// Returns the work that the generation of all primary rays of a node takes: the number of rows plus the number of
// batches of their pixels (kernels/torus/pixel_rows.clh).
std::uint64_t inject_work_of(const raya_node& header, bool root_injects, std::uint64_t batch) {
    const std::uint64_t width = header.job.mapping.width, height = header.job.mapping.height;
    const auto work = [&](std::uint64_t rows, std::uint64_t columns) { return rows * (1 + divide_up(columns, batch)); };
    if (root_injects) return header.number == RAYA_ROOT ? work(height, width) : 0;
    const raya_u32* const w = header.window;
    return work(w[1] - w[0], w[3] - w[2]) + work(divide_up(height, raya_nodes(header.torus)), width);
}

}  // namespace

LaunchPlan::LaunchPlan(const TorusSettings& settings, const NodeMemories& memories,
                       const NodeDistribution& distribution, const NodeBuffers& buffers, const KernelOptions& options,
                       const DeviceInfo& device)
    : distribution_(distribution),
      buffers_(buffers),
      lanes_(options.lanes),
      group_size_(options.group_size),
      max_loop_iterations_(device.max_loop_iterations),
      work_per_launch_(settings.work_per_launch),
      rounds_correctly_(options.exact_divide && device.correctly_rounded_divide_sqrt) {
    const bool root_injects = settings.inject == Injection::kRoot || raya_nodes(settings.torus) == 1;
    for (std::uint32_t slot = 0; slot < distribution.nodes(); ++slot) {
        const auto words = std::span<const std::uint32_t>(memories.words).subspan(memories.starts[slot]);
        const auto header = record_at<raya_node>(words, 0);
        lights_ = header.job.lights;
        Node node{.voxels = header.voxels, .max_objects = header.job.objects.planes};
        for (const raya_voxel_memory& voxel : voxels_of(header, words)) {
            node.max_objects = std::max(node.max_objects, objects_of(voxel.objects));
            max_corners_ = std::max(max_corners_, max_corners(voxel.objects, words));
        }
        node.inject_work = inject_work_of(header, root_injects, std::uint64_t{lanes_} * group_size_);
        nodes_.push_back(node);
    }
}

void LaunchPlan::clear() {
    for (Node& node : nodes_) node.packets = 0;
}

void LaunchPlan::update(const NodeStatus& status) {
    for (std::uint32_t slot = 0; slot < nodes_.size(); ++slot) {
        const std::uint32_t node = distribution_.own_nodes()[slot];
        std::uint64_t packets = status.at(node, RAYA_STATUS_QUEUE);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            packets += status.at(node, RAYA_STATUS_INBOX + link) +
                       std::uint64_t{
                           status.at(raya_link_end(distribution_.torus(), node, link ^ 1u), RAYA_STATUS_OUTBOX + link)};
        nodes_[slot].packets = std::min<std::uint64_t>(packets, buffers_.queue);
    }
}

LaunchBudget LaunchPlan::budget(const WorkUnit& unit, std::uint64_t max_work, std::uint64_t total_work) const {
    // Numbers of ray-object tests that take about a second: in a launch on two CPU cores, and in a node on one compute
    // unit of a slow GPU.
    constexpr double kTestsOfLaunch = 1e9, kTestsOfNode = 1e8;
    constexpr double kFixedIterations = 4096;  // number of loop iterations that do not depend on the work
    constexpr double kMaxWork = 1u << 31;
    const auto whole_units = [&](double work) { return static_cast<std::uint32_t>(std::clamp(work, 1.0, kMaxWork)); };
    const double launch_limit = unit.units_per_test * kTestsOfLaunch / lanes_;
    double node_limit = unit.units_per_test * kTestsOfNode / lanes_, overrun_units = 0;
    if (const double units = (max_loop_iterations_ - kFixedIterations) / unit.iterations;
        max_loop_iterations_ > 0 && units < node_limit) {
        node_limit = units;
        overrun_units = unit.overrun_units;
    }
    if (work_per_launch_ > 0) node_limit = work_per_launch_;
    if (static_cast<double>(max_work) <= node_limit && static_cast<double>(total_work) <= launch_limit)
        return {whole_units(node_limit), true};
    const double equal_part = std::max(1.0, launch_limit / static_cast<double>(nodes_.size()));
    return {whole_units(std::min(node_limit - overrun_units, equal_part)), false};
}

LaunchBudget LaunchPlan::inject() {
    std::uint64_t max_work = 0, total_work = 0;
    for (Node& node : nodes_) {
        max_work = std::max(max_work, node.inject_work);
        total_work += node.inject_work;
        node.packets = std::max<std::uint64_t>(node.packets, std::max(1u, buffers_.queue / 8));
    }
    return budget({.iterations = 32, .units_per_test = 1.0 / 8}, max_work, total_work);
}

// Returns an upper bound of the work of a node with `packets` packets. In the worst case the packets of all lanes are
// in different voxels; a work-item processes such packets one after another.
std::uint64_t LaunchPlan::trace_work(const Node& node, std::uint64_t packets) const {
    const std::uint64_t batches = divide_up(packets, lanes_);
    const std::uint64_t steps = std::min(packets, batches * std::min<std::uint64_t>(lanes_, node.voxels + 1));
    return batches + steps * (node.max_objects + RAYA_WORK_OF_PROCESSING(lights_));
}

LaunchBudget LaunchPlan::trace_voxel() const {
    std::uint64_t max_work = 0, total_work = 0, batch_work = 0;
    for (const Node& node : nodes_) {
        const std::uint64_t work = trace_work(node, node.packets);
        max_work = std::max(max_work, work);
        total_work += work;
        batch_work = std::max(batch_work, trace_work(node, lanes_));
    }
    // Number of loop iterations of a ray-object test, measured on llvmpipe with the ring's kernels. A sphere test takes
    // iterations of the loops over batches, over hits and over spheres that the filter rejects. The refinement of
    // quotients and square roots takes 8 more iterations, and each corner of a polygon takes 3.
    const double iterations = (rounds_correctly_ ? 24 : 32) + 3.0 * max_corners_;
    return budget({.iterations = iterations, .overrun_units = static_cast<double>(group_size_ * batch_work)}, max_work,
                  total_work);
}

constexpr double kIterationsOfMove = 8;  // number of loop iterations that one batch of packets takes

LaunchBudget LaunchPlan::route() const {
    const std::uint64_t batches = divide_up(buffers_.queue, group_size_);
    return budget({.iterations = kIterationsOfMove}, batches, batches * nodes_.size());
}

LaunchBudget LaunchPlan::accept() const {
    const std::uint64_t link_batches = 1 + 2 * divide_up(buffers_.box, group_size_);
    const std::uint64_t batches = RAYA_LINKS * link_batches;
    return budget({.iterations = kIterationsOfMove, .overrun_units = static_cast<double>(link_batches)}, batches,
                  batches * nodes_.size());
}

}  // namespace raya
