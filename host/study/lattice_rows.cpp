#include "host/study/lattice_rows.hpp"

#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/lattice.hpp"

namespace raya {
namespace {

void add_picture(Lattice& lattice, const CostImage& image) {
    const auto every = each(lattice.all, &LatticeOffset::p);
    const std::vector<double> u = imbalance_of_offsets(image, lattice.side, RAYA_FOLD_CYCLIC, every),
                              ranks = ranks_of(u);
    for (LatticeOffset& offset : lattice.all) {
        offset.u.push_back(u[offset.p]);
        offset.mean_rank += ranks[offset.p];
        offset.wins += u[offset.p] < u[lattice.reference];
    }
}

}  // namespace

Lattice lattice_of(const std::vector<Ensemble>& scenes) {
    const std::uint32_t side = scenes.front().picture->trace.width;
    Lattice lattice{side, root_offset(side), {}, {}};
    for (std::uint32_t p = 0; p < side; ++p)
        lattice.all.push_back({p,
                               std::sqrt(static_cast<double>(shortest_square(p, side))),
                               shares_blocks(p, side, lattice.reference),
                               {}});
    for (const Ensemble& scene : scenes) {
        const std::size_t first = lattice.all[0].u.size();
        if (scene.views.empty()) add_picture(lattice, scene.picture->trace);
        for (const Costs* view : scene.views) add_picture(lattice, view->trace);
        lattice.scenes.push_back({scene.picture->label, first, lattice.all[0].u.size()});
    }
    for (LatticeOffset& offset : lattice.all) {
        offset.mean = estimate_of(offset.u);
        offset.mean_rank /= static_cast<double>(offset.u.size());
    }
    const SpreadOffsets spread = well_spread_offsets(side, lattice.reference);
    lattice.longer = lattice.some(spread.longer);
    lattice.as_long = lattice.some(spread.as_long);
    return lattice;
}

Estimate difference(std::span<const LatticeOffset> offsets, const LatticeOffset& other, std::size_t tests) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < other.u.size(); ++i) {
        double sum = 0;
        for (const LatticeOffset& offset : offsets) sum += offset.u[i];
        differences.push_back(sum / static_cast<double>(offsets.size()) - other.u[i]);
    }
    return estimate_of(differences, each_of(tests));
}

}  // namespace raya
