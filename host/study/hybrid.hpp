// Groups of nodes share the screen, and each group divides space: Harada et al. 1995, reference [1] of Yoshitani &
// Yamazaki.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/study/page.hpp"
#include "host/study/scenes.hpp"

namespace raya {

/// `nodes`: a power of two, of the whole machine; in 1, 2, 4, ... groups, up to one for each node. `scenes`: one at
/// least.
StudyPage hybrid_page(Session& session, const std::vector<LabelledScene>& scenes, std::uint32_t size,
                      std::uint32_t nodes);

}  // namespace raya
