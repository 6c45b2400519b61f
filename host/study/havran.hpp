// Tests and steps a ray in uniform grids beside those of Havran & Sixta 1999, as a function of what was counted.
#pragma once
#include <cstdint>
#include <vector>

#include "host/study/grid_run.hpp"
#include "host/study/page.hpp"

namespace raya {

/// `runs`: one at least, those of one scene after one another, rendered with SPD's settings but `side`. Published
/// figures stand beside those whose label and divisions are in paper::kHavran.
StudyPage havran_page(std::uint32_t side, const std::vector<GridRun>& runs);

}  // namespace raya
