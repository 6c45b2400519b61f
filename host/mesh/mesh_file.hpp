// Scenes from mesh files. docs/meshes.md describes the formats, the materials, and the default camera and lights.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

// A scene that is built from the meshes of a file. Checks every number that a mesh reader delivers.

/// Maximum number of faces of a file: a job of more triangles would exceed kMaxWords of host/scene/packer.hpp.
inline constexpr std::uint64_t kMaxMeshFaces = 50'000'000;

/// Faces that share vertices and a surface. Nothing in it is checked yet.
struct Mesh {
    std::string name;
    int surface = 0;                     // returned by MeshScene::add_surface()
    std::vector<Imath::V3f> vertices;    // scene units
    std::vector<Imath::V3f> normals;     // empty, or a normal of any length for each vertex
    std::vector<std::uint32_t> corners;  // indices of vertices: the corners of the first face, of the second, ...
    std::vector<std::uint32_t> sizes;    // number of corners of each face; empty: all faces are triangles
};

/// Axis that points upwards in a format's files.
enum class UpAxis { kY, kZ };

class MeshScene {
  public:
    /// `file`: for messages. `remarks`: null in strict mode, in which each remark is a UserError instead.
    MeshScene(const std::string& file, std::vector<SceneRemark>* remarks);

    /// Throws UserError "FILE: reason".
    [[noreturn]] void refuse(const std::string& reason) const;

    /// Adds the remark that `what` was ignored. `place`: "material 'wood'"; empty: the whole file.
    void ignore(const std::string& what, const std::string& place);

    /// Adds a surface and returns its index. Throws UserError if a number is out of the range of NFF's `f`. Surface 0
    /// exists already: white with Kd = 1, as in NFF.
    int add_surface(const std::string& name, const Surface& surface);

    /// Adds the triangles of a mesh. Leaves out faces without area, points, lines, and faces with a vertex that is not
    /// finite or beyond kMaxSceneLength, each with a remark. A face becomes a patch if its normals differ. Throws
    /// UserError with mesh and face if an index is out of range.
    void add(const Mesh& mesh);

    /// Returns the scene with the default camera and lights. Throws UserError if it has no triangle.
    Scene finish(UpAxis up);

  private:
    void remark_or_refuse(const std::string& place, const std::string& reason, const std::string& what);
    /// Returns the face's polygon, or one with fewer than three vertices if the face has been left out with a remark.
    Polygon polygon_of(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size);
    void add_face(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size);

    std::string file_;
    std::vector<SceneRemark>* remarks_;
    Scene scene_;
    std::uint64_t faces_ = 0;
};

// Import of a mesh by another process. The library assimp, which reads some file formats, has a history of memory
// errors; in a process of its own they cannot damage raya. raya checks everything that the process sends.

/// Returns true if the file's extension, in upper or lower case, is that of a mesh.
bool is_mesh_file(const std::filesystem::path& path);

/// Reads a scene: a mesh if is_mesh_file(), else NFF as read_nff() does. Every face of a mesh becomes plain triangles
/// that have passed the checks of NFF's polygons. Another process reads the file (import_program.cpp).
/// Throws UserError with the file's name. If `remarks` is null (--strict), throws UserError for everything that would
/// otherwise become a remark.
Scene read_scene_file(const std::filesystem::path& path, std::vector<SceneRemark>* remarks = nullptr);

}  // namespace raya
