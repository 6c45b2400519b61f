// Options shared by the commands that render; those of the torus machine are in torus_options.hpp.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/cli/view_options.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; an empty value means the default of the machine, the scene or the device.
struct RenderOptions {
    std::string scene, machine = "spa", size, mapping, fold, format, sampling = "centres", device, antialias = "none",
                       points, exchange, kernel_dir, accel;
    bool strict = false, no_tuned = false;
    ViewOptions view;
    std::optional<double> threshold;
    std::optional<std::uint64_t> pe_memory;  // bytes
    std::optional<std::uint32_t> pes, offset, bounces, lanes, group;
};

/// Adds the options. `antialiasing`: includes those of anti-aliasing.
void add_render_options(CLI::App& command, RenderOptions& options, bool antialiasing = true);

// The values of --size, --format, --lanes and --group, for any machine. UserError names the option.

/// Width and height, each 1..16384; default: the scene's.
ImageSize image_size(const RenderOptions& options, const Scene& scene);
NumberFormat format_of(const RenderOptions& options, const Machine& machine);
KernelChoice kernel_choice(const RenderOptions& options);
/// Bytes of a PE's memory: --pe-memory, else the machine's; empty: no limit.
std::optional<std::uint64_t> pe_memory_of(const RenderOptions& options, const Machine& machine);

/// The settings of the ring renderer. UserError for an option out of range, and for a machine that is not a ring.
RingSettings ring_settings(const RenderOptions& options, const Scene& scene);

}  // namespace raya
