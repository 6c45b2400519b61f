#include "host/model/accel.hpp"

#include <fmt/core.h>

namespace raya {

std::string accel_text(const Accel& accel) {
    if (accel.kind == AccelKind::kNone) return "none";
    if (accel.kind == AccelKind::kBvh) return "bvh";
    if (!accel.divisions) return "grid";
    const Divisions& d = *accel.divisions;
    return fmt::format("grid:{}x{}x{}", d[0], d[1], d[2]);
}

}  // namespace raya
