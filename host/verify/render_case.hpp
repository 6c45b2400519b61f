// Checks of one render, `raya verify --as "render ..."`: its number format, lanes and kernels, and its image.
#pragma once
#include <functional>
#include <memory>
#include <variant>

#include "host/cl/kernel_options.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/topology.hpp"

namespace raya {

class Verification;

/// A render to check.
struct RenderCase {
    using Settings = std::variant<RingSettings, TorusSettings>;

    Scene scene;
    ImageSize size;  // of the render
    /// Returns the settings of the render for a scene and an image size. Throws UserError.
    std::function<Settings(const Scene&, const ImageSize&)> settings;
    std::shared_ptr<ScopedTunedSource> tuned{};  // the values of raya tune that the render uses
};

/// Runs the checks (docs/verify.md). Throws UserError if the device cannot make the render.
void verify_render_case(Verification& verification, const RenderCase& render);

}  // namespace raya
