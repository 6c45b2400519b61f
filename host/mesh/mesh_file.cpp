#include "host/mesh/mesh_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "host/error.hpp"
#include "host/mesh/import_process.hpp"
#include "host/mesh/mesh_scene.hpp"
#include "host/scene/nff.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kOtherMeshes = {".off", ".fbx",  ".dae",  ".3ds",  ".3mf",   ".x3d",
                                                           ".usd", ".usda", ".usdc", ".usdz", ".blend", ".abc"};

std::string lower_case_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
    return extension;
}

}  // namespace

const std::vector<std::string>& mesh_extensions() {
    static const std::vector<std::string> extensions = {".obj", ".ply", ".gltf", ".glb", ".stl"};
    return extensions;
}

bool is_mesh_file(const fs::path& path) {
    return std::ranges::count(mesh_extensions(), lower_case_extension(path)) > 0;
}

Scene read_scene_file(const fs::path& path, std::vector<SceneRemark>* remarks) {
    const std::string extension = lower_case_extension(path);
    if (std::ranges::count(kOtherMeshes, extension) > 0)
        throw UserError(fmt::format("{}: raya does not read {} files; convert it to OBJ, PLY, glTF or STL",
                                    path.string(), extension));
    if (!is_mesh_file(path)) return read_nff(path, remarks);
    MeshScene mesh(path.string(), remarks);
    import_mesh(path, mesh);
    return mesh.finish(extension == ".stl" ? UpAxis::kZ : UpAxis::kY);
}

}  // namespace raya
