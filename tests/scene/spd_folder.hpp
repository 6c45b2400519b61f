// Scenes of the Standard Procedural Databases, which are no part of raya.
#pragma once
#include <cstdlib>
#include <filesystem>

#include "tests/paths.h"

namespace raya {

/// RAYA_SPD_DIR, or a folder beside the project's; tests of what it lacks are left out.
inline std::filesystem::path spd_folder() {
    const char* given = std::getenv("RAYA_SPD_DIR");
    return given ? given : RAYA_SOURCE_DIR "/../shared/spd";
}

}  // namespace raya
