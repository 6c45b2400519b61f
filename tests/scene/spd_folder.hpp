// Scenes of the Standard Procedural Databases (SPD), which are not part of raya.
#pragma once
#include <cstdlib>
#include <filesystem>

#include "tests/paths.h"

namespace raya {

/// RAYA_SPD_DIR, or ../shared/spd next to the project's folder. Tests skip files that are missing.
inline std::filesystem::path spd_folder() {
    const char* given = std::getenv("RAYA_SPD_DIR");
    return given ? given : RAYA_SOURCE_DIR "/../shared/spd";
}

}  // namespace raya
