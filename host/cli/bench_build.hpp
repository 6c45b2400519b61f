// `raya bench --build`: measures the compile times of the kernels of each format and variant.
#pragma once
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/report/bench_report.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Renders the scene once for each pair of a format and a variant (none, grid, bvh, packets or torus). Returns the
/// build time, the time of the first launch and the binary size of each kernel. A unique build option bypasses the
/// driver's cache. If the first variant is a ring machine without dynamic mapping, also renders the scene on this
/// machine with each of the two anti-aliasing methods. Throws DeviceError, and UserError for an unknown variant.
std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats,
                                     const std::vector<std::string>& variants);

void print_builds(const std::vector<BenchBuild>& builds);

}  // namespace raya
