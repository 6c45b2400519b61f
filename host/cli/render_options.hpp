// The options of a render on the ring machine, shared by the commands that render.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "cl/device.hpp"
#include "ring/ring_renderer.hpp"
#include "scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; what is empty follows the machine, the scene or the device.
struct RenderOptions {
    std::string scene, machine = "spa", size, mapping, fold, format, sampling = "centres", device, antialias = "none",
                       points, kernel_dir;
    std::optional<double> threshold;
    std::optional<std::uint32_t> pes, offset, bounces, lanes, group;
};

/// Adds the options with their help texts: unit, default, legal range.
void add_render_options(CLI::App& command, RenderOptions& options);

/// What the renderer needs. UserError names the option that is out of range.
RingSettings ring_settings(const RenderOptions& options, const Scene& scene);

}  // namespace raya
