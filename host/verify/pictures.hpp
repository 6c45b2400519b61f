// Pictures whose every bit is known: what is in them, their hashes and their pixels (pictures.txt beside this file,
// made by tests/verify/make_pictures.cpp).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/image/image.hpp"
#include "host/machine/number_format.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/ring_settings.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// All that decides the pixels. What decides nothing, machine, mapping, lanes and groups, is Rendering's.
struct Picture {
    std::string name;   // "glass fp32 filter"
    std::string scene;  // of scenes/, or ties.nff beside this file, without folder and ending
    std::string format;
    AntialiasMethod antialias = AntialiasMethod::kNone;
    raya_u32 points = RAYA_POINTS_AXES;
    Sampling sampling = Sampling::kCentres;
};

inline constexpr std::uint32_t kPictureSide = 20;  // pixels; pictures are square
inline constexpr std::uint32_t kPictureBounces = 4;

const std::vector<Picture>& pictures();
/// std::logic_error for a name that is none of them.
const Picture& picture_named(const std::string& name);
Scene scene_of(const Picture& picture);

/// The picture as plainly as it can be made: a ring with one PE, one lane, one work-item in a group, no grid, no
/// filter.
RingSettings plain_settings(const Picture& picture);

struct KnownPicture {
    std::string name, hash;
    Image image;
};

/// A line "NAME: HASH" opens a picture, then a line a row follows: pixels as RED/GREEN/BLUE, the bits in hexadecimal
/// digits without the zeros at their ends, "." for that on the left once more, "=" for that of the picture before.
/// std::logic_error for what is not so.
std::vector<KnownPicture> parse_pictures(const std::string& text);
std::string pictures_text(const std::vector<KnownPicture>& all);

/// Those that the program carries. std::logic_error where the file lacks the picture.
const KnownPicture& known_picture(const Picture& picture);

}  // namespace raya
