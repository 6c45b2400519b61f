// What the SPA takes for an image by the time model, and the one factor that may be fitted to the paper: for one
// render, and, from one cost image, for every offset of the cyclic mapping, computing and rotations together.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/machine/time_model.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/scene.hpp"
#include "host/study/laboratory.hpp"

namespace raya {

/// An image made on PEs of the SPA: what its host and PEs counted.
struct SpaRun {
    std::string machine;          // "spa"; "grande", its PEs without limit, where the scene does not fit it
    std::vector<Load> phases;     // the first pass, and supersampling
    std::vector<CostImage> cost;  // of each phase
    SmoothingCycles smoothing;
    Communication communication;
    std::uint64_t pixels = 0, recomputed = 0;
};

/// Renders `size` x `size` pixels on `pes` PEs under the cyclic mapping. Throws UserError, DeviceError as RingRenderer
/// does.
SpaRun run_on_spa(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t pes,
                  std::uint32_t offset, AntialiasMethod method = AntialiasMethod::kNone);

/// The SPA's modelled time for the run, computing multiplied by `factor`.
ModelledTime spa_time(const SpaRun& run, double factor = 1);

/// The one factor of Tables 2, 3 and 4: what one DSP of the paper took for a pixel of its scene (Table 2) over what the
/// model gives for a pixel of this first pass. At the paper's size that is 64,800 ms over one PE's modelled time.
double fitted_factor(const CostImage& trace);

/// "p = 16"
std::string offset_name(std::uint32_t offset);

/// Modelled milliseconds of one offset, no factor. Broadcast and gather are not in it: they take the same for every
/// offset.
struct OffsetTime {
    std::uint32_t offset = 0;
    double imbalance = 0;       // u of the first pass
    double trace_ms = 0;        // of the busiest PE in the first pass
    double smooth_ms = 0;       // means or comparisons
    double supersample_ms = 0;  // of the busiest PE in supersampling
    double ring_ms = 0;
    std::uint64_t rotations = 0;

    double total_ms() const { return trace_ms + smooth_ms + supersample_ms + ring_ms; }
};

/// Rotations that bring each PE its neighbours' pixels once from each side: those of NeighbourExchange, where whole
/// shares go round.
std::uint64_t neighbour_rotations(const raya_mapping& mapping);

/// Of the offsets 0..W-1, cyclic fold. `costs.supersample` may be empty where the method is another. The PEs have room
/// for the shares that go round. Takes O(W pixels).
std::vector<OffsetTime> offset_times(const Costs& costs, std::uint32_t pes, AntialiasMethod method);

/// Pixels a side of the image in which a scene's offsets are compared, unless asked for: the scene's own size where it
/// is square, else 256, halved while the scene's objects would make it take minutes.
std::uint32_t usual_size(const Scene& scene);

/// One offset, rendered with anti-aliasing.
struct SmoothedOffset {
    std::uint32_t offset = 0;
    std::uint64_t rotations = 0;
    ModelledTime plain, fitted;
    Load first, again;  // of the first pass; of supersampling

    std::string name() const { return offset_name(offset); }
    double communication_ms() const { return plain.communication_ms; }
    double compare_ms() const { return plain.compare_ms; }
    double trace_ms() const { return spa_ms(static_cast<double>(first.max)); }
    double supersample_ms() const { return spa_ms(static_cast<double>(again.max)); }
    double imbalance() const { return again.imbalance; }
    double alone_ms() const { return compare_ms() + supersample_ms(); }
    double with_first_ms() const { return alone_ms() + trace_ms(); }
};

/// A scene smoothed with a PE for each column: three offsets rendered, every one from their costs.
struct SmoothingRuns {
    LabelledScene scene;
    std::uint32_t size = 0;
    double factor = 1, recomputed = 0;      // share of the pixels
    std::vector<SmoothedOffset> rows = {};  // p = 0, 8, 16
    std::vector<OffsetTime> times = {};     // every p, from the cost images, nothing fitted

    const SmoothedOffset& first() const { return rows.front(); }
    const SmoothedOffset& last() const { return rows.back(); }
    std::span<const OffsetTime> near() const { return std::span(times).first(std::min<std::size_t>(17, size)); }
};

/// Of the scene for studies of one, in the laboratory's size, else 256. Throws UserError, DeviceError as run_on_spa().
SmoothingRuns smoothing_runs(Laboratory& lab, const Scenes& scenes, AntialiasMethod method);

}  // namespace raya
