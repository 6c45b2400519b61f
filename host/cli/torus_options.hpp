// The options of a render that belong to the torus machine alone.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/cli/render_options.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// As given on the command line; what is empty has its default.
struct TorusOptions {
    std::string nodes, voxels, links, inject, returns, packets, replay, link_exchange;
    std::optional<std::uint32_t> packet_words;
    std::optional<std::uint32_t> queue;  // packets
    bool async = false;
};

/// Adds the options with their help texts, and --pe-memory; add_render_options() has been called.
void add_torus_options(CLI::App& command, TorusOptions& torus);

/// What --replay simgrid writes beside a trace of packets FILE.csv.gz: FILE.xml, the platform, and FILE.replay.
struct ReplayFiles {
    explicit ReplayFiles(const std::string& packets);
    std::string platform, replay;
};

/// Refuses the options that say nothing to this machine: UserError with the option, the reason and the remedy.
void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine);

/// What the torus renderer needs. UserError names the option that is out of range.
TorusSettings torus_settings(const RenderOptions& options, const TorusOptions& torus, const Scene& scene);

}  // namespace raya
