// Fig. 9 of Kohata & Ito 1993 as a function of one cost image.
#pragma once
#include <string>

#include "host/ring/cost_image.hpp"
#include "host/study/page.hpp"

namespace raya {

/// Speed-up against the number of PEs, 1 to one for each column of a square image of 16 pixels a side or more.
StudyPage speedup_page(const std::string& scene, const CostImage& image);

}  // namespace raya
