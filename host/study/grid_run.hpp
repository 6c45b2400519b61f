// Renders through a grid in one PE: what the studies of voxels count and time.
#pragma once
#include <cstdint>
#include <string>

#include "host/accel/partition.hpp"
#include "host/cl/commands.hpp"
#include "host/model/machine.hpp"
#include "host/report/render_report.hpp"
#include "host/scene/packer.hpp"
#include "host/study/measured.hpp"
#include "host/study/scenes.hpp"

namespace raya {

struct GridSettings {
    std::uint32_t side = 0;  // of the image, pixels
    std::uint32_t bounces = 0;
    Sampling sampling = Sampling::kCentres;
    int runs = 1;  // samples that are timed, each of renders that take 20 ms together
};

/// Modelled milliseconds that one T805 computes for these events, and no message (machine/t805.hpp).
double t805_ms(const EventCounts& events);

/// One scene, one grid.
struct GridRun {
    std::string label;          // of the scene
    std::uint64_t objects = 0;  // of the scene
    Divisions divisions{};      // of the box of its finite objects
    std::uint64_t copies = 0;   // entries of the voxels' lists beyond each object's first
    EventCounts events{};       // of one image
    double measured_ms = 0;     // least time of tracing one image on the device, after a warm-up
    double median_ms = 0;       // ... and the median

    std::uint64_t voxels() const { return std::uint64_t{divisions[0]} * divisions[1] * divisions[2]; }
    std::string sides() const;  // "4x4x2"
    std::uint64_t rays() const { return ray_count(events); }
    double tests() const { return static_cast<double>(test_count(events)); }
    double modelled_s() const { return 1e-3 * t805_ms(events); }
    /// Into how many voxels an object comes.
    double voxels_of_object() const { return 1 + static_cast<double>(copies) / static_cast<double>(objects); }
};

/// Renders the scene in fp32 on one PE of `grande`, every ray walking through the grid. Throws UserError, DeviceError
/// as RingRenderer does.
GridRun run_grid(Session& session, const LabelledScene& scene, const Divisions& divisions,
                 const GridSettings& settings);

}  // namespace raya
