// Import of a mesh by another process. The library assimp, which reads some file formats, has a history of memory
// errors; in a process of its own they cannot damage raya. raya checks everything that the process sends.
#pragma once
#include <filesystem>

#include "host/mesh/mesh_scene.hpp"

namespace raya {

/// Reads a file with the program raya_import and adds its surfaces and meshes to the scene. Throws UserError with the
/// file's name if the file cannot be read, or if the program is missing, crashes, needs too much memory, or takes more
/// than RAYA_MESH_TIMEOUT seconds (120).
void import_mesh(const std::filesystem::path& file, MeshScene& scene);

}  // namespace raya
