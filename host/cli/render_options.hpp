// Options of all commands that render.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/cli/parse.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/topology.hpp"

namespace raya {

/// The options as given on the command line. An empty value means the default of the machine, scene or device.
struct RenderOptions {
    std::string scene, machine = "spa", size, mapping, format, device, kernel_dir, accel;
    Sampling sampling = Sampling::kCentres;
    AntialiasMethod antialias = AntialiasMethod::kNone;
    std::optional<raya_u32> points;
    std::optional<ExchangeMethod> exchange;
    std::optional<Fold> fold;
    bool strict = false, no_tuned = false;
    ViewOptions view;
    std::optional<double> threshold, display_rate;  // display_rate: pixels per second
    std::optional<std::uint64_t> pe_memory;         // bytes
    std::optional<std::uint32_t> split, pes, offset, bounces, lanes, group;
};

/// Marks an option that only ring machines have.
CLI::Option* ring_only(CLI::Option* option);

/// Adds the options of RenderOptions except the scene, and except anti-aliasing if `antialiasing` is false.
void add_render_options(CLI::App& command, RenderOptions& options, bool antialiasing = true);

// Each function below returns the value of an option or, if it is not given, its default. The functions throw
// UserError, with the option's name, for an invalid value.

/// Returns --size, by default the scene's resolution. Width and height are 1..16384 pixels.
ImageSize image_size(const RenderOptions& options, const Scene& scene);

/// Returns the settings of the ring renderer. Throws UserError for an option out of range, or a machine that is not a
/// ring.
RingSettings ring_settings(const RenderOptions& options, const Scene& scene);

// Options of the torus machine.

/// The options as given on the command line. An empty value means the default.
struct TorusOptions {
    std::string nodes, voxels;
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    bool one_return_per_ray = false;
    std::optional<std::uint32_t> packet_words;
    std::optional<std::uint32_t> queue;  // queue length in packets
    bool async = false;
};

/// Adds the options, and adds the torus to the machines in the help of --machine. Call this function after
/// add_render_options().
void add_torus_options(CLI::App& command, TorusOptions& torus);

/// Throws UserError with option and remedy if a given option does not apply to the machine.
void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine);

/// Returns the settings of the torus renderer. Throws UserError for an option out of range.
TorusSettings torus_settings(const RenderOptions& options, const TorusOptions& torus, const Scene& scene);

}  // namespace raya
