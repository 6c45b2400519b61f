// What the explorer says of one setting, as numbers and as it is printed. Its script (assets/model.js) computes the
// same from the same costs; tests hold one to the other.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/model/machine.hpp"
#include "host/model/time_model.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/lattice.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// The shortest vector of the lattice that the pixels of each PE make: of slots with the cyclic fold where P divides W,
/// whose rows repeat after P columns; of a grid and of scan lines in turn. Empty where they make none.
std::optional<LatticeVector> shortest_vector_of(const raya_mapping& mapping);

struct ExplorerFigures {
    Load load;                              // modelled cycles of each PE
    std::uint32_t busiest = 0, idlest = 0;  // PEs, of several the first
    std::uint32_t share = 0;                // pixels of the PE that owns most
    std::optional<LatticeVector> vector;
    // What brings every PE its neighbours for the 3 x 3 filter, in whole shares: one of the three.
    std::uint64_t rotations = 0;       // of the ring, each of 3 share words of every PE
    std::uint64_t transfers = 0;       // of the bus, from one PE to another
    std::uint64_t pe_broadcasts = 0;   // of the bus, from one PE to all
    std::optional<ModelledTime> time;  // of tracing and rotations; empty for machines whose rates are not known
};

/// std::invalid_argument as static_load().
ExplorerFigures figures_of(const CostImage& cost, const raya_mapping& mapping, const Machine& machine);

/// (name, text) in the order in which the page has them; no name twice.
using FigureTexts = std::vector<std::pair<std::string, std::string>>;
FigureTexts figure_texts(const ExplorerFigures& figures);

/// A number as it is written, with a narrow blank between thousands.
std::string grouped_text(std::string number);
std::string grouped_text(std::uint64_t number);

}  // namespace raya
