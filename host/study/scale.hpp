// Static mappings on ever larger arrays, as a function of one cost image.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/ring/cost_image.hpp"
#include "host/study/page.hpp"

namespace raya {

/// 16, 32, .. PEs, up to one for each pixel of a square image of 16 pixels a side or more.
StudyPage scale_page(const std::string& scene, const CostImage& image);

/// Whether more PEs than columns take 2-D: `kept` are the numbers of PEs, of `sizes` that there are, on which the
/// mapping called `best` keeps up with it.
std::string need_of_2d(const std::string& best, const std::vector<std::uint32_t>& kept, std::size_t sizes);

}  // namespace raya
