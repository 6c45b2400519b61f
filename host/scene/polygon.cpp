#include "host/scene/polygon.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "host/error.hpp"

namespace raya {
namespace {

/// Returns twice the signed area of a triangle; > 0 if the triangle is counter-clockwise.
double doubled_area(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a).z; }

/// Returns the vertices projected along dropped_axis(). Mirrors them if necessary so that they are counter-clockwise.
std::vector<Vec3> flattened(const std::vector<Vec3>& vertices, const Vec3& normal) {
    const int axis = dropped_axis(normal);
    const int first = axis == 0 ? 1 : 0;
    const int second = axis == 2 ? 1 : 2;
    std::vector<Vec3> flat;
    for (const Vec3& v : vertices) flat.emplace_back(v[first], v[second], 0);
    double area = 0;
    for (std::size_t i = 2; i < flat.size(); ++i) area += doubled_area(flat[0], flat[i - 1], flat[i]);
    if (area < 0)
        for (Vec3& v : flat) v.x = -v.x;
    return flat;
}

/// Returns true if a corner (previous vertex, vertex, next vertex) is an ear: convex, with no other vertex of
/// `remaining` in its triangle. Vertices on the triangle's border count as inside, so that cutting off an ear never
/// leaves a degenerate polygon. Vertices at the same position as a vertex of the corner are ignored, because they occur
/// where a cut joins a hole to the outline.
bool is_ear(const std::vector<Vec3>& flat, const std::vector<int>& remaining, const std::array<int, 3>& corner) {
    const auto vertex = [&](int i) { return flat[static_cast<std::size_t>(i)]; };
    const Vec3 a = vertex(corner[0]), b = vertex(corner[1]), c = vertex(corner[2]);
    if (doubled_area(a, b, c) <= 0) return false;
    for (const int i : remaining) {
        const Vec3 p = vertex(i);
        if (p == a || p == b || p == c) continue;
        if (doubled_area(a, b, p) >= 0 && doubled_area(b, c, p) >= 0 && doubled_area(c, a, p) >= 0) return false;
    }
    return true;
}

}  // namespace

Vec3 newell_normal(const std::vector<Vec3>& vertices) {
    Vec3 sum(0, 0, 0);
    // Uses positions relative to the first vertex, so that a small polygon far from the origin keeps its precision.
    for (std::size_t i = 2; i < vertices.size(); ++i)
        sum += (vertices[i - 1] - vertices[0]).cross(vertices[i] - vertices[0]);
    return sum;
}

int dropped_axis(const Vec3& normal) {
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
    return axis;
}

std::vector<std::array<int, 3>> triangulate(const std::vector<Vec3>& vertices, const Vec3& normal) {
    if (vertices.size() > kMaxCutCorners)
        throw UserError(
            fmt::format("a polygon with {} corners would have to be cut into triangles; the most is {}; cut "
                        "it in the program that made it",
                        vertices.size(), kMaxCutCorners));
    const std::vector<Vec3> flat = flattened(vertices, normal);
    std::vector<int> remaining;
    for (std::size_t i = 0; i < vertices.size(); ++i) remaining.push_back(static_cast<int>(i));
    const auto corner = [&](std::size_t i) {
        const std::size_t n = remaining.size();
        return std::array<int, 3>{remaining[(i + n - 1) % n], remaining[i], remaining[(i + 1) % n]};
    };
    std::vector<std::array<int, 3>> triangles;
    while (remaining.size() >= 3) {
        std::size_t ear = 1;  // if there is no ear, triangle (0, 1, 2) is cut off
        if (remaining.size() > 3)
            for (std::size_t i = 0; i < remaining.size(); ++i)
                if (is_ear(flat, remaining, corner(i))) {
                    ear = i;
                    break;
                }
        triangles.push_back(corner(ear));
        remaining.erase(remaining.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    return triangles;
}

std::vector<Polygon> triangles_of(const Polygon& polygon) {
    std::vector<Polygon> triangles;
    for (const std::array<int, 3>& corners : triangulate(polygon.vertices, newell_normal(polygon.vertices))) {
        Polygon& triangle = triangles.emplace_back(Polygon{{}, {}, polygon.surface});
        for (const int corner : corners) {
            triangle.vertices.push_back(polygon.vertices[static_cast<std::size_t>(corner)]);
            if (!polygon.normals.empty()) triangle.normals.push_back(polygon.normals[static_cast<std::size_t>(corner)]);
        }
    }
    return triangles;
}

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

void drop_repeats(Polygon& polygon) {
    const auto& vertices = polygon.vertices;
    if (!vertices.empty() && vertices.front() != vertices.back() &&
        std::adjacent_find(vertices.begin(), vertices.end()) == vertices.end())
        return;
    const Polygon original = std::exchange(polygon, {{}, {}, polygon.surface});
    const std::size_t count = original.vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (original.vertices[i] == original.vertices[(i + count - 1) % count]) continue;
        polygon.vertices.push_back(original.vertices[i]);
        if (!original.normals.empty()) polygon.normals.push_back(original.normals[i]);
    }
}

}  // namespace

Vec3 unit_vector(const Vec3& v) {
    if (std::abs(v.length2() - 1) <= 8 * kEpsilon) return v;
    const double largest = largest_coordinate(v);
    if (largest == 0) return v;
    const Vec3 scaled = v / largest;
    return scaled / scaled.length();
}

OutlineCheck clean_outline(Polygon& polygon) {
    drop_repeats(polygon);
    const std::vector<Vec3>& vertices = polygon.vertices;
    if (vertices.size() < 3) return {OutlineFault::kNoArea, "has fewer than three different vertices"};

    double size = 0, farthest = 0;  // longest side of the bounding box; largest coordinate
    Vec3 mean(0);
    for (const Vec3& v : vertices) {
        size = std::max(size, largest_coordinate(v - vertices[0]));
        farthest = std::max(farthest, largest_coordinate(v));
        mean += (v - vertices[0]) / static_cast<double>(vertices.size());
    }
    if (size < kMinSceneLength) return {OutlineFault::kNoArea, fmt::format("is smaller than {}", kMinSceneLength)};

    // Upper bound of the doubled area that collinear vertices can have because of rounding errors.
    const double max_error = 1e-12 * size * size + 8 * kEpsilon * farthest * size;
    const Vec3 normal = newell_normal(vertices);
    const double doubled_area = normal.length();
    if (doubled_area <= max_error) return {OutlineFault::kNoArea, "has no area"};

    double off_plane = 0;  // maximum distance of a vertex from the plane
    for (const Vec3& v : vertices)
        off_plane = std::max(off_plane, std::abs((v - vertices[0] - mean).dot(normal) / doubled_area));
    if (off_plane > kFlatness * size)
        return {OutlineFault::kNotFlat,
                fmt::format("is not flat: a vertex lies {:.3g} off its plane, more than {:.3g} ({} of its size); cut "
                            "it into triangles",
                            off_plane, kFlatness * size, kFlatness)};
    return {};
}

void add_polygon(Scene& scene, Polygon polygon, const RemarkOrRefuse& report) {
    const OutlineCheck check = clean_outline(polygon);
    if (check.fault == OutlineFault::kNone) {
        scene.polygons.push_back(std::move(polygon));
        return;
    }
    // A triangle is flat by definition. If the check says otherwise, it is a sliver with almost no area, and it cannot
    // be cut into triangles.
    if (check.fault == OutlineFault::kNoArea || polygon.vertices.size() == 3)
        return report("the polygon " + check.reason, "polygon without area, left out");
    if (polygon.vertices.size() > kMaxCutCorners)
        return report("the polygon " + check.reason,
                      fmt::format("polygon that is not flat and has more than {} corners, left out", kMaxCutCorners));
    report("the polygon " + check.reason, "polygon that is not flat, cut into triangles");
    for (const Polygon& triangle : triangles_of(polygon)) add_polygon(scene, triangle, report);
}

std::string view_error(const View& view) {
    constexpr double kMinUpSine = 1e-6;  // minimum sine of the angle between viewing direction and up
    const Vec3 gaze = view.at - view.from;
    if (gaze.length() < kMinSceneLength) return "'from' and 'at' are the same point";
    if (!(view.angle_degrees > 0 && view.angle_degrees < 180))
        return fmt::format("the angle is {}: must lie between 0 and 180 degrees", view.angle_degrees);
    if (unit_vector(gaze).cross(unit_vector(view.up)).length() < kMinUpSine)
        return "'up' is zero or parallel to the viewing direction; change it";
    return {};
}

bool is_colour(const Colour& colour) {
    const auto [lowest, highest] = std::minmax({colour.x, colour.y, colour.z});
    return lowest >= 0 && highest <= kMaxNumber;
}

}  // namespace raya
