// What a render on a ring machine made, counted and measured.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/image/image.hpp"
#include "host/model/accel.hpp"
#include "host/model/communication.hpp"
#include "host/model/load.hpp"
#include "host/model/machine.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/cost_image.hpp"
#include "host/ring/pe_memory.hpp"
#include "host/scene/length_scale.hpp"

namespace raya {

/// Names of the phases, and labels of their commands.
inline constexpr const char *kTracePass = "trace", *kSupersamplePass = "supersample";

/// What was counted in one phase of a render.
struct Phase {
    std::string name;  // kTracePass, kSupersamplePass
    EventCounts events{};
    Load load;                           // modelled cycles of each PE, from its own counters
    std::optional<CostImage> kept_cost;  // where RingSettings::keep_costs asks for it

    /// Modelled cycles of each pixel. std::logic_error where nobody asked for them.
    const CostImage& cost() const;
};

struct RingResult {
    Image image;
    std::vector<Phase> phases;              // the first pass, and supersampling where it was asked for
    Phase all;                              // their sums, but for the cost of a single phase: cost()
    Image mask;                             // 1 where a pixel was supersampled, else 0; empty without supersampling
    std::uint64_t recomputed = 0;           // pixels supersampled
    std::optional<std::uint64_t> requests;  // of a simulated dynamic distribution
    Communication communication;
    LengthScale scale;
    PeMemory pe_memory;
    std::optional<AccelSummary> accel;  // of the grid or tree that rays walked
    bool words_local = true;            // PEs copied the broadcast words into local memory at each launch
    std::uint32_t parts_here = 0;       // PEs of this rank
    RankTraffic traffic;                // of this rank, while it rendered
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;  // where lanes, group and what goes with them come from (host/cl/tuned.hpp)
    // Measured on the host: to make the grid or tree; kernel build; everything after it.
    double accel_s = 0, build_s = 0, render_s = 0;
    double earlier_s = 0;  // of render_s what runs took whose state this one went on with
    std::vector<LabelSummary> commands;

    /// Modelled cycles of each pixel in all phases. std::logic_error where nobody asked for them.
    const CostImage& cost() const { return (phases.size() == 1 ? phases.front() : all).cost(); }
};

/// Seconds that tracing one image took on the device; by the host's clock where the device does not time its commands.
double trace_seconds(const RingResult& result);

}  // namespace raya
