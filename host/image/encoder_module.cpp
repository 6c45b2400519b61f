// The module of picture formats: EncodePicture by OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string_view>

#include "host/image/encoder.hpp"

namespace raya {
namespace {

OIIO::ImageSpec make_spec(const PictureToEncode& picture) {
    const bool codes = std::string_view(picture.format) == "png";
    OIIO::ImageSpec spec(picture.width, picture.height, picture.channels,
                         codes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    if (picture.channels == 1) spec.channelnames = {"Y"};
    spec.attribute("oiio:ColorSpace", codes ? "sRGB" : "Linear");
    for (const auto& [key, text] : picture.attributes) spec.attribute("raya:" + key, text);
    if (codes) return spec;
    spec.attribute("compression", "zip");
    // Without a date OpenImageIO puts in today's; one that is no string it leaves out, with a debugging message.
    spec.attribute("DateTime", 0);
    OIIO::attribute("debug", 0);
    return spec;
}

/// Made in memory, so that writing is checked in one place.
bool encode(const PictureToEncode& picture, std::string& told) {
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(picture.format, &bytes);
    if (!output) {
        told = OIIO::geterror();
        return false;
    }
    const OIIO::ImageSpec spec = make_spec(picture);
    const std::string name = std::string("memory.") + picture.format;  // stands in no file
    if (!output->open(name, spec) || !output->write_image(spec.format, picture.values) || !output->close()) {
        told = output->geterror();
        return false;
    }
    told.assign(bytes.buffer().begin(), bytes.buffer().end());
    return true;
}

}  // namespace
}  // namespace raya

extern "C" __attribute__((visibility("default"))) bool raya_encode_picture(const raya::PictureToEncode& picture,
                                                                           std::string& told) {
    return raya::encode(picture, told);
}
