// Scenes from mesh files. docs/meshes.md describes the formats, the materials, and the default camera and lights.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/mesh/mesh_scene.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

// Import of a mesh by another process. The library assimp, which reads some file formats, has a history of memory
// errors; in a process of its own they cannot damage raya. raya checks everything that the process sends.

/// Reads a file with the program raya_import and adds its surfaces and meshes to the scene. Throws UserError with the
/// file's name if the file cannot be read, or if the program is missing, crashes, needs too much memory, or takes more
/// than RAYA_MESH_TIMEOUT seconds (120).
void import_mesh(const std::filesystem::path& file, MeshScene& scene);

/// Returns the extensions of meshes: ".obj", ".ply", ".gltf", ".glb", ".stl".
const std::vector<std::string>& mesh_extensions();

/// Returns true if the file's extension, in upper or lower case, is that of a mesh.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a scene: a mesh if is_mesh_file(), else NFF as read_nff() does. Every face of a mesh becomes plain triangles
/// that have passed the checks of NFF's polygons. Another process reads the file (import_process.hpp).
/// Throws UserError with the file's name. If `remarks` is null (--strict), throws UserError for everything that would
/// otherwise become a remark.
Scene read_scene_file(const std::filesystem::path& path, std::vector<SceneRemark>* remarks = nullptr);

}  // namespace raya
