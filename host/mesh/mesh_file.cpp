#include "host/mesh/mesh_file.hpp"

#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <string_view>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/mesh/import_records.hpp"
#include "host/scene/nff_tokens.hpp"

namespace raya {
namespace {

using Clock = std::chrono::steady_clock;

std::chrono::seconds time_limit() {
    constexpr long kDefault = 120, kMax = 1'000'000;
    const std::string text = environment_value("RAYA_MESH_TIMEOUT");
    if (text.empty()) return std::chrono::seconds(kDefault);
    const long seconds = parsed_number<long>(text).value_or(0);
    if (seconds < 1 || seconds > kMax)
        throw UserError(fmt::format("RAYA_MESH_TIMEOUT={}: must be a number of seconds from 1 to {}", text, kMax));
    return std::chrono::seconds(seconds);
}

std::filesystem::path import_program(const MeshScene& scene) {
    try {
        return module_file(kImportProgram);
    } catch (const ModuleError& error) {
        scene.refuse(fmt::format("cannot read meshes: {}; remedy: use a complete installation of raya", error.what()));
    }
}

/// The running program and the records that it sends.
class ImportProcess : public RecordSource {
  public:
    ImportProcess(const std::filesystem::path& file, const MeshScene& scene)
        : scene_(scene), child_({import_program(scene), std::to_string(kReportDescriptor), file.string()}) {}

    void take(char* bytes, std::size_t count) override {
        while (count > 0) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now());
            if (left.count() <= 0)
                scene_.refuse(fmt::format(
                    "reading the mesh takes more than {} s; the file may be damaged; remedy for a large file: set "
                    "RAYA_MESH_TIMEOUT",
                    limit_.count()));
            const auto got = child_.read(bytes, count, left);
            if (got == 0u) refuse_end();
            bytes += got.value_or(0);
            count -= got.value_or(0);
        }
    }

  private:
    [[noreturn]] void refuse_end() {
        const int status = child_.wait();
        if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
            scene_.refuse(fmt::format(
                "cannot read meshes: {} does not start; remedy: install assimp (Debian: libassimp5)", kImportProgram));
        scene_.refuse(fmt::format("cannot read the mesh: the import process ended with {}; the file may be damaged",
                                  ending_text(status)));
    }

    const MeshScene& scene_;
    std::chrono::seconds limit_ = time_limit();
    Clock::time_point deadline_ = Clock::now() + limit_;
    Child child_;
};

/// Checks that the file can be read, because assimp's messages do not say why it cannot.
void check_readable(const std::filesystem::path& file, const MeshScene& scene) {
    std::error_code error;
    const bool is_regular = std::filesystem::is_regular_file(file, error);
    if (!error && is_regular && ::access(file.c_str(), R_OK) != 0) error.assign(errno, std::generic_category());
    if (error || !is_regular)
        scene.refuse(fmt::format("cannot read the mesh: {}", error ? error.message() : "it is not a regular file"));
}

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kOtherMeshes = {".off", ".fbx",  ".dae",  ".3ds",  ".3mf",   ".x3d",
                                                           ".usd", ".usda", ".usdc", ".usdz", ".blend", ".abc"};

std::string lower_case_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
    return extension;
}

/// Reads a file with the program raya_import and adds its surfaces and meshes to the scene. Throws UserError with the
/// file's name if the file cannot be read, or if the program is missing, crashes, needs too much memory, or takes more
/// than RAYA_MESH_TIMEOUT seconds (120).
void import_mesh(const std::filesystem::path& file, MeshScene& scene) {
    check_readable(file, scene);
    register_input(file);
    ImportProcess process(file, scene);
    read_records(process, scene);
}

/// Returns the extensions of meshes: ".obj", ".ply", ".gltf", ".glb", ".stl".
const std::vector<std::string>& mesh_extensions() {
    static const std::vector<std::string> extensions = {".obj", ".ply", ".gltf", ".glb", ".stl"};
    return extensions;
}

}  // namespace

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
