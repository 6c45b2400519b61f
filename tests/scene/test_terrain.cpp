#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "host/scene/generate.hpp"
#include "host/scene/polygon.hpp"

using namespace raya;

TEST_CASE("terrain: the requested number of triangles, which face upwards and share their corners", "[generate]") {
    for (const int triangles : {1, 2, 3, 7, 8, 9, 1000, 20001}) {
        const Scene scene = generate_terrain(triangles, 5);
        CAPTURE(triangles);
        REQUIRE(scene.polygons.size() == static_cast<std::size_t>(triangles));
        double lowest = 0, highest = 0;
        for (const Polygon& polygon : scene.polygons) {
            const Vec3 normal = newell_normal(polygon.vertices);
            CHECK(normal.z == 1);  // twice the area of half a cell, seen from above
            CHECK(std::abs(normal.x) + std::abs(normal.y) < 6);
            for (const Vec3& v : polygon.vertices) {
                lowest = std::min(lowest, v.z);
                highest = std::max(highest, v.z);
            }
        }
        if (triangles > 1000) CHECK(highest - lowest > 2);
    }
}
