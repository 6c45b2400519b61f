// Picture files: PNG, TIFF, JPEG and PPM (8-bit codes), OpenEXR and PFM (linear floats), the same bytes for the same
// picture every time. PPM and PFM need no library.
#pragma once
#include <array>
#include <filesystem>
#include <span>
#include <string_view>

#include "host/image/encoder.hpp"
#include "host/image/image.hpp"
#include "host/image/tone.hpp"

namespace raya {

inline constexpr std::array<std::string_view, 8> kImageExtensions{".png", ".exr",  ".pfm", ".ppm",
                                                                  ".tif", ".tiff", ".jpg", ".jpeg"};
inline constexpr std::array<std::string_view, 2> kGreyImageExtensions{".exr", ".pfm"};  // floats only

/// Whether a colour picture is written there as 8-bit codes, and so by a tone.
bool holds_codes(const std::filesystem::path& path);

/// Refuses a name whose extension (in either case) is not among `extensions`. Stdout ("-") takes PPM, where
/// `extensions` have it, else PFM. Throws UserError with file, reason and remedy.
void check_image_name(const std::filesystem::path& path, std::span<const std::string_view> extensions);

/// Loads the library that encodes the format of that name, if it needs one, so that a command refuses before it renders
/// what cannot be encoded. Throws UserError with file, reason and remedy.
void load_encoder(const std::filesystem::path& path);

/// Writes the picture in the format that the extension names, whole or not at all, without date, host or program
/// version. PNG, TIFF (zip), JPEG (kJpegQuality, colours as fine as brightness) and PPM hold the nearest 8-bit code of
/// each value by the tone, EXR (channels R, G, B, zip) and PFM the floats themselves. Throws UserError with file,
/// reason and remedy, std::logic_error if `image` lacks pixels.
void write_image(const std::filesystem::path& path, const Image& image, const ImageAttributes& attributes,
                 const Tone& tone = {});

/// As write_image() for one number a pixel: EXR (channel Y) or PFM.
void write_image(const std::filesystem::path& path, const GreyImage& image, const ImageAttributes& attributes);

}  // namespace raya
