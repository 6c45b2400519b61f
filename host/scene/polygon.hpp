// Normal and triangulation of a polygon, shared by the reader, the packer and the reference renderer.
#pragma once
#include <array>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// Returns the normal of a polygon, computed by Newell's sum over its edges. It points to the side from which the
/// `vertices` (any number, in order) are counter-clockwise. It is not normalised: its length is twice the polygon's
/// area, and about 0 for a degenerate polygon.
Vec3 newell_normal(const std::vector<Vec3>& vertices);

/// Returns the axis (0 = x, 1 = y, 2 = z) along which a plane with this normal is projected to two dimensions: the axis
/// of the normal's component of largest magnitude; on a tie the first.
int dropped_axis(const Vec3& normal);

/// Cuts a planar polygon into vertices.size() - 2 triangles of vertex indices (none for fewer than three vertices).
/// `normal`: the polygon's normal, of any length and either sign. Every triangle has the orientation of the polygon,
/// and every vertex is used, even one on a straight edge. A self-intersecting outline has no correct triangulation; if
/// it has no ear, its remaining vertices are cut into a fan. Source: ear clipping (G. H. Meisters, "Polygons have
/// ears", Amer. Math. Monthly 82, 1975), in the two coordinates other than dropped_axis(); its time grows with the
/// square of the number of vertices or faster. Throws UserError for more than kMaxCutCorners vertices.
inline constexpr std::size_t kMaxCutCorners = 10'000;
std::vector<std::array<int, 3>> triangulate(const std::vector<Vec3>& vertices, const Vec3& normal);

/// Returns the triangles of triangulate() as polygons, with the normals and the surface of `polygon`.
std::vector<Polygon> triangles_of(const Polygon& polygon);

}  // namespace raya
