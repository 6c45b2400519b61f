// The image encoder module: implements EncodePicture with OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string_view>

#include "host/image/encoder.hpp"

namespace raya {
namespace {

OIIO::ImageSpec make_spec(const PictureToEncode& picture) {
    const std::string_view format = picture.format;
    OIIO::ImageSpec spec(picture.width, picture.height, picture.channels,
                         format == "exr" ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    if (picture.channels == 1) spec.channelnames = {"Y"};
    // Without a DateTime, OpenImageIO writes the current date. It ignores a DateTime that is not a string, so the files
    // have no date. It also prints a debug message, which debug = 0 disables.
    if (format == "exr" || format == "tiff") spec.attribute("DateTime", 0);
    OIIO::attribute("debug", 0);
    spec.attribute("oiio:ColorSpace", format == "exr" ? "Linear" : "sRGB");
    if (format == "exr" || format == "tiff") spec.attribute("compression", "zip");
    // OpenImageIO 2.4 cannot write EXIF data to memory, because they are in a second TIFF directory.
    if (format == "tiff") spec.attribute("tiff:write_exif", 0);
    if (format == "jpeg") {
        spec.attribute("Compression", "jpeg:" + std::to_string(kJpegQuality));
        spec.attribute("jpeg:subsampling", "4:4:4");
    }
    return spec;
}

/// Encodes to memory, so that write_whole_file() writes the files of all formats and checks for errors.
bool encode(const PictureToEncode& picture, std::string& result) {
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(picture.format, &bytes);
    if (!output) {
        result = OIIO::geterror();
        return false;
    }
    const OIIO::ImageSpec spec = make_spec(picture);
    const std::string name = std::string("memory.") + picture.format;  // open() requires a name
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
