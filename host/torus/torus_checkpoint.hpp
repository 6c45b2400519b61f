// Checkpoints of a torus render, taken between routing and the transfer of packets.
#pragma once
#include <cstdint>

#include "host/base/checkpoint.hpp"
#include "host/base/clock.hpp"
#include "host/ranks/ranks.hpp"
#include "host/torus/node_array.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_state.hpp"

namespace raya {

/// The checkpoints of one render.
class TorusCheckpoints {
  public:
    /// Collective. Without `checkpointing`, resume() returns false and save_if_due() does nothing.
    TorusCheckpoints(const Checkpointing* checkpointing, const TorusSettings& settings, const TorusJob& job,
                     const NodeDistribution& distribution, Ranks& ranks);

    /// Collective: continues from the checkpoint, if there is one, and returns true if so.
    bool resume(NodeArray& nodes, TorusRun& run);

    /// Collective: saves a checkpoint if one is due. `status`: that of the nodes after routing. `fraction`: completed
    /// fraction of the render.
    void save_if_due(NodeArray& nodes, const NodeStatus& status, TorusRun& run, double fraction);

    /// Measured time of earlier runs, seconds.
    double earlier_s() const { return earlier_s_; }

  private:
    const Checkpointing* checkpointing_;
    Ranks& ranks_;
    NodeBuffers buffers_;
    StateSettings settings_;
    std::uint32_t nodes_;
    double earlier_s_ = 0;
    Clock::time_point start_ = Clock::now();
};

}  // namespace raya
