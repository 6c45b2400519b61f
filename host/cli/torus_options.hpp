// Options of the torus machine.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/cli/render_options.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// As given on the command line; empty: the default.
struct TorusOptions {
    std::string nodes, voxels, links, inject, returns, packets, replay, link_exchange;
    std::optional<std::uint32_t> packet_words;
    std::optional<std::uint32_t> queue;  // packets
    bool async = false;
};

/// Adds the options, and the torus to those of --machine. Call it after add_render_options().
void add_torus_options(CLI::App& command, TorusOptions& torus);

/// The files of --replay simgrid for the packet trace FILE.csv.gz: FILE.xml (the platform) and FILE.replay.
struct ReplayFiles {
    explicit ReplayFiles(const std::string& packets);
    std::string platform, replay;
};

/// Refuses options that do not apply to the machine. UserError with option, reason and remedy.
void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine);

/// The settings of the torus renderer. UserError for an option out of range.
TorusSettings torus_settings(const RenderOptions& options, const TorusOptions& torus, const Scene& scene);

}  // namespace raya
