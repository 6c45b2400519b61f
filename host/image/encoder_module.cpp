// The module of image formats: EncodePicture by OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <sstream>
#include <string_view>

#include "host/image/encoder.hpp"

namespace raya {
namespace {

// TIFF and JPEG do not support attributes with custom names.
std::string description(const ImageAttributes& attributes) {
    std::string text;
    for (const auto& [key, value] : attributes) text += (text.empty() ? "raya:" : "\nraya:") + key + '=' + value;
    return text;
}

void describe_codes(OIIO::ImageSpec& spec, const PictureToEncode& picture, std::string_view format) {
    std::string space = "sRGB";
    if (picture.gamma != 0) {  // stored by PNG; TIFF and JPEG cannot store it
        std::ostringstream name;
        name << "Gamma" << picture.gamma;
        space = name.str();
    }
    spec.attribute("oiio:ColorSpace", space);
    if (format == "png") {
        for (const auto& [key, text] : picture.attributes) spec.attribute("raya:" + key, text);
        return;
    }
    if (!picture.attributes.empty()) spec.attribute("ImageDescription", description(picture.attributes));
    if (format == "tiff") {
        spec.attribute("compression", "zip");
        // EXIF needs a second directory linked with the first one, which OpenImageIO 2.4 cannot write in memory.
        spec.attribute("tiff:write_exif", 0);
        return;
    }
    spec.attribute("Compression", "jpeg:" + std::to_string(kJpegQuality));
    spec.attribute("jpeg:subsampling", "4:4:4");
}

OIIO::ImageSpec make_spec(const PictureToEncode& picture) {
    const std::string_view format = picture.format;
    OIIO::ImageSpec spec(picture.width, picture.height, picture.channels,
                         format == "exr" ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    if (picture.channels == 1) spec.channelnames = {"Y"};
    // Without DateTime OpenImageIO writes today's date. It ignores one that is not a string, with a debug message.
    if (format == "exr" || format == "tiff") spec.attribute("DateTime", 0);
    OIIO::attribute("debug", 0);
    if (format != "exr") {
        describe_codes(spec, picture, format);
        return spec;
    }
    spec.attribute("oiio:ColorSpace", "Linear");
    for (const auto& [key, text] : picture.attributes) spec.attribute("raya:" + key, text);
    spec.attribute("compression", "zip");
    return spec;
}

/// Encodes in memory, so that one function writes all files and checks for errors.
bool encode(const PictureToEncode& picture, std::string& result) {
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(picture.format, &bytes);
    if (!output) {
        result = OIIO::geterror();
        return false;
    }
    const OIIO::ImageSpec spec = make_spec(picture);
    const std::string name = std::string("memory.") + picture.format;  // not stored in the file
    if (!output->open(name, spec) || !output->write_image(spec.format, picture.values) || !output->close()) {
        result = output->geterror();
        return false;
    }
    result.assign(bytes.buffer().begin(), bytes.buffer().end());
    return true;
}

}  // namespace
}  // namespace raya

extern "C" __attribute__((visibility("default"))) bool raya_encode_picture(const raya::PictureToEncode& picture,
                                                                           std::string& result) {
    return raya::encode(picture, result);
}
