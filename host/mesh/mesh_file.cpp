#include "host/mesh/mesh_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/mesh/import_records.hpp"
#include "host/scene/nff_tokens.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

constexpr double kMaxWeight = 100;  // of Kd, Ks and T, as in NFF

bool is_point(const Vec3& v) {
    return std::abs(v.x) <= kMaxSceneLength && std::abs(v.y) <= kMaxSceneLength && std::abs(v.z) <= kMaxSceneLength;
}

bool is_direction(const Vec3& v) { return is_point(v) && v != Vec3(0); }

bool is_weight(double x) { return x >= 0 && x <= kMaxWeight; }

/// Returns "mesh NAME, face NUMBER". Called only for messages, because a mesh has millions of faces.
std::string place_of(const Mesh& mesh, std::uint64_t face) {
    return (mesh.name.empty() ? "" : "mesh " + in_quotes(mesh.name) + ", ") + fmt::format("face {}", face);
}

bool all_equal(const std::vector<Vec3>& vectors) {
    return std::ranges::all_of(vectors, [&](const Vec3& v) { return v == vectors.front(); });
}

// Sets camera and lights. The eye sees `box`, that of all objects, from a three-quarter view, at the smallest distance
// at which the whole box is in a square image, and 5 % more. Two white lights are near the eye.
void set_default_view(Scene& scene, const Imath::Box3d& box, UpAxis up_axis) {
    constexpr double kMargin = 1.05;
    const Vec3 up = up_axis == UpAxis::kY ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    const Vec3 front = up_axis == UpAxis::kY ? Vec3(0, 0, 1) : Vec3(0, -1, 0), side(1, 0, 0);
    const Vec3 back = (2.0 * side + 2.0 * up + 3.0 * front).normalized();  // from the centre to the eye
    const Vec3 right = up.cross(back).normalized(), top = back.cross(right);
    const double half_image = std::tan(scene.view.angle_degrees * std::numbers::pi / 360);  // at distance 1
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                      corner & 4 ? box.max.z : box.min.z);
        const Vec3 arm = at - box.center();
        distance =
            std::max(distance, arm.dot(back) + std::max(std::abs(arm.dot(right)), std::abs(arm.dot(top))) / half_image);
    }
    distance *= kMargin;
    scene.view.at = box.center();
    scene.view.from = box.center() + distance * back;
    scene.view.up = up;
    scene.lights = {{scene.view.from + distance / 2 * (top - right), {}}, {scene.view.from + distance / 2 * right, {}}};
}

}  // namespace

MeshScene::MeshScene(const std::string& file, std::vector<SceneRemark>* remarks) : file_(file), remarks_(remarks) {
    scene_.name = std::filesystem::path(file).filename().string();
    scene_.surfaces.emplace_back();
}

void MeshScene::refuse(const std::string& reason) const { throw UserError(fmt::format("{}: {}", file_, reason)); }

void MeshScene::remark_or_refuse(const std::string& place, const std::string& reason, const std::string& what) {
    if (!remarks_) refuse(place.empty() ? reason : place + ": " + reason);
    add_remark(*remarks_, {.what = what, .place = place});
}

void MeshScene::ignore(const std::string& what, const std::string& place) {
    remark_or_refuse(place, what + " has no counterpart in raya", what + ", ignored");
}

int MeshScene::add_surface(const std::string& name, const Surface& s) {
    const bool is_legal = is_colour(s.colour) && is_weight(s.diffuse) && is_weight(s.specular) && s.shine >= 0 &&
                          s.shine <= kMaxNumber && is_weight(s.transmittance) && s.refraction_index > 0 &&
                          s.refraction_index <= kMaxNumber;
    if (!is_legal)
        refuse(
            fmt::format("material {}: a number is negative, too large or not finite: colour {} {} {}, Kd {}, Ks {}, "
                        "Shine {}, T {}, index of refraction {}",
                        in_quotes(name), s.colour.x, s.colour.y, s.colour.z, s.diffuse, s.specular, s.shine,
                        s.transmittance, s.refraction_index));
    scene_.surfaces.push_back(s);
    return static_cast<int>(scene_.surfaces.size()) - 1;
}

Polygon MeshScene::polygon_of(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size) {
    Polygon polygon{{}, {}, mesh.surface};
    polygon.vertices.reserve(size);
    for (std::size_t i = first_corner; i < first_corner + size; ++i) {
        const std::uint32_t corner = mesh.corners[i];
        if (corner >= mesh.vertices.size())
            refuse(fmt::format("{}: there is no vertex {}; the mesh has {}, numbered from 0; the file may be damaged",
                               place_of(mesh, face), corner, mesh.vertices.size()));
        polygon.vertices.emplace_back(mesh.vertices[corner]);
        if (!mesh.normals.empty()) polygon.normals.emplace_back(mesh.normals[corner]);
    }
    if (!std::ranges::all_of(polygon.vertices, is_point)) {
        remark_or_refuse(place_of(mesh, face), "a coordinate is not finite or above 1e30 in magnitude",
                         "face with a coordinate that is not finite or above 1e30, left out");
        return {};
    }
    if (!std::ranges::all_of(polygon.normals, is_direction)) {
        remark_or_refuse(place_of(mesh, face), "a normal is missing, zero or not finite",
                         "face in which a normal is missing or 0, taken as flat");
        polygon.normals.clear();
    }
    // Equal normals are those of flat shading. A flat polygon needs fewer words in a PE than a patch.
    if (!polygon.normals.empty() && all_equal(polygon.normals)) polygon.normals.clear();
    for (Vec3& normal : polygon.normals) normal = unit_vector(normal);
    return polygon;
}

void MeshScene::add_face(const Mesh& mesh, std::uint64_t face, std::size_t first_corner, std::size_t size) {
    const auto report = [&](const std::string& reason, const std::string& what) {
        remark_or_refuse(place_of(mesh, face), reason, what);
    };
    if (size < 3) return report("it is a point or a line", "point or line, left out");
    Polygon polygon = polygon_of(mesh, face, first_corner, size);
    if (polygon.vertices.empty()) return;
    if (size > 3) {
        const OutlineFault fault = clean_outline(polygon).fault;
        if (fault == OutlineFault::kNone || fault == OutlineFault::kNotFlat) {
            try {
                for (Polygon& triangle : triangles_of(polygon))
                    add_polygon(scene_, std::move(triangle), std::cref(report));
            } catch (const UserError& error) {
                refuse(place_of(mesh, face) + ": " + error.what());
            }
            return;
        }
    }
    add_polygon(scene_, std::move(polygon), std::cref(report));  // a copy would need memory for each face
}

void MeshScene::add(const Mesh& mesh) {
    const std::uint64_t faces = mesh.sizes.empty() ? mesh.corners.size() / 3 : mesh.sizes.size();
    faces_ += faces;
    if (faces_ > kMaxMeshFaces) refuse(fmt::format("it has more than {} faces; use a coarser mesh", kMaxMeshFaces));
    scene_.polygons.reserve(scene_.polygons.size() + faces);
    std::size_t corner = 0;
    for (std::uint64_t face = 0; face < faces; ++face) {
        const std::size_t size = mesh.sizes.empty() ? 3 : mesh.sizes[face];
        if (size > mesh.corners.size() - corner) refuse("a mesh has faces with more corners than it lists");
        add_face(mesh, face + 1, corner, size);
        corner += size;
    }
}

Scene MeshScene::finish(UpAxis up) {
    constexpr double kFar = 100;  // at which the margin of secondary rays in e6m15 is 2 % of the mesh
    if (scene_.polygons.empty()) refuse("it has no triangle: the image would be empty");
    const Imath::Box3d box = scene_box(scene_);
    const double distance = box.center().length(), size = box.size().length();
    if (distance > kFar * size)
        remark_or_refuse("", "it is too far from the origin for its size; move it to the origin",
                         fmt::format("its distance from the origin is {:.2g} times its size, so that rounding errors "
                                     "deform it: move it to the origin",
                                     distance / size));
    merge_equal_surfaces(scene_);
    set_default_view(scene_, box, up);
    return std::move(scene_);
}

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
        : scene_(scene), limit_(time_limit()), deadline_(Clock::now() + limit_) {
        const std::string program = import_program(scene);
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot create a pipe to a child process");
        pipe_ = ends[0];
        try {
            child_ = start_child(program, {kImportProgram, std::to_string(ends[1]), file.string()}, ends[1]);
        } catch (...) {
            for (const int end : ends) ::close(end);
            throw;
        }
        ::close(ends[1]);
    }
    ImportProcess(const ImportProcess&) = delete;
    ImportProcess& operator=(const ImportProcess&) = delete;
    ~ImportProcess() override {
        ::close(pipe_);
        if (child_ >= 0) wait(Clock::now());
    }

    void take(char* bytes, std::size_t count) override {
        while (count > 0) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now());
            pollfd in{pipe_, POLLIN, 0};
            const int ready = left.count() > 0 ? ::poll(&in, 1, static_cast<int>(left.count())) : 0;
            if (ready == 0)
                scene_.refuse(fmt::format(
                    "reading the mesh takes more than {} s; the file may be damaged; remedy for a large file: set "
                    "RAYA_MESH_TIMEOUT",
                    limit_.count()));
            const ssize_t read_bytes = ready > 0 ? ::read(pipe_, bytes, count) : -1;
            if (read_bytes < 0 && errno == EINTR) continue;
            if (read_bytes <= 0) refuse_end();
            bytes += read_bytes;
            count -= static_cast<std::size_t>(read_bytes);
        }
    }

  private:
    [[noreturn]] void refuse_end() {
        const int status = wait(deadline_);
        if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
            scene_.refuse(fmt::format(
                "cannot read meshes: {} does not start; remedy: install assimp (Debian: libassimp5)", kImportProgram));
        scene_.refuse(fmt::format("cannot read the mesh: the import process ended with {}; the file may be damaged",
                                  ending_text(status)));
    }

    /// Waits for the end of the process, kills it at the deadline, and returns its status.
    int wait(Clock::time_point deadline) {
        int status = 0;
        while (::waitpid(child_, &status, WNOHANG) == 0) {
            if (Clock::now() >= deadline) ::kill(child_, SIGKILL);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        child_ = -1;
        return status;
    }

    const MeshScene& scene_;
    std::chrono::seconds limit_;
    Clock::time_point deadline_;
    int pipe_ = -1;
    pid_t child_ = -1;
};

/// Checks that the file can be read, because assimp's messages do not say why it cannot.
void check_readable(const std::filesystem::path& file, const MeshScene& scene) {
    std::error_code error;
    const bool is_regular = std::filesystem::is_regular_file(file, error);
    if (!error && is_regular && ::access(file.c_str(), R_OK) != 0) error.assign(errno, std::generic_category());
    if (error || !is_regular)
        scene.refuse(fmt::format("cannot read the mesh: {}", error ? error.message() : "it is not a regular file"));
}

}  // namespace

namespace {

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
