#include "host/ring/schedule.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "kernels/shared/share_pixels.h"

namespace raya {
namespace {

void check_image(const CostImage& image, std::uint32_t pes) {
    const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
    if (pixels == 0 || image.cycles.size() != pixels)
        throw std::invalid_argument("a cost image must have at least one pixel, and one cost for each pixel");
    if (pes < 1 || pes > pixels) throw std::invalid_argument("the number of PEs must be 1..W * H");
}

void check_mapping(const CostImage& image, const raya_mapping& mapping) {
    check_image(image, mapping.pes);
    if (mapping.width != image.width || mapping.height != image.height)
        throw std::invalid_argument("the mapping has another size than the cost image");
}

/// Returns the owner of each slot, [row][slot]. `without_offset` must have an offset of 0, so that columns are slots.
std::vector<std::uint32_t> owners_of_slots(const raya_mapping& without_offset) {
    std::vector<std::uint32_t> owners;
    owners.reserve(std::size_t{without_offset.width} * without_offset.height);
    for (std::uint32_t row = 0; row < without_offset.height; ++row)
        for (std::uint32_t slot = 0; slot < without_offset.width; ++slot)
            owners.push_back(raya_owner(without_offset, row, slot));
    return owners;
}

/// Adds the PEs' loads under the cyclic mapping with `offset` to `per_pe`. `owners`: [row][slot].
void add_loads_of_offset(const CostImage& image, const std::vector<std::uint32_t>& owners, std::uint32_t offset,
                         std::vector<std::uint64_t>& per_pe) {
    const std::uint64_t* costs = image.cycles.data();
    const std::uint32_t* owner = owners.data();
    std::uint64_t first = 0;  // column of slot 0 in this row: (row x offset) mod W
    for (std::uint32_t row = 0; row < image.height; ++row) {
        for (std::uint64_t column = first; column < image.width; ++column) per_pe[*owner++] += costs[column];
        for (std::uint64_t column = 0; column < first; ++column) per_pe[*owner++] += costs[column];
        costs += image.width;
        first += offset;
        if (first >= image.width) first -= image.width;
    }
}

/// Adds the cost of each PE's static part to `busy`: the first `fraction` of its pixels, which are not scheduled
/// dynamically. Returns a flag for each pixel of the image: true if the pixel is in a static part.
std::vector<bool> add_static_costs(const CostImage& image, const raya_mapping& static_mapping, double fraction,
                                   std::vector<std::uint64_t>& busy) {
    std::vector<bool> done(image.cycles.size());
    if (fraction == 0) return done;
    for (std::uint32_t pe = 0; pe < static_mapping.pes; ++pe) {
        const raya_share share = raya_share_of(static_mapping, pe);
        const auto pixels = static_cast<std::uint32_t>(fraction * raya_share_size(share));
        for (std::uint32_t k = 0; k < pixels; ++k) {
            const raya_pixel pixel = raya_pixel_of(static_mapping, share, k);
            const std::size_t at = std::size_t{pixel.row} * image.width + pixel.column;
            busy[pe] += image.cycles[at];
            done[at] = true;
        }
    }
    return done;
}

/// Divides the pixels that are not done into chunks of `chunk` pixels, and returns the cost of each chunk without
/// overhead.
std::vector<std::uint64_t> chunk_costs(const CostImage& image, const std::vector<bool>& done, std::uint32_t chunk) {
    std::vector<std::uint64_t> chunks;
    std::uint32_t free_pixels = 0;  // number of pixels that the last chunk can still take
    for (std::size_t at = 0; at < done.size(); ++at) {
        if (done[at]) continue;
        if (free_pixels == 0) {
            chunks.push_back(0);
            free_pixels = chunk;
        }
        chunks.back() += image.cycles[at];
        --free_pixels;
    }
    return chunks;
}

/// Assigns each chunk to the PE that becomes idle first. The root answers one request after another. `finish`:
/// finishing time of each PE, in and out.
void assign_chunks(const std::vector<std::uint64_t>& chunks, const DynamicPlan& plan,
                   std::vector<std::uint64_t>& finish) {
    using IdleTime = std::pair<std::uint64_t, std::uint32_t>;  // time at which a PE becomes idle, PE number
    std::vector<IdleTime> idle_times;
    idle_times.reserve(finish.size());
    for (std::uint32_t pe = 0; pe < finish.size(); ++pe) idle_times.emplace_back(finish[pe], pe);
    std::priority_queue<IdleTime, std::vector<IdleTime>, std::greater<>> idle(std::greater<>{}, std::move(idle_times));
    std::uint64_t answered = 0;  // time at which the root has answered the previous request
    for (const std::uint64_t cost : chunks) {
        const auto [time, pe] = idle.top();
        idle.pop();
        answered = std::max(answered, time) + plan.root_cycles;
        finish[pe] = (plan.root_cycles > 0 ? answered : time) + plan.overhead + cost;
        idle.emplace(finish[pe], pe);
    }
}

}  // namespace

std::string dynamic_text(const DynamicPlan& plan) {
    const std::string root = plan.root_cycles > 0 ? fmt::format(",{}", plan.root_cycles) : "";
    if (plan.static_fraction > 0)
        return fmt::format("hybrid:{},{},{}{}", plan.chunk, plan.overhead, plan.static_fraction, root);
    return plan.overhead > 0 || plan.root_cycles > 0 ? fmt::format("dynamic:{},{}{}", plan.chunk, plan.overhead, root)
                                                     : fmt::format("dynamic:{}", plan.chunk);
}

Load static_load(const CostImage& image, const raya_mapping& mapping) {
    check_mapping(image, mapping);
    std::vector<std::uint64_t> per_pe(mapping.pes);
    std::size_t at = 0;
    for (std::uint32_t row = 0; row < image.height; ++row)
        for (std::uint32_t column = 0; column < image.width; ++column)
            per_pe[raya_owner(mapping, row, column)] += image.cycles[at++];
    return load_of(std::move(per_pe));
}

std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets) {
    check_image(image, pes);
    if (fold != RAYA_FOLD_CYCLIC && fold != RAYA_FOLD_BLOCK)
        throw std::invalid_argument(
            "`fold` must be RAYA_FOLD_CYCLIC or RAYA_FOLD_BLOCK: only cyclic mappings have an offset");
    const auto owners = owners_of_slots({image.width, image.height, pes, 0, fold});
    std::vector<double> imbalances;
    std::vector<std::uint64_t> per_pe;
    for (const std::uint32_t offset : offsets) {
        if (offset >= image.width) throw std::invalid_argument("an offset must be 0..W-1");
        per_pe.assign(pes, 0);
        add_loads_of_offset(image, owners, offset, per_pe);
        Load load = load_of(std::move(per_pe));
        imbalances.push_back(load.imbalance);
        per_pe = std::move(load.per_pe);  // reuses the memory for the next offset
    }
    return imbalances;
}

Schedule dynamic_schedule(const CostImage& image, const raya_mapping& static_mapping, const DynamicPlan& plan) {
    check_mapping(image, static_mapping);
    if (!is_valid_plan(plan))
        throw std::invalid_argument("a plan's chunk, overhead, static fraction or root cycles are out of range");
    std::vector<std::uint64_t> finish(static_mapping.pes);
    const auto done = add_static_costs(image, static_mapping, plan.static_fraction, finish);
    const auto chunks = chunk_costs(image, done, plan.chunk);
    assign_chunks(chunks, plan, finish);
    Schedule schedule{load_of(std::move(finish)), chunks.size()};
    Load& load = schedule.load;
    if (load.max > 0) load.speedup = static_cast<double>(total_cycles(image)) / static_cast<double>(load.max);
    load.efficiency = load.speedup / static_mapping.pes;
    return schedule;
}

std::uint64_t total_cycles(const CostImage& image) {
    return std::accumulate(image.cycles.begin(), image.cycles.end(), std::uint64_t{0});
}

std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes) {
    check_image(image, pes);
    const std::uint64_t total = total_cycles(image);
    const std::uint64_t mean_load = total / pes + (total % pes != 0);  // rounded up
    return std::max(mean_load, *std::max_element(image.cycles.begin(), image.cycles.end()));
}

}  // namespace raya
