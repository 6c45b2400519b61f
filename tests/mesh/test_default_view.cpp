// The default camera shows the whole mesh, and no more than necessary.
#include <Imath/ImathBox.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/mesh/mesh_file.hpp"
#include "host/scene/polygon.hpp"
#include "host/scene/scene.hpp"
#include "tests/mesh/mesh_files.hpp"

namespace raya {
namespace {

/// A mesh that consists of one triangle across a box with these corners.
Scene triangle_in(const Imath::V3f& low, const Imath::V3f& high, UpAxis up) {
    Mesh mesh;
    mesh.vertices = {low, high, {high.x, low.y, high.z}};
    mesh.corners = {0, 1, 2};
    MeshScene scene("t", nullptr);
    scene.add(mesh);
    return scene.finish(up);
}

/// Returns the largest distance of a corner of the scene's box from the centre of the image, as a fraction of half of
/// the image's side.
double extent_in_image(const Scene& scene) {
    const View& view = scene.view;
    const Imath::Box3d box = scene_box(scene);
    const Vec3 gaze = (view.at - view.from).normalized();
    const Vec3 right = gaze.cross(view.up).normalized(), top = right.cross(gaze);
    double extent = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                      corner & 4 ? box.max.z : box.min.z);
        const Vec3 arm = at - view.from;
        const double half_image = arm.dot(gaze) * std::tan(view.angle_degrees * std::numbers::pi / 360);
        REQUIRE(half_image > 0);
        extent = std::max({extent, std::abs(arm.dot(right)) / half_image, std::abs(arm.dot(top)) / half_image});
    }
    return extent;
}

TEST_CASE("the default view shows the whole mesh in three-quarter view, with two lights", "[mesh]") {
    const std::vector<std::pair<Imath::V3f, Imath::V3f>> boxes = {{{0, 0, 0}, {1, 1, 1}},
                                                                  {{-1, -2, -3}, {100, 0, 4}},
                                                                  {{5, 5, 5}, {5.001f, 9, 5.5f}},
                                                                  {{1e20f, 0, 0}, {1.1e20f, 1e19f, 1e18f}},
                                                                  {{-1e29f, 0, 0}, {1e29f, 1e29f, 1e29f}},
                                                                  {{0, 0, 0}, {1e-20f, 2e-20f, 0}}};
    for (const auto& [low, high] : boxes)
        for (const UpAxis up : {UpAxis::kY, UpAxis::kZ}) {
            CAPTURE(low.x, high.x, up == UpAxis::kY);
            const Scene scene = triangle_in(low, high, up);
            CHECK(view_error(scene.view).empty());
            CHECK(extent_in_image(scene) < 1);
            CHECK(extent_in_image(scene) > 0.9);
            CHECK(scene.view.angle_degrees == 45);
            const Vec3 to_eye = (scene.view.from - scene.view.at).normalized();
            const Vec3 expected = up == UpAxis::kY ? Vec3(2, 2, 3) : Vec3(2, -3, 2);
            CHECK((to_eye - expected.normalized()).length() < 1e-9);
            CHECK(scene.view.up == (up == UpAxis::kY ? Vec3(0, 1, 0) : Vec3(0, 0, 1)));
            CHECK(scene.lights.size() == 2);
            CHECK(scene.background == Colour(0, 0, 0));
        }
}

TEST_CASE("the upward axis is z in STL, y in other formats", "[mesh]") {
    CHECK(read_mesh("t.stl", tetrahedron_binary_stl()).scene.view.up == Vec3(0, 0, 1));
    CHECK(read_mesh("t.obj", tetrahedron_obj()).scene.view.up == Vec3(0, 1, 0));
    CHECK(read_mesh("t.ply", tetrahedron_ply()).scene.view.up == Vec3(0, 1, 0));
    CHECK(read_mesh("t.glb", tetrahedron_glb()).scene.view.up == Vec3(0, 1, 0));
}

}  // namespace
}  // namespace raya
