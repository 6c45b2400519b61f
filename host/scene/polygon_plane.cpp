#include "host/scene/polygon_plane.hpp"

#include <cmath>

namespace raya {

Vec3 newell_normal(const std::vector<Vec3>& vertices) {
    Vec3 sum(0, 0, 0);
    // Taken about the first vertex, not the origin: a small polygon far out keeps its digits.
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

}  // namespace raya
