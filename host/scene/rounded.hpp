// Lengths that generators put into files.
#pragma once
#include <cmath>

#include "host/scene/scene.hpp"

namespace raya {

/// To nine decimals: short in files, three more than SPD's own files have, and the same on every platform, whose sines
/// and cosines differ in the last bits.
inline double rounded(double x) { return std::round(x * 1e9) / 1e9 + 0.0; }

inline Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

}  // namespace raya
