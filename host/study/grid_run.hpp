// Renders through a grid in one PE: what the studies of voxels count and time.
#pragma once
#include <cstdint>
#include <string>

#include "host/cl/commands.hpp"
#include "host/grid/partition.hpp"
#include "host/machine/machine.hpp"
#include "host/scene/packer.hpp"
#include "host/study/measured.hpp"
#include "host/study/scenes.hpp"

namespace raya {

struct GridSettings {
    std::uint32_t side = 0;  // of the image, pixels
    std::uint32_t bounces = 0;
    Sampling sampling = Sampling::kCentres;
    int runs = 1;  // renders that are timed
};

/// One scene, one grid.
struct GridRun {
    std::string label;          // of the scene
    std::uint64_t objects = 0;  // of the scene
    Divisions divisions{};      // of the box of its finite objects
    std::uint64_t copies = 0;   // entries of the voxels' lists beyond each object's first
    EventCounts events{};       // of one image
    double measured_ms = 0;     // least time of tracing one image on the device
};

/// Renders the scene in fp32 on one PE of `grande`, every ray walking through the grid. Throws UserError, DeviceError
/// as RingRenderer does.
GridRun run_grid(Session& session, const LabelledScene& scene, const Divisions& divisions,
                 const GridSettings& settings);

std::uint64_t voxels_of(const GridRun& run);

/// Primary, reflected, refracted and shadow rays.
std::uint64_t rays_of(const EventCounts& events);

/// Rays against spheres, planes, polygons and cones.
std::uint64_t tests_of(const EventCounts& events);

/// Modelled milliseconds that one T805 computes for these events, and no message (machine/t805.hpp).
double t805_ms(const EventCounts& events);

}  // namespace raya
