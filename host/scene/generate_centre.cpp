#include <array>
#include <cmath>
#include <numbers>

#include "host/scene/generate.hpp"

namespace raya {
namespace {

/// To four decimals: sine and cosine differ between platforms in the last bits.
double rounded(double x) { return std::round(x * 1e4) / 1e4 + 0.0; }

struct Ring {
    int count;
    double distance;  // of the centres from the z axis
    double height;    // of the centres
    double radius;    // of the spheres
    double first;     // azimuth of the first sphere, in turns
    int first_surface;
    int surface_count;  // surfaces taken in turn
};

void add_ring(Scene& scene, const Ring& ring) {
    for (int i = 0; i < ring.count; ++i) {
        const double azimuth = 2 * std::numbers::pi * (ring.first + static_cast<double>(i) / ring.count);
        const Vec3 centre(rounded(ring.distance * std::cos(azimuth)), rounded(ring.distance * std::sin(azimuth)),
                          ring.height);
        scene.spheres.push_back({centre, ring.radius, ring.first_surface + i % ring.surface_count});
    }
}

}  // namespace

Scene generate_centre() {
    Scene scene;
    scene.name = "centre.nff";
    scene.background = {0.3, 0.5, 0.85};
    scene.view = {{0, -11, 4.4}, {0, 0, 1.35}, {0, 0, 1}, 28, 0, 256, 256};
    scene.lights = {{{-7, -8, 11}, Colour(0.62, 0.6, 0.55)}, {{8, -5, 7}, Colour(0.22, 0.24, 0.3)}};
    scene.surfaces = {
        {{1, 1, 1}, 0.02, 0.12, 200, 0.85, 1.5, {}},     // glass
        {{1, 1, 1}, 0.08, 0.85, 200, 0, 1, {}},          // mirror
        {{0.9, 0.1, 0.08}, 0.75, 0.25, 60, 0, 1, {}},    // glossy red
        {{0.95, 0.65, 0.08}, 0.75, 0.25, 60, 0, 1, {}},  // glossy yellow
        {{0.1, 0.25, 0.85}, 0.75, 0.25, 60, 0, 1, {}},   // glossy blue
        {{0.9, 0.9, 0.9}, 0.85, 0, 0, 0, 1, Checker{{0.9, 0.87, 0.8}, {0.2, 0.3, 0.34}, 2}},
    };
    scene.spheres.push_back({{0, 0, 1.3}, 1.3, 0});
    scene.spheres.push_back({{0, 0, 3.05}, 0.45, 1});
    add_ring(scene, {12, 1.85, 0.4, 0.4, 0.02, 1, 4});
    add_ring(scene, {8, 1.35, 2.45, 0.28, 0.04, 0, 2});
    scene.planes.push_back({{0, 0, 1}, 0, 5});
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
