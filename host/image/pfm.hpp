// Portable float maps (P. Debevec): one line `PF` (colour) or `Pf` (grey), one `width height`, one `-1.0`
// (little-endian), then the floats, the bottom row first. OpenImageIO 2.4 reads them but does not write them.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace raya {

/// The bytes of a float map file piece by piece, little-endian on any machine: so that a large picture is not in memory
/// twice.
class PfmPieces {
  public:
    /// `values`: height x width x channels floats, row-major, row 0 on top; `channels` is 3 or 1. They outlive this.
    PfmPieces(int width, int height, int channels, std::span<const float> values);

    /// The next piece, good until the next call; empty at the end.
    std::string_view next();

  private:
    std::span<const float> left_;
    std::size_t row_;  // floats
    std::string piece_;
    bool begun_ = false;
};

}  // namespace raya
