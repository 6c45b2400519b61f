#include "host/study/speedups.hpp"

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;

// The loads of a PE for each slot, as an image of one row: with no more PEs than slots every PE has whole ones.
CostImage slots_of(const CostImage& image, std::uint32_t offset) {
    return {image.width, 1, static_load(image, cyclic(image.width, image.height, image.width, offset)).per_pe};
}

double speedup_of(const CostImage& slots, std::uint32_t pes, Fold fold) {
    return static_load(slots, cyclic(slots.width, 1, pes, 0, fold)).speedup;
}

}  // namespace

SpeedupRows speedups_of(const CostImage& image) {
    const std::uint32_t w = image.width;
    const CostImage columns = slots_of(image, 0), shifted = slots_of(image, kOffset % w);
    CostImage root;
    SpeedupRows rows;
    for (std::uint32_t pes = 1; pes <= w; ++pes) {
        const std::uint32_t a = root_offset(pes);
        if (pes == 1 || a != root_offset(pes - 1)) root = slots_of(image, a);
        rows.push_back({pes, speedup_of(columns, pes, Fold::kCyclic), speedup_of(columns, pes, Fold::kBlock),
                        speedup_of(shifted, pes, Fold::kCyclic), speedup_of(shifted, pes, Fold::kBlock),
                        speedup_of(root, pes, Fold::kCyclic), speedup_of(root, pes, Fold::kBlock),
                        a * a == pes ? static_load(image, squarest_grid(w, image.height, pes)).speedup : 0});
    }
    return rows;
}

std::vector<SpeedupMeans> means_of(const std::vector<SpeedupRows>& pictures) {
    std::vector<SpeedupMeans> means;
    for (const Speedups& row : pictures.front()) {
        const auto of = [&](double Speedups::*figure) {
            return mean_of_each(pictures, [&](const SpeedupRows& rows) { return on(rows, row.pes).*figure; });
        };
        means.push_back({row.pes, of(&Speedups::columns), of(&Speedups::cyclic), of(&Speedups::root)});
    }
    return means;
}

std::vector<SizedSpeedup> speedups_of_sizes(const std::vector<const CostImage*>& images) {
    std::vector<SizedSpeedup> all;
    for (const CostImage* image : images)
        for (std::uint32_t pes = 1; pes <= image->width; pes *= 2) {
            const auto speedup = [&](std::uint32_t p) {
                return static_load(*image, cyclic(image->width, image->height, pes, p % image->width)).speedup;
            };
            all.push_back({image->width, pes, speedup(0), speedup(kOffset), speedup(root_offset(pes))});
        }
    return all;
}

}  // namespace raya
