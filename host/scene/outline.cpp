#include "host/scene/outline.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "host/scene/nff_tokens.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
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
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (largest == 0) return v;
    const Vec3 scaled = v / largest;
    return scaled / scaled.length();
}

OutlineCheck clean_outline(Polygon& polygon) {
    drop_repeats(polygon);
    const std::vector<Vec3>& vertices = polygon.vertices;
    if (vertices.size() < 3) return {OutlineFault::kNoArea, "has fewer than three different vertices"};

    double size = 0, largest_coordinate = 0;  // size: longest side of the bounding box
    Vec3 mean(0);
    for (const Vec3& v : vertices) {
        for (int axis = 0; axis < 3; ++axis) {
            size = std::max(size, std::abs(v[axis] - vertices[0][axis]));
            largest_coordinate = std::max(largest_coordinate, std::abs(v[axis]));
        }
        mean += (v - vertices[0]) / static_cast<double>(vertices.size());
    }
    if (size < kMinSceneLength) return {OutlineFault::kNoArea, fmt::format("is smaller than {}", kMinSceneLength)};

    // Upper bound of the doubled area that collinear vertices can have because of rounding errors.
    const double max_error = 1e-12 * size * size + 8 * kEpsilon * largest_coordinate * size;
    const Vec3 normal = newell_normal(vertices);
    const double doubled_area = normal.length();
    for (std::size_t i = 2; doubled_area <= max_error && i < vertices.size(); ++i)
        if ((vertices[i - 1] - vertices[0]).cross(vertices[i] - vertices[0]).length() > max_error)
            return {OutlineFault::kCrosses, "crosses or retraces itself, so that its signed area is 0"};
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
    if (check.fault == OutlineFault::kCrosses)
        return report("the polygon " + check.reason, "polygon that " + check.reason + ", left out");
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
