// What a polygon's outline says about its plane, and its triangles; shared by the reader, the packer and the
// reference renderer.
#pragma once
#include <array>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// The normal of a polygon by Newell's sum over its edges: it points to the side from which the `vertices` (any number,
/// in order) run counter-clockwise, and its length is twice the area. Not normalised: a zero area gives about zero.
Vec3 newell_normal(const std::vector<Vec3>& vertices);

/// The axis (0 = x, 1 = y, 2 = z) along which a plane with this normal is flattened to two coordinates: that of the
/// component of largest magnitude, of equals the first.
int dropped_axis(const Vec3& normal);

/// Cuts a planar polygon into vertices.size() - 2 triangles of vertex indices (none for fewer than three vertices).
/// `normal` is the polygon's, of any length and either sign. Every triangle runs around in the polygon's own sense, and
/// every vertex is used, those on a straight edge too. An outline that crosses itself has no right answer: where no ear
/// is left, the corners that remain are cut as a fan.
/// Source: ear clipping (G. H. Meisters, "Polygons have ears", Amer. Math. Monthly 82, 1975), in the plane's two
/// coordinates that remain without the dropped axis.
std::vector<std::array<int, 3>> triangulate(const std::vector<Vec3>& vertices, const Vec3& normal);

}  // namespace raya
