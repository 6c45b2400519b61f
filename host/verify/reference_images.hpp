// Reference images: settings, hashes, pixels and counts. reference_images.txt contains the results, which
// tests/verify/make_reference_images.cpp generates.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/image/image_io.hpp"
#include "host/model/machine.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

inline constexpr std::uint32_t kReferenceSide = 20;  // pixels

/// Settings that determine the pixels of a reference image. Struct Rendering (images.cpp) has the settings that must
/// not change the pixels, such as machine, mapping, lanes and group size.
struct ReferenceImage {
    std::string name;   // "glass fp32 filter"
    std::string scene;  // file name without extension: in host/verify/ or in scenes/
    std::string format;
    AntialiasMethod antialias = AntialiasMethod::kNone;
    raya_u32 points = RAYA_POINTS_AXES;  // RAYA_POINTS_*: positions of the additional samples of supersampling
    Sampling sampling = Sampling::kCentres;
    ImageSize size = {kReferenceSide, kReferenceSide};
};

inline constexpr std::uint32_t kReferenceBounces = 4;

const std::vector<ReferenceImage>& reference_images();
/// Throws std::logic_error for an unknown name.
const ReferenceImage& reference_image_named(const std::string& name);
Scene scene_of(const ReferenceImage& image);

/// Returns the settings with which reference_images.txt was generated, those of the simplest kernels: a ring with one
/// PE, one lane, work-groups of one work-item, no accelerator, no sphere filter or polygon filter.
RingSettings reference_settings(const ReferenceImage& image);

/// The stored hash, pixels and counts of a reference image.
struct StoredImage {
    std::string name, hash;
    Image image;
    // [check kind]: "COUNTER NUMBER ...". The check kind is the renderer with its accelerator or torus: "ring", "grid",
    // "bvh", or a text such as "torus3d 2x2x2".
    std::map<std::string, std::string> counts;
};

/// Parses reference_images.txt. A line "NAME: HASH" starts an image. Lines "counts KIND: COUNTER NUMBER ..." follow,
/// one for each check kind; then one line for each row of pixels. A pixel is RED/GREEN/BLUE, fp32 bits in hexadecimal
/// without trailing zeros; "." repeats the pixel to the left, "=" the pixel at the same position in the previous image.
/// Throws std::logic_error if pixels do not match their hash.
std::vector<StoredImage> parse_reference_images(const std::string& text);

/// Returns the result of `image` in reference_images.txt, which is embedded in the program.
const StoredImage& stored_image(const ReferenceImage& image);

/// Returns "COUNTER NUMBER ...": the counted events in the order of kernels/shared/events.h, then `other_counts`.
std::string counts_text(const EventCounts& events,
                        const std::vector<std::pair<const char*, std::uint64_t>>& other_counts);

/// Compares two texts of counts_text(). If they are equal, the verdict is a pass with the text `pass_text`; else it is
/// a failure that lists the counters that differ.
Verdict check_counts(const std::string& expected, const std::string& got, const std::string& pass_text);

/// Compares two images of the same size bit by bit. If they are equal, the verdict is a pass with the first digits of
/// the hash; else a failure with the first wrong pixel.
Verdict compare_images(const Image& expected, const Image& got);

/// Renders the image once for each check kind that `raya verify` has for it. Returns [check kind]: counts_text(). The
/// counts do not depend on lanes, group size, number of PEs or launches.
std::map<std::string, std::string> counts_by_check_kind(Session& session, const ReferenceImage& image);

}  // namespace raya
