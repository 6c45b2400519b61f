// The default camera shows the whole mesh, and no more than necessary.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/scene/polygon.hpp"
#include "host/scene/scene.hpp"
#include "tests/mesh/mesh_files.hpp"

namespace raya {
namespace {

/// A mesh that consists of one triangle across a box with these corners. Up is z in STL, y in PLY.
Scene triangle_in(const std::array<float, 3>& low, const std::array<float, 3>& high, bool z_up) {
    const std::array<std::array<float, 3>, 3> corners = {low, high, {high[0], low[1], high[2]}};
    std::string bytes = z_up ? std::string(80, ' ')
                             : "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
                               "property float y\nproperty float z\nelement face 1\n"
                               "property list uchar int vertex_indices\nend_header\n";
    if (z_up) append(bytes, std::uint32_t{1}), append(bytes, std::array<float, 3>{});
    for (const std::array<float, 3>& corner : corners) append(bytes, corner);
    if (z_up) append(bytes, std::uint16_t{0});
    if (!z_up) append(bytes, std::uint8_t{3}), append(bytes, std::array<std::uint32_t, 3>{0, 1, 2});
    return read_mesh(z_up ? "t.stl" : "t.ply", bytes).scene;
}

/// Returns the largest distance of a corner of the scene's box from the centre of the image, as a fraction of half of
/// the image's side.
double extent_in_image(const Scene& scene) {
    const View& view = scene.view;
    const Box box = scene_box(scene);
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
    const std::vector<std::pair<std::array<float, 3>, std::array<float, 3>>> boxes = {
        {{0, 0, 0}, {1, 1, 1}},
        {{-1, -2, -3}, {100, 0, 4}},
        {{5, 5, 5}, {5.001f, 9, 5.5f}},
        {{1e20f, 0, 0}, {1.1e20f, 1e19f, 1e18f}},
        {{-1e29f, 0, 0}, {1e29f, 1e29f, 1e29f}},
        {{0, 0, 0}, {1e-20f, 2e-20f, 0}}};
    for (const auto& [low, high] : boxes)
        for (const bool z_up : {false, true}) {
            CAPTURE(low[0], high[0], z_up);
            const Scene scene = triangle_in(low, high, z_up);
            CHECK(view_error(scene.view).empty());
            CHECK(extent_in_image(scene) < 1);
            CHECK(extent_in_image(scene) > 0.9);
            CHECK(scene.view.angle_degrees == 45);
            const Vec3 to_eye = (scene.view.from - scene.view.at).normalized();
            const Vec3 expected = z_up ? Vec3(2, -3, 2) : Vec3(2, 2, 3);
            CHECK((to_eye - expected.normalized()).length() < 1e-9);
            CHECK(scene.view.up == (z_up ? Vec3(0, 0, 1) : Vec3(0, 1, 0)));
            CHECK(scene.lights.size() == 2);
            CHECK(scene.background == Colour(0, 0, 0));
        }
}

TEST_CASE("the upward axis is y in OBJ and glTF", "[mesh]") {
    CHECK(read_mesh("t.obj", tetrahedron_obj()).scene.view.up == Vec3(0, 1, 0));
    CHECK(read_mesh("t.glb", tetrahedron_glb()).scene.view.up == Vec3(0, 1, 0));
}

}  // namespace
}  // namespace raya
