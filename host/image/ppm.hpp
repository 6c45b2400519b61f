// Portable pixmaps (PPM, J. Poskanzer), binary: one line `P6`, one `width height`, one `255`, then three 8-bit codes a
// pixel, the top row first. They hold the codes of a PNG and need no library.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "host/image/tone.hpp"

namespace raya {

/// The bytes of a pixmap file piece by piece, so that a large picture is not in memory twice.
class PpmPieces {
  public:
    /// `values`: height x width x 3 floats, linear, row-major, row 0 on top. They outlive this.
    PpmPieces(int width, int height, std::span<const float> values, const Tone& tone);

    /// The next piece, good until the next call; empty at the end.
    std::string_view next();

  private:
    ToneCodes codes_;
    std::span<const float> left_;
    std::size_t row_;  // floats
    std::string piece_;
    bool begun_ = false;
};

}  // namespace raya
