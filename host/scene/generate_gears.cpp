#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/rounded.hpp"

namespace raya {
namespace {

/// A multiple of four: wheels that mesh on one side then do so on all four.
constexpr int kTeeth = 24;

struct Corner {
    double turn;    // from the middle of the tooth, in shares of the pitch
    double radius;  // in pitch radii
};

/// A tooth, counter-clockwise: foot, flank and tip, tip, flank and foot. Narrower than half a pitch at the pitch
/// circle, and shorter than the gap that it stands in is deep: wheels that mesh do not touch.
constexpr std::array<Corner, 6> kTooth{
    {{-0.32, 0.9}, {-0.235, 1}, {-0.12, 1.075}, {0.12, 1.075}, {0.235, 1}, {0.32, 0.9}}};

/// Of the cube [-1, 1]^3, from above one of its upright edges.
View view_of_wheels() { return {{2.4, 3.2, 3.0}, {0, 0, -0.15}, {0, 0, 1}, 36, 0, 512, 512}; }

/// Brass, steel, glass and red enamel.
std::vector<Surface> finishes() {
    return {{{0.85, 0.65, 0.25}, 0.7, 0.3, 30, 0, 1, {}},
            {{0.75, 0.8, 0.85}, 0.4, 0.6, 100, 0, 1, {}},
            {{0.75, 0.95, 0.85}, 0.2, 0.1, 100, 0.7, 1.1, {}},
            {{0.8, 0.15, 0.12}, 0.9, 0.1, 20, 0, 1, {}}};
}

/// A wheel about an upright axis.
struct Wheel {
    Vec3 centre;
    double radius;     // of the pitch circle
    double thickness;  // along the axis
    double turned;     // of its first tooth from the x axis, in shares of the pitch
    int surface;
};

/// The wheel's outline at the given height, counter-clockwise seen from above.
std::vector<Vec3> outline(const Wheel& wheel, double height) {
    std::vector<Vec3> corners;
    for (int tooth = 0; tooth < kTeeth; ++tooth)
        for (const Corner& corner : kTooth) {
            const double angle = 2 * std::numbers::pi * (tooth + wheel.turned + corner.turn) / kTeeth;
            const double radius = wheel.radius * corner.radius;
            corners.emplace_back(rounded(wheel.centre.x + radius * std::cos(angle)),
                                 rounded(wheel.centre.y + radius * std::sin(angle)), height);
        }
    return corners;
}

/// Two faces, and a quadrilateral for each of their edges; all show their fronts to the outside.
void add_wheel(Scene& scene, const Wheel& wheel) {
    const std::vector<Vec3> upper = outline(wheel, rounded(wheel.centre.z + wheel.thickness / 2));
    const std::vector<Vec3> lower = outline(wheel, rounded(wheel.centre.z - wheel.thickness / 2));
    scene.polygons.push_back({upper, {}, wheel.surface});
    scene.polygons.push_back({{lower.rbegin(), lower.rend()}, {}, wheel.surface});
    for (std::size_t i = 0; i < upper.size(); ++i) {
        const std::size_t next = (i + 1) % upper.size();
        scene.polygons.push_back({{lower[i], lower[next], upper[next], upper[i]}, {}, wheel.surface});
    }
}

}  // namespace

Scene generate_gears(int size) {
    if (size < 1 || size > kHighestGearsSize)
        throw UserError(fmt::format("gears: size {}: must lie in 1..{}", size, kHighestGearsSize));
    Scene scene;
    scene.name = fmt::format("gears{}.nff", size);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = view_of_wheels();
    scene.lights = {{{4, 3, 5}, {}}, {{1, 6, 3}, {}}, {{-4, 2, 6}, {}}, {{5, -2, 2}, {}}, {{0, 0, 8}, {}}};
    scene.surfaces = finishes();
    const int ground = static_cast<int>(scene.surfaces.size());
    scene.surfaces.push_back({{0.85, 0.8, 0.7}, 0.9, 0, 0, 0, 1, {}});
    scene.polygons = {{{{12, 12, -1.2}, {-12, 12, -1.2}, {-12, -12, -1.2}, {12, -12, -1.2}}, {}, ground}};
    const double distance = 2.0 / size;
    for (int x = 0; x < size; ++x)
        for (int y = 0; y < size; ++y)
            for (int z = 0; z < size; ++z) {
                const Vec3 centre = Vec3(-1) + (Vec3(x, y, z) + Vec3(0.5)) * distance;
                const double turned = (x + y) % 2 == 0 ? 0 : 0.5;  // a tooth faces a gap
                add_wheel(scene, {centre, distance / 2, 0.4 * distance, turned, (x + 2 * y + z) % ground});
            }
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
