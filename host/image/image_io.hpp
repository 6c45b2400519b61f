// Image files: PNG, TIFF, JPEG and PPM (8-bit codes), OpenEXR and PFM (linear floats). The same image always gives the
// same bytes. PPM and PFM need no library.
#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string_view>

#include "host/image/encoder.hpp"
#include "host/image/image.hpp"

namespace raya {

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
void write_image(const std::filesystem::path& path, const Image& image, const ImageAttributes& attributes,
                 double exposure = 0);

/// Writes an image of one number per pixel as EXR (channel Y, zip) or PFM. Throws UserError with file, reason
/// and remedy; std::logic_error if `image` does not have one float per pixel.
void write_image(const std::filesystem::path& path, const GreyImage& image, const ImageAttributes& attributes);

}  // namespace raya
