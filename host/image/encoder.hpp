// What the module of picture formats does for the program: the one place that knows OpenImageIO, whose 250 libraries
// take longer to load than a small render takes.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace raya {

inline constexpr int kJpegQuality = 95;  // 1..100, libjpeg's

inline constexpr const char* kEncoderModule = "raya_pictures";
inline constexpr const char* kEncoderFunction = "raya_encode_picture";

/// What a file says about its picture, as pairs of key and text. They become PNG texts and OpenEXR header entries
/// under the names `raya:key`, which no standard attribute has, and lines `raya:key=text` of the description that TIFF
/// and JPEG have; PFM and PPM have no place for them.
using ImageAttributes = std::vector<std::pair<std::string, std::string>>;

/// A picture as its format stores it: height x width x channels values, row 0 on top.
struct PictureToEncode {
    const char* format;  // OpenImageIO's name: "png", "tiff" or "jpeg", of 8-bit codes, or "exr", of floats
    int width;           // pixels
    int height;          // pixels
    int channels;        // 3, or 1: channel Y
    const void* values;  // float for EXR, else std::uint8_t
    double gamma;        // of the codes; 0: sRGB
    const ImageAttributes& attributes;
};

/// The function kEncoderFunction. True: `told` is the file's bytes; false: it is why there are none. Throws nothing but
/// std::bad_alloc.
using EncodePicture = bool(const PictureToEncode& picture, std::string& told);

}  // namespace raya
