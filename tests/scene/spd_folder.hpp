// Scenes of the Standard Procedural Databases (SPD), which are not part of raya.
#pragma once
#include <cstdlib>
#include <filesystem>

#include "tests/paths.h"

namespace raya {

/// The folder named by RAYA_SPD_DIR; by default ../shared/spd, relative to the source folder. Tests skip missing files.
inline std::filesystem::path spd_folder() {
    const char* given = std::getenv("RAYA_SPD_DIR");
    return given ? given : RAYA_SOURCE_DIR "/../shared/spd";
}

}  // namespace raya
