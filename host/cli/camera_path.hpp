// Files of cameras, one for each frame.
#pragma once
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// A camera for each line: what it says in the words of the command line, "from 1,2,3 at 0,0,0 up 0,0,1 angle 40" or
/// some of those, in place of what `view` has. Empty lines and what follows a # are passed over. UserError with file,
/// line and reason; for a file that cannot be read or has no camera.
std::vector<View> read_camera_path(const std::string& file, const View& view);

}  // namespace raya
