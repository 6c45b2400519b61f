// Every offset's imbalance over many pictures of several scenes, beside its lattice.
#pragma once
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "host/study/ensemble.hpp"

namespace raya {

/// One offset of the cyclic mapping, over all pictures.
struct LatticeOffset {
    std::uint32_t p;
    double length;          // of the shortest vector, pixels
    bool blocks;            // see shares_blocks()
    std::vector<double> u;  // of each picture
    Estimate mean = {};     // of u
    double mean_rank = 0;
    std::int64_t wins = 0;  // pictures in which u is lower than the reference's

    double mean_u() const { return mean.mean; }
    double half_width() const { return mean.half_width; }
};
using LatticeOffsets = std::vector<LatticeOffset>;

/// The pictures of one scene: those from `first` to `last` - 1.
struct SceneViews {
    std::string label;
    std::size_t first, last;
    double mean_u(const LatticeOffset& offset) const {
        return std::accumulate(offset.u.begin() + static_cast<std::ptrdiff_t>(first),
                               offset.u.begin() + static_cast<std::ptrdiff_t>(last), 0.0) /
               static_cast<double>(last - first);
    }
};

struct Lattice {
    std::uint32_t side;       // N = P
    std::uint32_t reference;  // the offset nearest to sqrt(P)
    std::vector<SceneViews> scenes;
    LatticeOffsets all;
    LatticeOffsets longer = {}, as_long = {};  // beyond the reference, with a longer vector or one as long

    std::size_t pictures() const { return scenes.back().last; }
    const LatticeOffset& own() const { return all[reference]; }
    const LatticeOffset& best() const { return least(all, &LatticeOffset::mean_u); }
    const LatticeOffset& best_near() const {
        return least(std::span(all).first(reference + 1), &LatticeOffset::mean_u);
    }
    LatticeOffsets some(const std::vector<std::uint32_t>& offsets) const {
        return each(offsets, [&](std::uint32_t p) { return all[p]; });
    }
};

/// `scenes`: square images of one size; one without views stands for itself.
Lattice lattice_of(const std::vector<Ensemble>& scenes);

/// Of the offsets' mean u over another's u, in the same picture; as sure as `tests` such differences need to hold
/// together with 95 %.
Estimate difference(std::span<const LatticeOffset> offsets, const LatticeOffset& other, std::size_t tests = 1);

}  // namespace raya
