// `raya bench --build`: what the driver's compiler takes for the kernels of each format and variant.
#pragma once
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/report/bench_report.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Builds and launches, from source whatever the driver keeps, the kernels that renders of these formats and variants
/// (none, grid, bvh, torus) need, those that smooth among the first variant's. DeviceError; UserError for a variant
/// that there is not.
std::vector<BenchBuild> bench_builds(Session& session, const Scene& scene, RingSettings settings,
                                     const std::vector<NumberFormat>& formats, const std::vector<std::string>& variants);

void print_builds(const std::vector<BenchBuild>& builds);

}  // namespace raya
