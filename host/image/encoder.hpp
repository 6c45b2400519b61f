// Interface of the module that encodes images with OpenImageIO. It is a module because loading OpenImageIO's 250
// libraries takes longer than a small render.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace raya {

inline constexpr int kJpegQuality = 95;  // libjpeg's scale, 1..100

inline constexpr const char* kEncoderModule = "raya_pictures";
inline constexpr const char* kEncoderFunction = "raya_encode_picture";

/// Metadata of an image file, as pairs of key and text: PNG texts and OpenEXR header entries with the names `raya:key`,
/// which no standard attribute has, and lines `raya:key=text` of the image description of TIFF and JPEG. PFM and PPM do
/// not support metadata.
using ImageAttributes = std::vector<std::pair<std::string, std::string>>;

/// An image to encode: height x width x channels values, row 0 on top.
struct PictureToEncode {
    const char* format;  // OpenImageIO's name: "png", "tiff" or "jpeg" (8-bit codes) or "exr" (floats)
    int width;           // pixels
    int height;          // pixels
    int channels;        // 3, or 1: channel Y
    const void* values;  // float for EXR, else std::uint8_t
    double gamma;        // of the codes; 0: sRGB
    const ImageAttributes& attributes;
};

/// The type of kEncoderFunction. Returns true and the file's bytes in `result`, or false and an error message. Throws
/// only std::bad_alloc.
using EncodePicture = bool(const PictureToEncode& picture, std::string& result);

}  // namespace raya
