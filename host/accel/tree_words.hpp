// The tree that a PE of the ring machine walks its rays through: built over a job's objects, and packed behind it.
#pragma once
#include "host/model/accel.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"

namespace raya {

/// Appends a tree over the finite objects of a job to its words, as kernels/shared/bvh.h lays it out, and points
/// accel_at to it. Boxes hold every point at which the kernels can compute a hit of what is in them (hit_regions.hpp),
/// and room for the walk's rounding. UserError where its rows are too many.
AccelSummary append_tree(PackedJob& job, const NumberFormat& format);

/// Whether a tree is sooner than testing every ray against all objects, as measured on a CPU of sixteen lanes.
bool tree_pays(const Scene& scene, const NumberFormat& format);

}  // namespace raya
