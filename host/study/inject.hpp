// Who makes the primary rays: the root, one after another, or all nodes.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/study/page.hpp"
#include "host/study/scenes.hpp"

namespace raya {

/// On 1, 2, 4, ... `most` nodes, a power of two.
StudyPage inject_page(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most);

}  // namespace raya
