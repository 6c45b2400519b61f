// Pictures as files hold them, read by OpenImageIO. Library raya_read_image, so that other tests load none of its
// libraries.
#pragma once
#include <filesystem>

#include "host/image/image.hpp"

namespace raya {

/// The floats of a file; the codes of a PNG become linear values. Throws std::runtime_error if it cannot be read, or
/// has not three channels, or one.
Image read_image(const std::filesystem::path& path);
GreyImage read_grey_image(const std::filesystem::path& path);

}  // namespace raya
