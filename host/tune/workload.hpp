// What is rendered to tune a device: one scene for each way in which kernels work.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/tuned.hpp"
#include "host/model/image_size.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// A way to render (none, grid, bvh: the ring machine with that accelerator; torus: 4 x 4 x 4 nodes) in a format.
struct Workload {
    std::string way;
    NumberFormat format{};

    TunedFor what() const;
    std::string name() const;  // "ring none fp32", "torus fp32"
};

/// What is tuned where nothing else is asked for: the ring without accelerator in fp32 and e6m15, with either
/// accelerator in fp32, and the torus in fp32.
std::vector<Workload> usual_workloads();

/// What a workload renders: `given`, where a user brings a scene, else 30 spheres and a plane for ways that test all
/// objects, and SPD's balls of 7,381 spheres for those that do not. No side: 512 pixels, with an accelerator and on the
/// torus 256.
struct WorkloadPicture {
    Scene scene;
    ImageSize size{};
    std::uint32_t pes = 256;  // of the ring
};
WorkloadPicture picture_of(const Workload& workload, const Scene* given, const ImageSize& size, std::uint32_t pes);

/// A renderer that has rendered once, so that its kernels are built.
struct TrialRender {
    double build_s = 0;
    std::string check;                // hash of the image, and how many rays there were
    std::function<double()> image_s;  // renders once more: how long it took, from packed scene to image
};

/// Calls `built` before the first image. DeviceError where kernels are not built, or rendering fails.
TrialRender prepare_render(Session& session, const Workload& workload, const WorkloadPicture& picture,
                           const KernelChoice& kernels, const std::function<void()>& built);

}  // namespace raya
