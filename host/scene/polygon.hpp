// Normal and triangulation of a polygon, shared by the reader, the packer and the reference renderer.
#pragma once
#include <array>
#include <functional>
#include <string>
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

// Validation of polygon outlines, views and colours from scene files and the command line.

/// Shorter lengths are treated as 0, because products of four lengths must not underflow a double. Scenes may use any
/// unit of length; length_scale() handles lengths that are too small for a number format.
inline constexpr double kMinSceneLength = 1e-30;

/// Maximum magnitude of lengths, so that products of four lengths do not overflow a double. The packer scales lengths
/// into the range of the number format.
inline constexpr double kMaxSceneLength = 1e30;

/// Maximum magnitude of colours, exponents and other numbers that are not lengths.
inline constexpr double kMaxNumber = 1e9;

/// Maximum of Kd, Ks and T. Values above 1 are unphysical; values above 100 are probably typing errors.
inline constexpr double kMaxWeight = 100;

/// Maximum distance of a vertex from the plane of its polygon, relative to the polygon's size (the longest side of its
/// bounding box). In a polygon that spans 1,000 pixels, the limit 1e-3 is one pixel. Vertices that are rounded to six
/// digits are only about 1e-5 off the plane.
inline constexpr double kFlatness = 1e-3;

enum class OutlineFault { kNone, kNoArea, kNotFlat };

/// Result of the check of an outline. `reason` completes a sentence that begins with "the polygon".
struct OutlineCheck {
    OutlineFault fault = OutlineFault::kNone;
    std::string reason;
};

/// Removes each vertex that equals the previous one, with its normal, and checks the outline. An outline that crosses
/// itself so that its signed area is 0 has no area.
OutlineCheck clean_outline(Polygon& polygon);

/// Reports a polygon that cannot be traced as given. Throws UserError with `reason`, a sentence about the polygon, or
/// adds the remark `what`.
using RemarkOrRefuse = std::function<void(const std::string& reason, const std::string& what)>;

/// Adds a polygon to the scene after clean_outline(). Reports a polygon without area and leaves it out; reports a
/// polygon that is not flat and cuts it into triangles.
void add_polygon(Scene& scene, Polygon polygon, const RemarkOrRefuse& report);

/// Returns `v` normalised. Returns a vector unchanged if its length is 1 up to rounding, so that writing and reading a
/// scene does not change it; also returns the zero vector unchanged.
Vec3 unit_vector(const Vec3& v);

/// Returns the reason why a view is invalid, for example "'from' and 'at' are the same point", or an empty string if
/// the view is valid.
std::string view_error(const View& view);

/// Returns true if all components are in 0..kMaxNumber.
bool is_colour(const Colour& colour);

}  // namespace raya
