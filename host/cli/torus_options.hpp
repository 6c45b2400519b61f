// Options of the torus machine.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/cli/render_options.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// The options as given on the command line. An empty value means the default.
struct TorusOptions {
    std::string nodes, voxels, packets, replay;
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

/// Names of the files that --replay simgrid writes next to FILE.csv.gz: FILE.xml (`platform`), FILE.replay (`replay`).
struct ReplayFiles {
    explicit ReplayFiles(const std::string& packets);
    std::string platform, replay;
};

/// Throws UserError with option, reason and remedy if a given option does not apply to the machine.
void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine);

/// Returns the settings of the torus renderer. Throws UserError for an option out of range.
TorusSettings torus_settings(const RenderOptions& options, const TorusOptions& torus, const Scene& scene);

}  // namespace raya
