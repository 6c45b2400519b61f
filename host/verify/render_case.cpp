#include "host/verify/render_case.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/verify/hits.hpp"
#include "host/verify/numbers.hpp"
#include "host/verify/reference_images.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

using Settings = RenderCase::Settings;

constexpr std::uint32_t kSmallSide = 32;  // pixels of the longer side of the small image of the render's scene
constexpr int kExactHitBits = 12;         // minimum fraction bits for which the known hits are exact

struct CaseImage {
    Image image;
    std::string options;  // build options of the kernels
};

CaseImage case_image(Session& session, const Scene& scene, const Settings& settings) {
    const auto kept = [](auto result) { return CaseImage{std::move(result.image), result.build_options}; };
    if (const auto* torus = std::get_if<TorusSettings>(&settings))
        return kept(TorusRenderer(session, scene, *torus).render());
    return kept(RingRenderer(session, scene, std::get<RingSettings>(settings)).render());
}

// The render's settings for one of its images.
struct SizedCase {
    ImageSize size;
    Settings settings;
};

// Returns the settings for a small image or, if options such as a large --offset do not allow it, for the whole image.
SizedCase small_case(const RenderCase& render) {
    const double factor = std::min(1., double{kSmallSide} / std::max(render.size.width, render.size.height));
    const auto side = [&](std::uint32_t pixels) { return std::max(1u, static_cast<std::uint32_t>(pixels * factor)); };
    const ImageSize small = {side(render.size.width), side(render.size.height)};
    try {
        return {small, render.settings(render.scene, small)};
    } catch (const UserError&) {
        return {render.size, render.settings(render.scene, render.size)};
    }
}

// Returns the number of lanes with which the device makes the render. Throws UserError if it cannot make the render.
std::uint32_t chosen_lanes(const Verification& v, const RenderCase& render, const Settings& settings) {
    if (const auto* torus = std::get_if<TorusSettings>(&settings))
        return checked_settings(*torus, render.scene, v.device()).kernels.lanes;
    return checked_settings(std::get<RingSettings>(settings), v.device()).kernels.lanes;
}

// Returns settings that give the same image with the simplest kernels.
RingSettings simplest_settings_of(const Settings& settings, const ImageSize& size) {
    RingSettings simplest = simplest_settings(size);
    std::visit(
        [&](const auto& s) {
            simplest.bounces = s.bounces;
            simplest.format = s.format;
            simplest.sampling = s.sampling;
            simplest.kernels.sources = s.kernels.sources;
        },
        settings);
    if (const auto* ring = std::get_if<RingSettings>(&settings)) simplest.antialias = ring->antialias;
    return simplest;
}

// Returns the render's settings for a reference image; empty if the render's options do not allow it.
std::optional<Settings> reference_case(const RenderCase& render, const ReferenceImage& image, std::string& reason) {
    try {
        Settings settings = render.settings(scene_of(image), image.size);
        std::visit(
            [&](auto& s) {
                s.bounces = kReferenceBounces;
                s.sampling = image.sampling;
            },
            settings);
        if (auto* ring = std::get_if<RingSettings>(&settings)) {
            const RingSettings small = std::get<RingSettings>(small_case(render).settings);
            ring->accel = small.accel;
            ring->packets = false;
            if (small.packets) use_packets(*ring, true);
            ring->antialias.method = image.antialias;
            ring->antialias.points = image.points;
            ring->antialias.threshold = Antialias{}.threshold;
        }
        return settings;
    } catch (const UserError& error) {
        reason = error.what();
        return {};
    }
}

void verify_hits_of_case(Verification& v, const Settings& settings, const NumberFormat& format, std::uint32_t lanes) {
    HitBuild build{.format = format, .lanes = lanes, .grid = false, .sources = v.settings().sources};
    if (format.fraction_bits < kExactHitBits)
        return v.check("geometry", "known hits, " + build.name(), [&](Session&) {
            return skipped(fmt::format("the known hits are exact only with {} or more fraction bits", kExactHitBits));
        });
    const auto* const ring = std::get_if<RingSettings>(&settings);
    build.grid = ring != nullptr && ring->accel.kind == AccelKind::kGrid;
    verify_hits(v, build);
    build.filter = filters_are_valid(format, 1);
    if (build.filter) verify_hits(v, build);
}

void verify_reference_images(Verification& v, const RenderCase& render, const NumberFormat& format) {
    const bool is_torus = std::holds_alternative<TorusSettings>(small_case(render).settings);
    bool has_image = false;
    for (const ReferenceImage& image : reference_images()) {
        if (parse_format(image.format) != format || (is_torus && image.antialias != AntialiasMethod::kNone)) continue;
        has_image = true;
        v.check("image", image.name + ", as given", [&](Session& session) {
            std::string reason;
            const std::optional<Settings> settings = reference_case(render, image, reason);
            if (!settings) return skipped("the render's options do not allow it: " + reason);
            const CaseImage got = case_image(session, scene_of(image), *settings);
            return with_options(compare_images(stored_image(image).image, got.image), got.options);
        });
    }
    if (has_image) return;
    v.check("image", format_name(format) + ", as given",
            [&](Session&) { return skipped(fmt::format("there is no reference image in {}", format_name(format))); });
}

void verify_own_image(Verification& v, const RenderCase& render, const SizedCase& small) {
    const std::string name = fmt::format("{} {}x{}, as given and as simple as possible", render.scene.name,
                                         small.size.width, small.size.height);
    v.check("image", name, [&](Session& session) {
        const CaseImage simplest = case_image(session, render.scene, simplest_settings_of(small.settings, small.size));
        const CaseImage got = case_image(session, render.scene, small.settings);
        return with_options(compare_images(simplest.image, got.image), got.options);
    });
}

}  // namespace

void verify_render_case(Verification& v, const RenderCase& render) {
    const SizedCase small = small_case(render);
    const NumberFormat format = std::visit([](const auto& s) { return s.format; }, small.settings);
    const std::uint32_t lanes = chosen_lanes(v, render, small.settings);
    verify_number_format(v, format, lanes);
    verify_hits_of_case(v, small.settings, format, lanes);
    verify_reference_images(v, render, format);
    verify_own_image(v, render, small);
}

}  // namespace raya
