// Fig. 3 of Yoshitani & Yamazaki as a function of what was counted and timed: divisions of space, by one machine.
#pragma once
#include <cstdint>
#include <vector>

#include "host/study/grid_run.hpp"
#include "host/study/page.hpp"

namespace raya {

/// 2^k voxels as near to a cube as powers of two allow, the longer sides along x, then y: 32 are 4 x 4 x 2, 1024 are 16
/// x 8 x 8. k 0..24.
Divisions divisions_of_power(std::uint32_t k);

/// One scene over the divisions, in ascending order, two at least.
using DivisionsSeries = std::vector<GridRun>;

/// `series`: one at least. `from_paper`: the scenes are of the paper's kind, with as many objects as the paper has, so
/// that its figures stand beside ours; the last has 1024. std::logic_error where 32 or 1024 divisions are missing then.
StudyPage divisions_page(std::uint32_t side, const std::vector<DivisionsSeries>& series, bool from_paper);

}  // namespace raya
