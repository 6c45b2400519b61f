// raya_import's reader of plain binary PLY files.
#pragma once
#include <string>

#include "host/mesh/import_output.hpp"

namespace raya {

/// Writes the mesh of a binary PLY file that has only vertices and faces. Returns false, and writes nothing, if assimp
/// must read the file. Throws MeshFault for faults that assimp passes over silently.
bool put_plain_ply(const std::string& file, ImportOutput& output);

}  // namespace raya
