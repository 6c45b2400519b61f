// Checks of a file before assimp reads it. They find faults that assimp 5.2 passes over silently, or never ends on.
#pragma once
#include <string>

namespace raya {

/// Returns the fault of the file, or an empty string if assimp may read it. `extension`: in lower case, without dot.
/// - PLY: a header that is incomplete or has triangle strips, vertices without x, y or z, ascii data that breaks off.
/// - ascii STL that breaks off.
/// - glTF: broken JSON, and required extensions that change the geometry.
std::string fault_of_file(const std::string& file, const std::string& extension);

}  // namespace raya
