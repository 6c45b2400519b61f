// Renders a scene on a model of a torus machine. Each node stores some voxels of the scene, and nodes send rays to each
// other as packets.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

#include "host/base/checkpoint.hpp"
#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// Renders images of one scene. All ranks must make the same calls in the same order.
class TorusRenderer {
  public:
    /// Collective: packs and divides the scene, checks that it fits the nodes, builds the kernels and allocates the
    /// device memory for the nodes of this rank. Only rank 0 reads `scene`; it calls `packed`, if not empty, when it no
    /// longer needs the scene's objects. Throws UserError if the scene does not fit,
    /// a setting is out of range or there are more ranks than nodes, and DeviceError if the device fails.
    TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks = Ranks::single(),
                  const std::function<void()>& packed = {});
    ~TorusRenderer();

    /// Renders one image; can be called repeatedly. All ranks must set the same members of `observers`. In ranks other
    /// than 0 the result has no image and no counts. Throws TorusDeadlock, or std::logic_error if RenderObservers::work
    /// is set without TorusSettings::history, or if checkpointing is combined with observers. With `checkpointing`, a
    /// checkpoint may be saved in each superstep. A resumed render returns the same image and counts as an
    /// uninterrupted one; its times are the sums over all runs.
    TorusResult render(const ProgressCallback& progress = {}, const RenderObservers& observers = {},
                       const Checkpointing* checkpointing = nullptr);

    /// Returns the factor by which the scene's lengths are multiplied.
    const LengthScale& scale() const;

    /// Chooses the pixels that the following renders compute, so that one renderer can render the pixel subsets of
    /// several groups of nodes one after another.
    void set_pixels(const PixelSubset& pixels);

    /// Sets the capacity of the queues, in packets, for the following images. The queues may exceed a node's memory.
    /// Throws UserError if the queues do not fit the device, and DeviceError if the device fails.
    void set_queue(std::uint32_t queue);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace raya
