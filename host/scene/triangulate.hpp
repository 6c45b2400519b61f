// A polygon of any simple outline, cut into triangles.
#pragma once
#include <array>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

/// Cuts a planar polygon into vertices.size() - 2 triangles of vertex indices (none for fewer than three vertices).
/// `normal` is the polygon's, of any length and either sign. Every triangle runs around in the polygon's own sense, and
/// every vertex is used, those on a straight edge too. An outline that crosses itself has no right answer: where no ear
/// is left, the corners that remain are cut as a fan.
/// Source: ear clipping (G. H. Meisters, "Polygons have ears", Amer. Math. Monthly 82, 1975), in the plane's two
/// coordinates that remain without the dropped axis.
std::vector<std::array<int, 3>> triangulate(const std::vector<Vec3>& vertices, const Vec3& normal);

}  // namespace raya
