// Renders a scene on a model of a torus machine. Each node stores some voxels of the scene, and nodes send rays to each
// other as packets.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/array/checkpoints.hpp"
#include "host/base/checkpoint.hpp"
#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/node_array.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/torus/torus_result.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Contributions, sorted by pixel, then by position in the pixel's ray tree. This is the order of summation.
struct Contributions {
    std::vector<float> colours;         // [contribution][4]: red, green, blue, weight
    std::vector<std::uint32_t> starts;  // [pixels + 1]: index of each pixel's first contribution
};

/// Sorts the contributions of return packets. `returns`: heads of the packets, in any order. `pixels`: number of pixels
/// in the image. Throws std::logic_error for a pixel >= `pixels` and for two packets with the same position in a
/// pixel's ray tree. Throws UserError for more than 2^32 packets.
Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels);

using ComposeKernel = DescribedKernel<"torus/compose.cl", "compose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                      Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;

/// Renders images of one scene. All ranks must make the same calls in the same order.
class TorusRenderer {
  public:
    /// Collective: packs and divides the scene, checks that it fits the nodes, builds the kernels and allocates the
    /// device memory for the nodes of this rank. Only rank 0 reads `scene`; it calls `packed`, if not empty, when it no
    /// longer needs the scene's objects. Throws UserError if the scene does not fit,
    /// a setting is out of range or there are more ranks than nodes, and DeviceError if the device fails.
    TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks = Ranks::single(),
                  const std::function<void()>& packed = {});

    /// Renders one image; can be called repeatedly. All ranks must set the same members of `observers`. In ranks other
    /// than 0 the result has no image and no counts. Throws TorusDeadlock, or std::logic_error if RenderObservers::work
    /// is set without TorusSettings::history, or if checkpointing is combined with observers. With `checkpointing`, a
    /// checkpoint may be saved in each superstep. A resumed render returns the same image and counts as an
    /// uninterrupted one; its times are the sums over all runs.
    TorusResult render(const ProgressCallback& progress = {}, const RenderObservers& observers = {},
                       const Checkpointing* checkpointing = nullptr);

    /// Returns the factor by which the scene's lengths are multiplied.
    const LengthScale& scale() const { return job_.scale; }

    /// Sets the capacity of the queues, in packets, for the following images. The queues may exceed a node's memory.
    /// Throws UserError if the queues exceed the device's maximum buffer, and DeviceError if the device fails.
    void set_queue(std::uint32_t queue);

  private:
    void build();
    void run_supersteps(TorusRun& run, Checkpoints& checkpoints, const ProgressCallback& progress,
                        const RenderObservers& observers);
    void add_superstep(TorusRun& run, const NodeStatus& status, const MachineState& state,
                       const std::vector<std::uint64_t>& words, const SuperstepSink& sink) const;
    NodeStatus compute(TorusRun& run, bool injects, const RenderObservers& observers);
    void compose(TorusResult& result, const std::vector<raya_head>& returns);
    std::vector<float> sum(const Contributions& contributions);
    void collect(TorusResult& result);
    void check(const TorusResult& result) const;
    void describe(TorusResult& result) const;
    void visit_state(RenderState& state, TorusRun& run, NodeStatus& status);

    Session& session_;
    Ranks& ranks_;
    TorusSettings settings_;
    std::string scene_name_;
    NodeDistribution distribution_;
    TorusJob job_;
    std::unique_ptr<NodeArray> nodes_;
    std::optional<ComposeKernel> compose_;  // for one lane
    double build_s_ = 0;
};

}  // namespace raya
