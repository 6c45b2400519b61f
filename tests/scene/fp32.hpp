#pragma once
#include "host/scene/scene.hpp"

namespace raya {

/// Rounds to fp32. The variable is volatile because gcc 12.2 at -O2 vectorises adjacent calls and then removes
/// the conversion to float and back.
inline double fp32(double value) {
    const volatile float rounded = static_cast<float>(value);
    return rounded;
}

inline Vec3 fp32(const Vec3& v) { return {fp32(v.x), fp32(v.y), fp32(v.z)}; }

}  // namespace raya
