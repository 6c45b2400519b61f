// Scenes from mesh files. docs/meshes.md describes the formats, the materials, and the default camera and lights.
#pragma once
#include <filesystem>
#include <vector>

#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Returns true if the file's extension, in upper or lower case, is that of a mesh.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a scene: a mesh if is_mesh_file(), else NFF as read_nff() does. Every face of a mesh becomes plain triangles
/// that have passed the checks of NFF's polygons. Another process reads the file (import_program.cpp), within
/// RAYA_MESH_TIMEOUT seconds (120). Throws UserError with the file's name. If `remarks` is null (--strict), throws
/// UserError for everything that would otherwise become a remark.
Scene read_scene_file(const std::filesystem::path& path, std::vector<SceneRemark>* remarks = nullptr);

}  // namespace raya
