// Who makes the primary rays: the root, one after another, or all nodes.
#pragma once
#include <cstdint>
#include <vector>

#include "cl/commands.hpp"
#include "study/page.hpp"
#include "study/scenes.hpp"

namespace raya {

/// On 1, 2, 4, ... `most` nodes, a power of two.
StudyPage inject_page(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most);

}  // namespace raya
