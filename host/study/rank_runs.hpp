// Renders by this program on ranks: `mpirun -n R raya render`, and what its report tells.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/ranks/mpirun.hpp"
#include "host/ranks/ping.hpp"

namespace raya {

/// What rank 0 has done of one label and kind.
struct RankedCommand {
    std::string label, kind;  // as in LabelSummary
    double seconds = 0;       // on the device
    std::uint64_t launches = 0;
};

struct RankedRender {
    double render_s = 0;  // measured: everything after the kernel build
    std::string hash, device, platform;
    std::uint32_t width = 0, height = 0;
    std::uint64_t rays = 0;  // of all kinds
    double work = 0;         // modelled cycles of all PEs or nodes
    std::vector<RankedCommand> commands;

    /// Measured, on rank 0's device: all commands; those of one label.
    double device_s() const;
    double device_s(const std::string& label) const;
    /// A device that computes on the processors of its host, which the ranks there share.
    bool on_processors() const { return platform == "Portable Computing Language"; }
};

/// Of a report of `raya render`. JsonError for another document.
RankedRender ranked_render(const Json& report);

/// Renders on so many ranks: `arguments` of render, scene and options, without files to be written. `threads` as in
/// Mpirun::command(). The image goes into a folder for temporary files (TMPDIR), which rank 0 must have as well.
/// RanksFailure.
RankedRender render_on_ranks(const Mpirun& mpirun, std::uint32_t ranks, std::optional<std::uint32_t> threads,
                             const std::vector<std::string>& arguments);

/// A ping-pong between so many ranks, two at least. RanksFailure.
PingReport ping_of(const Mpirun& mpirun, std::uint32_t ranks, std::optional<std::uint32_t> threads = {});

}  // namespace raya
