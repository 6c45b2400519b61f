// Renders a scene on a model of a torus machine: nodes hold voxels of the scene, rays travel between them as packets.
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
    /// Partitions and packs the scene, checks that it fits the nodes, builds the kernels and takes the device memory
    /// for the nodes of this rank. Only rank 0 looks at the scene. Throws UserError (what does not fit, what is out of
    /// range, more ranks than nodes), DeviceError.
    TorusRenderer(Session& session, const Scene& scene, const TorusSettings& settings, Ranks& ranks = Ranks::alone());
    ~TorusRenderer();

    /// One image; may be called again. `sink`, where given, is told of every packet between nodes, in the order of
    /// supersteps, then sources, or of those of supersteps 0, `packets_every`, ... alone, since telling takes time;
    /// `step_sink` of every superstep; `work_sink` of what every node did in every superstep, for settings with
    /// `history` alone (std::logic_error), on one rank. Throws Standstill. In other ranks than 0 the result is without
    /// image and counts, and sinks are given but not told.
    TorusResult render(const ProgressCallback& progress = {}, const PacketSink& sink = {},
                       const SuperstepSink& step_sink = {}, std::uint32_t packets_every = 1,
                       const NodeWorkSink& work_sink = {});

    /// By what the scene's lengths are multiplied.
    const LengthScale& scale() const;

    /// Other pixels for the images that follow: groups of a machine render in turn without building anew.
    void set_pixels(const PixelSubset& pixels);

    /// Queues of that many packets for the images that follow, whatever a node's memory holds. UserError where the
    /// device cannot hold them, DeviceError.
    void set_queue(std::uint32_t queue);

    /// Whether the machine comes to its end: an image's supersteps alone.
    bool ends();

    /// What longer queues than this machine's are weighed against and tried with. It refers to the renderer, which
    /// keeps the last queue that was tried.
    QueueTrial queue_trial();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace raya
