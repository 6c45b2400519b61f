// `raya bench --build`: compile times of the kernels of each format and variant.
#pragma once
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/report/bench_report.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Builds and launches the kernels that renders in these formats and variants (none, grid, bvh, torus) need, bypassing
/// the driver's cache. The first variant includes the anti-aliasing kernels. DeviceError; UserError: unknown variant.
std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats,
                                     const std::vector<std::string>& variants);

void print_builds(const std::vector<BenchBuild>& builds);

}  // namespace raya
