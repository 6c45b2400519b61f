// Makes a scene of the meshes and surfaces of a file.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "host/base/encoding.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/scene/nff_tokens.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

constexpr double kMaxWeight = 100;  // of Kd, Ks and T, as in NFF

bool is_point(const Vec3& v) {
    return std::abs(v.x) <= kMaxSceneLength && std::abs(v.y) <= kMaxSceneLength && std::abs(v.z) <= kMaxSceneLength;
}

bool is_direction(const Vec3& v) { return is_point(v) && v != Vec3(0); }

bool is_weight(double x) { return x >= 0 && x <= kMaxWeight; }

/// Returns "mesh NAME, face NUMBER". Called only for messages, because a mesh has millions of faces.
std::string place_of(const Mesh& mesh, std::uint64_t face) {
    return (mesh.name.empty() ? "" : "mesh " + in_quotes(mesh.name) + ", ") + fmt::format("face {}", face);
}

bool all_equal(const std::vector<Vec3>& vectors) {
    return std::ranges::all_of(vectors, [&](const Vec3& v) { return v == vectors.front(); });
}

// Sets camera and lights. The eye sees `box`, that of all objects, from a three-quarter view, at the smallest distance
// at which the whole box is in a square image, and 5 % more. Two white lights are near the eye.
void set_default_view(Scene& scene, const Imath::Box3d& box, UpAxis up_axis) {
    constexpr double kMargin = 1.05;
    const Vec3 up = up_axis == UpAxis::kY ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    const Vec3 front = up_axis == UpAxis::kY ? Vec3(0, 0, 1) : Vec3(0, -1, 0), side(1, 0, 0);
    const Vec3 back = (2.0 * side + 2.0 * up + 3.0 * front).normalized();  // from the centre to the eye
    const Vec3 right = up.cross(back).normalized(), top = back.cross(right);
    const double half_image = std::tan(scene.view.angle_degrees * std::numbers::pi / 360);  // at distance 1
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                      corner & 4 ? box.max.z : box.min.z);
        const Vec3 arm = at - box.center();
        distance =
            std::max(distance, arm.dot(back) + std::max(std::abs(arm.dot(right)), std::abs(arm.dot(top))) / half_image);
    }
    distance *= kMargin;
    scene.view.at = box.center();
    scene.view.from = box.center() + distance * back;
    scene.view.up = up;
    scene.lights = {{scene.view.from + distance / 2 * (top - right), {}}, {scene.view.from + distance / 2 * right, {}}};
}

}  // namespace

MeshScene::MeshScene(const std::string& file, std::vector<SceneRemark>* remarks) : file_(file), remarks_(remarks) {
    scene_.name = std::filesystem::path(file).filename().string();
    scene_.surfaces.emplace_back();
}

void MeshScene::refuse(const std::string& reason) const { throw UserError(fmt::format("{}: {}", file_, reason)); }

void MeshScene::remark_or_refuse(const std::string& place, const std::string& reason, const std::string& what) {
    if (!remarks_) refuse(place.empty() ? reason : place + ": " + reason);
    add_remark(*remarks_, {.what = what, .place = place});
}

void MeshScene::ignore(const std::string& what, const std::string& place) {
    remark_or_refuse(place, what + " has no counterpart in raya", what + ", ignored");
}

int MeshScene::add_surface(const std::string& name, const Surface& s) {
    const bool is_legal = is_colour(s.colour) && is_weight(s.diffuse) && is_weight(s.specular) && s.shine >= 0 &&
                          s.shine <= kMaxNumber && is_weight(s.transmittance) && s.refraction_index > 0 &&
                          s.refraction_index <= kMaxNumber;
    if (!is_legal)
        refuse(
            fmt::format("material {}: a number is negative, too large or not finite: colour {} {} {}, Kd {}, Ks {}, "
                        "Shine {}, T {}, index of refraction {}",
                        in_quotes(name), s.colour.x, s.colour.y, s.colour.z, s.diffuse, s.specular, s.shine,
                        s.transmittance, s.refraction_index));
    scene_.surfaces.push_back(s);
    return static_cast<int>(scene_.surfaces.size()) - 1;
}

Polygon MeshScene::polygon_of(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size) {
    Polygon polygon{{}, {}, mesh.surface};
    polygon.vertices.reserve(size);
    for (std::size_t i = first_corner; i < first_corner + size; ++i) {
        const std::uint32_t corner = mesh.corners[i];
        if (corner >= mesh.vertices.size())
            refuse(fmt::format("{}: there is no vertex {}; the mesh has {}, numbered from 0; the file may be damaged",
                               place_of(mesh, face), corner, mesh.vertices.size()));
        polygon.vertices.emplace_back(mesh.vertices[corner]);
        if (!mesh.normals.empty()) polygon.normals.emplace_back(mesh.normals[corner]);
    }
    if (!std::ranges::all_of(polygon.vertices, is_point)) {
        remark_or_refuse(place_of(mesh, face), "a coordinate is not finite or above 1e30 in magnitude",
                         "face with a coordinate that is not finite or above 1e30, left out");
        return {};
    }
    if (!std::ranges::all_of(polygon.normals, is_direction)) {
        remark_or_refuse(place_of(mesh, face), "a normal is missing, zero or not finite",
                         "face in which a normal is missing or 0, taken as flat");
        polygon.normals.clear();
    }
    // Equal normals are those of flat shading. A flat polygon needs fewer words in a PE than a patch.
    if (!polygon.normals.empty() && all_equal(polygon.normals)) polygon.normals.clear();
    for (Vec3& normal : polygon.normals) normal = unit_vector(normal);
    return polygon;
}

void MeshScene::add_face(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size) {
    const auto report = [&](const std::string& reason, const std::string& what) {
        remark_or_refuse(place_of(mesh, face), reason, what);
    };
    if (size < 3) return report("it is a point or a line", "point or line, left out");
    Polygon polygon = polygon_of(mesh, face, first_corner, size);
    if (polygon.vertices.empty()) return;
    if (size > 3) {
        const OutlineFault fault = clean_outline(polygon).fault;
        if (fault == OutlineFault::kNone || fault == OutlineFault::kNotFlat) {
            try {
                for (Polygon& triangle : triangles_of(polygon))
                    add_polygon(scene_, std::move(triangle), std::cref(report));
            } catch (const UserError& error) {
                refuse(place_of(mesh, face) + ": " + error.what());
            }
            return;
        }
    }
    add_polygon(scene_, std::move(polygon), std::cref(report));  // a copy would need memory for each face
}

void MeshScene::add(const Mesh& mesh) {
    const std::uint64_t faces = mesh.sizes.empty() ? mesh.corners.size() / 3 : mesh.sizes.size();
    faces_ += faces;
    if (faces_ > kMaxMeshFaces) refuse(fmt::format("it has more than {} faces; use a coarser mesh", kMaxMeshFaces));
    scene_.polygons.reserve(scene_.polygons.size() + faces);
    std::size_t corner = 0;
    for (std::uint64_t face = 0; face < faces; ++face) {
        const std::size_t size = mesh.sizes.empty() ? 3 : mesh.sizes[face];
        if (size > mesh.corners.size() - corner) refuse("a mesh has faces with more corners than it lists");
        add_face(mesh, face + 1, corner, size);
        corner += size;
    }
}

Scene MeshScene::finish(UpAxis up) {
    constexpr double kFar = 100;  // at which the margin of secondary rays in e6m15 is 2 % of the mesh
    if (scene_.polygons.empty()) refuse("it has no triangle: the image would be empty");
    const Imath::Box3d box = scene_box(scene_);
    const double distance = box.center().length(), size = box.size().length();
    if (distance > kFar * size)
        remark_or_refuse("", "it is too far from the origin for its size; move it to the origin",
                         fmt::format("its distance from the origin is {:.2g} times its size, so that rounding errors "
                                     "deform it: move it to the origin",
                                     distance / size));
    merge_equal_surfaces(scene_);
    set_default_view(scene_, box, up);
    return std::move(scene_);
}

}  // namespace raya
