// Interface of the module that encodes images with OpenImageIO. The encoder is loaded on demand, because loading
// OpenImageIO's 250 libraries takes longer than a small render.
#pragma once
#include <string>

namespace raya {

inline constexpr int kJpegQuality = 95;  // libjpeg's scale, 1..100

inline constexpr const char* kEncoderModule = "raya_pictures";
inline constexpr const char* kEncoderFunction = "raya_encode_picture";

/// An image to encode. `values` has the shape [height, width, channels]; row 0 is the top.
struct PictureToEncode {
    const char* format;  // OpenImageIO's name: "tiff" or "jpeg" (8-bit codes) or "exr" (floats)
    int width;           // pixels
    int height;          // pixels
    int channels;        // 3, or 1: channel Y
    const void* values;  // float for EXR, else std::uint8_t
};

/// The type of the module's function kEncoderFunction. On success returns true and sets `result` to the file's bytes,
/// else returns false and sets `result` to an error message. Throws only std::bad_alloc.
using EncodePicture = bool(const PictureToEncode& picture, std::string& result);

}  // namespace raya
