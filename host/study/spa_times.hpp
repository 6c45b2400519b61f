// What the SPA takes for an image by the time model, and the one factor that may be fitted to the paper.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/machine/time_model.hpp"
#include "host/ring/ring_renderer.hpp"
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

}  // namespace raya
