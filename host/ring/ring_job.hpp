// What every PE of the ring holds of the scene, and what ranks that have not read it must know.
#pragma once
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/model/accel.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/ring_settings.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// A job with the grid or tree behind it, and what was made of that.
struct RingJob {
    PackedJob job;
    AccelSummary accel;
    double accel_s = 0;  // measured: to make it
    LengthScale scale;
    std::uint64_t objects = 0;
};

/// The words of a scene for this machine, without accelerator.
PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale);

/// Puts the settings' accelerator behind them, which is not none.
AccelSummary append_accel(PackedJob& job, const RingSettings& settings);

/// Packed by rank 0 and sent to all; elsewhere `scene` is not looked at.
RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks);

}  // namespace raya
