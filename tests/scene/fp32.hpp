// Numbers of a scene as fp32 holds them.
#pragma once
#include "host/scene/scene.hpp"

namespace raya {

/// Rounded to fp32. Volatile, since gcc 12.2 at -O2 forgets the rounding where neighbours go from double to float and
/// back: its vectoriser takes the two conversions of a pair for none.
inline double fp32(double value) {
    const volatile float rounded = static_cast<float>(value);
    return rounded;
}

inline Vec3 fp32(const Vec3& v) { return {fp32(v.x), fp32(v.y), fp32(v.z)}; }

}  // namespace raya
