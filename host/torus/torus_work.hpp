// What the kernels of a torus render did, for the roofline.
#pragma once
#include <vector>

#include "host/report/roofline.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// One for each kernel. Events are counted for a node as a whole: those of primary rays are the operations of inject,
/// all others those of trace_voxel, the entry of primary rays into the box among them. Bytes, at least:
///   - trace_voxel, inject, route: at each launch the scene's words of all nodes, where kernels copy them;
///   - trace_voxel: a ray packet read for each voxel that one was tested in, a packet written for each one made that is
///     no primary ray; inject: a packet written for each primary ray;
///   - route: rays read and written for each link that they take, returns once; accept: each packet read and written
///     for each link;
///   - compose: each contribution read, each pixel's place read and its colour written.
/// Status and counters of nodes are not in it, nor packets that wait.
std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& result);

}  // namespace raya
