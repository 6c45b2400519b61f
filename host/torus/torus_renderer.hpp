// Renders a scene on a model of a torus machine: nodes hold voxels of the scene and exchange rays as packets.
#pragma once
#include <cstdint>
#include <memory>

#include "host/base/progress.hpp"
#include "host/cl/commands.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

class TorusRenderer {
  public:
    /// Partitions and packs the scene, checks that it fits the nodes, builds the kernels and allocates the device
    /// memory for the nodes of this rank. Only rank 0 reads the scene. Throws UserError (the scene does not fit, a
    /// setting is out of range, more ranks than nodes) or DeviceError.
    TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks = Ranks::alone());
    ~TorusRenderer();

    /// Renders one image; may be called again. All ranks must pass the same kinds of observers. In ranks other than 0
    /// the result has no image and no counts. Throws TorusDeadlock, or std::logic_error for an observer of work without
    /// TorusSettings::history.
    TorusResult render(const ProgressCallback& progress = {}, const RenderObservers& observers = {});

    /// The factor by which the scene's lengths are multiplied.
    const LengthScale& scale() const;

    /// Sets the pixels of the following images, so that groups of a machine can render in turn with the same kernels.
    void set_pixels(const PixelSubset& pixels);

    /// Sets the queue length of the following images, regardless of a node's memory. Throws UserError if the device
    /// cannot hold the queues, or DeviceError.
    void set_queue(std::uint32_t queue);

    /// Runs the supersteps of an image; returns true if they complete, false on a deadlock.
    bool ends();

    /// Limits and callbacks for find_longer_queue(). They refer to the renderer, which keeps the last queue tried.
    QueueTrial queue_trial();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace raya
