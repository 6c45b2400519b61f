// Intersection of rays with the four kinds of objects, as specified in kernels/README.md, sections Hits and Checker.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/scene/polygon.hpp"
#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

std::size_t as_index(int i) { return static_cast<std::size_t>(i); }

/// Projects the point to two coordinates by dropping the axis of the normal's largest component.
Vec3 flattened(const Vec3& point, const Vec3& normal) {
    const int axis = dropped_axis(normal);
    return {point[axis == 0 ? 1 : 0], point[axis == 2 ? 1 : 2], 0};
}

/// Returns true if the half line from the point towards larger u crosses an odd number of edges. An edge includes its
/// end with the smaller v, but not its end with the larger v, so that a vertex between two edges is counted once.
bool inside_outline(const std::vector<Vec3>& vertices, const Vec3& normal, const Vec3& point) {
    const Vec3 p = flattened(point, normal);
    bool inside = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3 a = flattened(vertices[i], normal);
        const Vec3 b = flattened(vertices[(i + 1) % vertices.size()], normal);
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
    return inside;
}

/// Axis a, height h, base radius r0 and slope k of a cone (kernels/README.md, Cone), computed from the radii's absolute
/// values.
struct ConeFrame {
    Vec3 axis;
    double height, base_radius, slope;

    explicit ConeFrame(const Cone& cone)
        : axis((cone.apex - cone.base).normalized()),
          height((cone.apex - cone.base).length()),
          base_radius(std::abs(cone.base_radius)),
          slope((std::abs(cone.apex_radius) - base_radius) / height) {}

    Vec3 outward_normal(const Cone& cone, const Vec3& x) const {
        const double z = (x - cone.base).dot(axis);
        return (x - cone.base - z * axis - slope * (base_radius + slope * z) * axis).normalized();
    }
};

/// Returns the real zeros t of a t^2 + 2 b t + c in ascending order. The computation avoids cancellation.
std::vector<double> quadratic_zeros(double a, double b, double c) {
    if (a == 0) return b == 0 ? std::vector<double>{} : std::vector<double>{-c / (2 * b)};
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return {};
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    if (q == 0) return {0};
    return {std::min(q / a, c / q), std::max(q / a, c / q)};
}

/// Returns the normal of a patch at a point, interpolated linearly over the triangle that contains the point. The
/// function chooses the triangle for which the point's smallest barycentric coordinate is largest. So a point on an
/// edge has a triangle even if rounding moves the point out of both triangles of the edge.
Vec3 interpolated_normal(const Polygon& patch, const Vec3& normal, const Vec3& point) {
    double best_coordinate = -kFar;
    Vec3 best_normal(0, 0, 0);
    for (const std::array<int, 3>& triangle : triangulate(patch.vertices, normal)) {
        std::array<double, 3> weights{};  // barycentric coordinates times `sum`
        for (int i = 0; i < 3; ++i) {
            const Vec3& next = patch.vertices[as_index(triangle[as_index((i + 1) % 3)])];
            const Vec3& after_next = patch.vertices[as_index(triangle[as_index((i + 2) % 3)])];
            weights[as_index(i)] = (next - point).cross(after_next - point).dot(normal);
        }
        const double sum = weights[0] + weights[1] + weights[2];
        if (sum <= 0) continue;  // a degenerate triangle contains no point
        const double coordinate = *std::min_element(weights.begin(), weights.end()) / sum;
        if (coordinate <= best_coordinate) continue;
        best_coordinate = coordinate;
        best_normal = Vec3(0, 0, 0);
        for (int i = 0; i < 3; ++i)
            best_normal += weights[as_index(i)] / sum * patch.normals[as_index(triangle[as_index(i)])];
    }
    return best_normal.normalized();
}

/// Returns the hit of object `number` at distance t. Turns the outward normals `geometric` and `shading` against the
/// ray, and computes the colour.
Hit make_hit(const Scene& scene, const Ray& ray, double t, int number, int surface, const Vec3& geometric,
             const Vec3& shading) {
    Hit hit;
    hit.t = t;
    hit.object = number;
    hit.point = ray.origin + t * ray.direction;
    hit.leaving = geometric.dot(ray.direction) > 0;
    hit.geometric = hit.leaving ? -geometric : geometric;
    hit.shading = hit.leaving ? -shading : shading;
    if (hit.shading.dot(hit.geometric) < 0) hit.shading = -hit.shading;
    hit.surface = surface;
    const Surface& material = scene.surfaces[as_index(surface)];
    hit.colour = material.colour;
    if (material.checker) {
        const Vec3 uv = flattened(hit.point, hit.geometric);
        const double squares = std::floor(uv.x / material.checker->size) + std::floor(uv.y / material.checker->size);
        hit.odd_square = std::fmod(squares, 2) != 0;
        hit.colour = hit.odd_square ? material.checker->odd : material.checker->even;
    }
    return hit;
}

/// Returns the hit of object `number` at distance t, with the object's normals and surface.
Hit hit_of_object(const Scene& scene, const Ray& ray, double t, int number) {
    const Vec3 point = ray.origin + t * ray.direction;
    std::size_t i = as_index(number);
    if (i < scene.spheres.size()) {
        const Sphere& sphere = scene.spheres[i];
        const Vec3 normal = (point - sphere.centre) / std::abs(sphere.radius);
        return make_hit(scene, ray, t, number, sphere.surface, normal, normal);
    }
    i -= scene.spheres.size();
    if (i < scene.planes.size()) {
        const Plane& plane = scene.planes[i];
        return make_hit(scene, ray, t, number, plane.surface, plane.normal, plane.normal);
    }
    i -= scene.planes.size();
    if (i < scene.polygons.size()) {
        const Polygon& polygon = scene.polygons[i];
        const Vec3 normal = newell_normal(polygon.vertices).normalized();
        const Vec3 shading = polygon.normals.empty() ? normal : interpolated_normal(polygon, normal, point);
        return make_hit(scene, ray, t, number, polygon.surface, normal, shading);
    }
    const Cone& cone = scene.cones[i - scene.polygons.size()];
    const Vec3 normal = ConeFrame(cone).outward_normal(cone, point);
    return make_hit(scene, ray, t, number, cone.surface, normal, normal);
}

}  // namespace

std::optional<double> hit_sphere(const Sphere& sphere, const Ray& ray) {
    const Vec3 c = sphere.centre - ray.origin;
    const double b = c.dot(ray.direction);
    const Vec3 l = c - b * ray.direction;
    const double discriminant = sphere.radius * sphere.radius - l.dot(l);
    if (discriminant < 0) return {};
    const double s = std::sqrt(discriminant);
    if (sphere.radius > 0 && b - s > 0) return b - s;
    if (b + s > 0) return b + s;
    return {};
}

std::optional<double> hit_plane(const Plane& plane, const Ray& ray) {
    const double cosine = plane.normal.dot(ray.direction);
    if (cosine == 0) return {};
    const double t = (plane.distance - plane.normal.dot(ray.origin)) / cosine;
    if (t > 0) return t;
    return {};
}

std::optional<double> hit_polygon(const Polygon& polygon, const Ray& ray) {
    const Vec3 normal = newell_normal(polygon.vertices).normalized();
    const std::optional<double> t = hit_plane({normal, normal.dot(polygon.vertices[0]), 0}, ray);
    if (t && inside_outline(polygon.vertices, normal, ray.origin + *t * ray.direction)) return t;
    return {};
}

std::optional<double> hit_cone(const Cone& cone, const Ray& ray) {
    const ConeFrame frame(cone);
    const bool inside_only = cone.base_radius < 0 || cone.apex_radius < 0;
    // a t^2 + 2 b t + c = 0 is the square of the equation |p + t q| = r + slope * dz * t. Vectors p and q are
    // perpendicular to the axis.
    const Vec3 from_base = ray.origin - cone.base;
    const double z0 = from_base.dot(frame.axis);
    const double dz = ray.direction.dot(frame.axis);
    const Vec3 p = from_base - z0 * frame.axis;
    const Vec3 q = ray.direction - dz * frame.axis;
    const double r = frame.base_radius + frame.slope * z0;
    const double a = q.dot(q) - frame.slope * frame.slope * dz * dz;
    const double b = p.dot(q) - frame.slope * dz * r;
    const double c = p.dot(p) - r * r;
    for (const double t : quadratic_zeros(a, b, c)) {
        const double z = z0 + t * dz;
        if (t <= 0 || z < 0 || z > frame.height) continue;
        const Vec3 outward = frame.outward_normal(cone, ray.origin + t * ray.direction);
        if (!inside_only || outward.dot(ray.direction) > 0) return t;
    }
    return {};
}

std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray, double far) {
    double nearest = far;
    int nearest_number = -1;
    int number = 0;
    const auto consider = [&](const std::optional<double>& t) {
        if (t && *t < nearest) {
            nearest = *t;
            nearest_number = number;
        }
        ++number;
    };
    for (const Sphere& sphere : scene.spheres) consider(hit_sphere(sphere, ray));
    for (const Plane& plane : scene.planes) consider(hit_plane(plane, ray));
    for (const Polygon& polygon : scene.polygons) consider(hit_polygon(polygon, ray));
    for (const Cone& cone : scene.cones) consider(hit_cone(cone, ray));
    if (nearest_number < 0) return {};
    return hit_of_object(scene, ray, nearest, nearest_number);
}

}  // namespace raya::reference
