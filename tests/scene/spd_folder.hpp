// Scenes of the Standard Procedural Databases (SPD), which are not part of raya.
#pragma once
#include <cstdlib>
#include <filesystem>

#include "tests/paths.h"

namespace raya {

/// Returns the folder of SPD's scenes: RAYA_SPD_DIR, or by default ../shared/spd relative to the source folder. Tests
/// skip files that the folder does not contain.
inline std::filesystem::path spd_folder() {
    const char* folder = std::getenv("RAYA_SPD_DIR");
    return folder ? folder : RAYA_SOURCE_DIR "/../shared/spd";
}

}  // namespace raya
