// Reference images, called pictures: settings, hashes and pixels. tests/verify/make_pictures.cpp generates
// pictures.txt.
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

/// Settings that determine the pixels. Settings that must not change the pixels, such as machine, mapping, lanes and
/// group size, are in Rendering (images.cpp).
struct Picture {
    std::string name;   // "glass fp32 filter"
    std::string scene;  // file name without extension: in scenes/, or "ties" for host/verify/ties.nff
    std::string format;
    AntialiasMethod antialias = AntialiasMethod::kNone;
    raya_u32 points = RAYA_POINTS_AXES;
    Sampling sampling = Sampling::kCentres;
};

inline constexpr std::uint32_t kPictureSide = 20;  // pixels; pictures are square
inline constexpr std::uint32_t kPictureBounces = 4;

const std::vector<Picture>& pictures();
/// Throws std::logic_error for an unknown name.
const Picture& picture_named(const std::string& name);
Scene scene_of(const Picture& picture);

/// Returns the reference settings: a ring with one PE, one lane, work-groups of one work-item, no accelerator, no fp32
/// pre-test of objects.
RingSettings reference_settings(const Picture& picture);

struct KnownPicture {
    std::string name, hash;
    Image image;
    std::map<std::string, std::string> counts;  // variant ("ring", "bvh", ...) -> "COUNTER NUMBER ..."
};

/// Parses pictures.txt. A line "NAME: HASH" starts a picture. Lines "counts VARIANT: COUNTER NUMBER ..." follow, then
/// one line for each row of pixels. A pixel is RED/GREEN/BLUE, fp32 bits in hexadecimal without trailing zeros; "."
/// repeats the pixel to the left, "=" the pixel at the same position in the previous picture. Throws std::logic_error
/// for a syntax error.
std::vector<KnownPicture> parse_pictures(const std::string& text);
std::string pictures_text(const std::vector<KnownPicture>& all);

/// Returns the hash, pixels and counts of `picture` that are embedded in the program. Throws std::logic_error if they
/// are missing.
const KnownPicture& known_picture(const Picture& picture);

/// Returns "COUNTER NUMBER ...": the counted events in the order of kernels/shared/events.h, then `more`.
std::string counts_text(const EventCounts& events, const std::vector<std::pair<const char*, std::uint64_t>>& more);

/// Compares two texts of counts_text(). A pass has the result text `result`; a failure lists every counter that
/// differs. `options`: build options of the kernels.
Verdict check_counts(const std::string& known, const std::string& counted, const std::string& result,
                     const std::string& options);

/// Renders the picture with each variant that `raya verify` renders, and returns its counts: variant -> counts_text().
/// They do not depend on lanes, group size, PEs or launches.
std::map<std::string, std::string> counts_by_variant(Session& session, const Picture& picture);

}  // namespace raya
