// Image files: PNG, TIFF, JPEG and PPM (8-bit codes), OpenEXR and PFM (linear floats). The same image always gives the
// same bytes. Only TIFF, JPEG and OpenEXR need OpenImageIO.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/image/encoder.hpp"

namespace raya {

// Images in memory, and the hash of an image.

/// A colour image: linear, unclamped, row-major, row 0 on top, 3 floats (red, green, blue) per pixel.
struct Image {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> rgb;
};

/// One number per pixel, such as its modelled cost: row-major, row 0 on top.
struct GreyImage {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> values;
};

/// Returns the XXH3 hash (128 bits, as 32 lower-case hexadecimal digits) of width, height and the bits of all floats,
/// as 32-bit little-endian words on any machine. Because bits are hashed, the hashes of -0 and +0 differ, and so do
/// those of NaNs with different bits.
std::string pixel_hash(const Image& image);

// Conversion of linear colours to 8-bit codes of image files, by the sRGB curve (IEC 61966-2-1).

/// Returns the nearest code on the sRGB curve; 0 for negative values and NaN, 255 above 1. The code follows from
/// comparisons with the 255 values between two codes, which are computed with the C library's pow(). The code of a
/// float is the same on every machine, because the relative error of pow() is only about 10^-16, and the relative
/// distance of every float from these values is more than 10^-11.
std::uint8_t srgb_code(double linear);

/// Returns the codes of the values multiplied by 2^exposure. A NaN counts as 0, an infinite value as the largest float.
/// The result is the same on every machine, except for values at the border of two codes, which depend on the rounding
/// of exp2().
std::vector<std::uint8_t> srgb_codes(std::span<const float> values, double exposure);

// PNG files in memory, for HTML pages and reports.

/// Returns the bytes of the PNG file that write_image() writes by default. Throws std::logic_error if `image` has no
/// pixels or does not have 3 floats per pixel.
std::string plain_png(const Image& image);

// Reduced images for reports and pages.

/// Reduces an image to at most `max_side` pixels per side and keeps its proportions. Each pixel of the result is the
/// mean of the pixels that it covers, after clamping them to 0..1 (NaN: 0), in linear light. An image that is small
/// enough is only clamped. Throws std::logic_error if `image` has no pixels.
Image preview_of(const Image& image, int max_side = 256);

/// Returns the linear light that an sRGB screen displays for the 8-bit codes of `image` multiplied by 2^exposure.
Image as_displayed(const Image& image, double exposure);

inline constexpr std::array<std::string_view, 8> kImageExtensions{".png", ".exr",  ".pfm", ".ppm",
                                                                  ".tif", ".tiff", ".jpg", ".jpeg"};
inline constexpr std::array<std::string_view, 2> kGreyImageExtensions{".exr", ".pfm"};  // formats that store floats

/// Returns true if a colour image in the file `path` is stored as 8-bit codes, to which --exposure applies.
bool stores_8bit_codes(const std::filesystem::path& path);

/// Throws UserError, with file, reason and remedy, if the extension of `path` (upper or lower case) is not one of
/// `extensions`. Images on stdout ("-") are PPM if ".ppm" is one of `extensions`, else PFM.
void check_image_name(const std::filesystem::path& path, std::span<const std::string_view> extensions);

/// Loads the encoder module if the format of the file `path` needs it, so that a command fails before rendering instead
/// of after it. Throws UserError with file, reason and remedy.
void load_encoder(const std::filesystem::path& path);

/// Writes an image atomically in the format of the extension, without date, host or program version. PNG, TIFF (zip),
/// JPEG (kJpegQuality, 4:4:4) and PPM store the nearest 8-bit code of each value; EXR (channels R, G, B,
/// zip) and PFM store the floats. Throws UserError with file, reason and remedy; std::logic_error if `image` does not
/// have 3 floats per pixel.
void write_image(const std::filesystem::path& path, const Image& image, double exposure = 0);

/// Writes an image of one number per pixel as EXR (channel Y, zip) or PFM. Throws UserError with file, reason
/// and remedy; std::logic_error if `image` does not have one float per pixel.
void write_image(const std::filesystem::path& path, const GreyImage& image);

}  // namespace raya
