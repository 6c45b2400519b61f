// What a polygon's outline says about its plane; shared by the reader, the packer and the reference renderer.
#pragma once
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// The normal of a polygon by Newell's sum over its edges: it points to the side from which the `vertices` (any number,
/// in order) run counter-clockwise, and its length is twice the area. Not normalised: a zero area gives about zero.
Vec3 newell_normal(const std::vector<Vec3>& vertices);

/// The axis (0 = x, 1 = y, 2 = z) along which a plane with this normal is flattened to two coordinates: that of the
/// component of largest magnitude, of equals the first.
int dropped_axis(const Vec3& normal);

}  // namespace raya
