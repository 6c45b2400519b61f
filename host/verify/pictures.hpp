// Pictures whose every bit is known: what is in them, their hashes and their pixels (pictures.txt beside this file,
// made by tests/verify/make_pictures.cpp).
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/image/image.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"
#include "host/verify/verdict.hpp"

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
    std::map<std::string, std::string> counts;  // "COUNTER NUMBER ...", by the way of rendering: "ring", "bvh", ...
};

/// A line "NAME: HASH" opens a picture, then lines "counts WAY: COUNTER NUMBER ..." and a line a row follow: pixels as
/// RED/GREEN/BLUE, the bits in hexadecimal digits without the zeros at their ends, "." for that on the left once more,
/// "=" for that of the picture before. std::logic_error for what is not so.
std::vector<KnownPicture> parse_pictures(const std::string& text);
std::string pictures_text(const std::vector<KnownPicture>& all);

/// Those that the program carries. std::logic_error where the file lacks the picture.
const KnownPicture& known_picture(const Picture& picture);

/// "COUNTER NUMBER ...": the events in the order of kernels/shared/events.h, then what else was counted.
std::string counts_text(const EventCounts& events, const std::vector<std::pair<const char*, std::uint64_t>>& more);

/// Passes with `told` or fails with every counter that differs. `options`: build options of the kernels.
Verdict check_counts(const std::string& known, const std::string& counted, const std::string& told,
                     const std::string& options);

/// What each way counts in which `raya verify` renders the picture: neither lanes nor groups, PEs or launches matter.
std::map<std::string, std::string> counts_of_ways(Session& session, const Picture& picture);

}  // namespace raya
