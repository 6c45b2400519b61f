// Camera files of --camera-path: one camera for each frame.
#pragma once
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// Reads one camera per line: "from 1,2,3 at 0,0,0 up 0,0,1 angle 40" or some of these; the others are as in `view`.
/// Ignores empty lines and comments after #. UserError with file, line and reason.
std::vector<View> read_camera_path(const std::string& file, const View& view);

}  // namespace raya
