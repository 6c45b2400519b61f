// What the SPA takes for an image by the time model, on the clock of spa_clock.hpp: for one render, and, from one cost
// image, for every offset of the cyclic mapping, computing and rotations together.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/time_model.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/scene.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/spa_clock.hpp"

namespace raya {

/// An image made on PEs of the SPA: what its host and PEs counted.
struct SpaRun {
    std::string machine;          // "spa"; "grande", its PEs without limit, where the scene does not fit it
    std::vector<Load> phases;     // the first pass, and supersampling
    std::vector<CostImage> cost;  // of each phase
    SmoothingCycles smoothing;
    Communication communication;
    std::uint64_t pixels = 0, recomputed = 0;
    Image image;
};

/// Renders `size` x `size` pixels on `pes` PEs under the cyclic mapping. Throws UserError, DeviceError as RingRenderer
/// does.
SpaRun run_on_spa(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t pes,
                  std::uint32_t offset, AntialiasMethod method = AntialiasMethod::kNone);

/// The SPA's modelled time for the run, computing multiplied by `factor`. Exchanges between neighbours, two or more
/// rotations, take their set-up too (paper::kExchangeSetupMs).
ModelledTime spa_time(const SpaRun& run, double factor);

/// "p = 16"
std::string offset_name(std::uint32_t offset);

/// Modelled milliseconds of one offset. Broadcast and gather are not in it: they take the same for every
/// offset.
struct OffsetTime {
    std::uint32_t offset = 0;
    double imbalance = 0;       // u of the first pass
    double trace_ms = 0;        // of the busiest PE in the first pass
    double smooth_ms = 0;       // means or comparisons
    double supersample_ms = 0;  // of the busiest PE in supersampling
    double ring_ms = 0;         // rotations and the exchange's set-up
    std::uint64_t rotations = 0;

    double total_ms() const { return trace_ms + smooth_ms + supersample_ms + ring_ms; }
};

/// Rotations that bring each PE its neighbours' pixels once from each side: those of NeighbourExchange, where whole
/// shares go round.
std::uint64_t neighbour_rotations(const raya_mapping& mapping);

/// Of the offsets 0..W-1, cyclic fold. `costs.supersample` may be empty where the method is another. The PEs have room
/// for the shares that go round. Computing is multiplied by `factor`. Takes O(W pixels).
std::vector<OffsetTime> offset_times(const Costs& costs, std::uint32_t pes, AntialiasMethod method, double factor);

/// Pixels a side of the image in which a scene's offsets are compared, unless asked for: the scene's own size where it
/// is square, else 256, halved while the scene's objects would make it take minutes.
std::uint32_t usual_size(const Scene& scene);

/// One offset, rendered with anti-aliasing, on the clock of a factor.
struct SmoothedOffset {
    std::uint32_t offset = 0;
    SpaRun run;
    double factor = 1;

    std::string name() const { return offset_name(offset); }
    std::uint64_t rotations() const { return run.communication.rotations; }
    ModelledTime time() const { return spa_time(run, factor); }
    double communication_ms() const { return time().communication_ms; }
    double filter_ms() const { return time().filter_ms; }
    double compare_ms() const { return time().compare_ms; }
    double trace_ms() const { return factor * spa_ms(static_cast<double>(run.phases.front().max)); }
    double supersample_ms() const { return factor * spa_ms(static_cast<double>(run.phases.back().max)); }
    double imbalance() const { return run.phases.back().imbalance; }
    double filtering_ms() const { return filter_ms() + communication_ms(); }
    double filtered_ms() const { return trace_ms() + filtering_ms(); }
    double alone_ms() const { return compare_ms() + supersample_ms(); }
    double with_first_ms() const { return alone_ms() + trace_ms(); }
};

/// A scene smoothed with a PE for each column: three offsets rendered, every one from their costs.
struct SmoothingRuns {
    LabelledScene scene;
    std::uint32_t size = 0;
    double recomputed = 0;                  // share of the pixels
    std::vector<SmoothedOffset> rows = {};  // p = 0, 8, 16
    Costs costs;                            // of the last
    AntialiasMethod method = AntialiasMethod::kNone;

    const SmoothedOffset& first() const { return rows.front(); }
    const SmoothedOffset& last() const { return rows.back(); }
    SmoothingRuns by_factor(double factor) const;  // the same on another clock
    std::vector<OffsetTime> times(double factor) const { return offset_times(costs, size, method, factor); }
    /// The offsets 0..16 of them.
    std::vector<OffsetTime> near(double factor) const;
};

/// Of the scene for studies of one, in the laboratory's size, else 256, by machine_factor(). Throws UserError,
/// DeviceError as run_on_spa().
SmoothingRuns smoothing_runs(Laboratory& lab, const Scenes& scenes, AntialiasMethod method);

}  // namespace raya
