// Portable float maps (P. Debevec): one line `PF` (colour) or `Pf` (grey), one `width height`, one `-1.0`
// (little-endian), then the floats, the bottom row first. OpenImageIO 2.4 reads them but does not write them.
#pragma once
#include <span>
#include <string>

namespace raya {

/// The bytes of a float map file, little-endian on any machine. `values`: height x width x channels floats, row-major,
/// row 0 on top; `channels` is 3 or 1.
std::string encode_pfm(int width, int height, int channels, std::span<const float> values);

}  // namespace raya
