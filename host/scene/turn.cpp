#include "host/scene/turn.hpp"

#include <cmath>
#include <numbers>

namespace raya {
namespace {

struct Direction {
    double cosine, sine;
};

Direction direction_at(double degrees) {
    const double quarter = std::round(degrees / 90), rest = (degrees - 90 * quarter) * std::numbers::pi / 180;
    const double c = std::cos(rest), s = std::sin(rest);
    switch (static_cast<int>(std::fmod(quarter, 4) + 4) % 4) {
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        case 3:
            return {s, -c};
        default:
            return {c, s};
    }
}

}  // namespace

// O. Rodrigues's formula.
View turned(View view, double degrees) {
    const double rest = std::fmod(degrees, 360);
    if (rest == 0) return view;
    const auto [cosine, sine] = direction_at(rest);
    const Vec3 axis = view.up.normalized(), arm = view.from - view.at;
    view.from = view.at + arm * cosine + axis.cross(arm) * sine + axis * (axis.dot(arm) * (1 - cosine));
    return view;
}

}  // namespace raya
