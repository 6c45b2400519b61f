// Fig. 4 of Yoshitani & Yamazaki: time against the number of objects, spread evenly and at random.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/study/page.hpp"

namespace raya {

/// For numbers of objects, ascending, and so many random scenes of each.
StudyPage objects_page(Session& session, const std::vector<int>& counts, std::uint32_t size, int seeds);

}  // namespace raya
