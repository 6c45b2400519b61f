// Reader of the file of --camera-path: one camera per frame.
#pragma once
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// Reads one camera per line, for example "from 1,2,3 at 0,0,0 up 0,0,1 angle 40". Parameters that a line does not set
/// are those of `view`. Ignores empty lines and comments after #. Throws UserError with file, line and reason.
std::vector<View> read_camera_path(const std::string& file, const View& view);

}  // namespace raya
