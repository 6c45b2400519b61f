// Where the studies of static load distribution get their material: what each pixel of a scene costs.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/ranks/ping.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/cost_image.hpp"
#include "host/study/scenes.hpp"

namespace raya {

/// What one render told. From it follows the load of every array and mapping, since a static load is the sum of its
/// pixels' costs.
struct Costs {
    std::string label;
    CostImage trace;        // modelled cycles of each pixel in the first pass
    CostImage supersample;  // ... in supersampling; empty without
    EventCounts events{};   // of the first pass
    std::size_t objects = 0;
    std::size_t job_words = 0;     // what a PE holds of the scene
    std::uint64_t recomputed = 0;  // pixels supersampled
    double device_s = 0;           // measured: tracing both passes on the device
};

/// The format in which studies render a scene: the SPA's, but fp32 for a scene that none of its PEs could hold. No SPA
/// is modelled then anyway, and fp32's polygons take a sixth of the time.
NumberFormat format_for(const Scene& scene);

/// Renders scenes as PEs of the SPA do (its bounces, the scene's format), without its memory limit, each once for a
/// size and method, and keeps what their pixels cost.
class Laboratory {
  public:
    /// `size`: pixels a side of the studies' images; 0: what the study takes by default. `network`: the user's, for
    /// those that model one.
    Laboratory(Session& session, std::uint32_t size, const std::optional<Network>& network = {})
        : session_(session), size_(size), network_(network) {}

    /// The size that was asked for, else `usual`.
    std::uint32_t size(std::uint32_t usual) const { return size_ ? size_ : usual; }
    Session& session() { return session_; }
    const std::optional<Network>& network() const { return network_; }

    /// Stays valid as long as the laboratory. Throws UserError, DeviceError as RingRenderer does.
    const Costs& costs(const LabelledScene& scene, std::uint32_t size, AntialiasMethod method = AntialiasMethod::kNone);

  private:
    struct Known {
        LabelledScene scene;  // a label alone does not tell scenes apart: a user's file may be called "centre"
        std::uint32_t size;
        AntialiasMethod method;
        std::unique_ptr<Costs> costs;  // stays where it is when others come
    };

    Session& session_;
    std::uint32_t size_;
    std::optional<Network> network_;
    std::vector<Known> known_;
};

/// Milliseconds that a PE of the SPA takes for so many modelled cycles, no factor.
double spa_ms(double cycles);

}  // namespace raya
