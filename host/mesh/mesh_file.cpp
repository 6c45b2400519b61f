#include "host/mesh/mesh_file.hpp"

#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/base/module.hpp"
#include "host/base/parallel.hpp"
#include "host/error.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

/// Maximum number of faces of a file: a job of more triangles would exceed kMaxWords of host/scene/packer.hpp.
constexpr std::uint64_t kMaxMeshFaces = 50'000'000;

/// Axis that points upwards in a format's files.
enum class UpAxis { kY, kZ };

bool is_point(const Vec3& v) {
    return std::abs(v.x) <= kMaxSceneLength && std::abs(v.y) <= kMaxSceneLength && std::abs(v.z) <= kMaxSceneLength;
}

bool is_direction(const Vec3& v) { return is_point(v) && v != Vec3(0); }

bool is_weight(double x) { return x >= 0 && x <= kMaxWeight; }

// Sets camera and lights. The eye sees `box`, that of all objects, from a three-quarter view, at the smallest distance
// at which the whole box is in a square image, and 5 % more. Two white lights are near the eye.
void set_default_view(Scene& scene, const Box& box, UpAxis up_axis) {
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
        const Vec3 arm = at - box.centre();
        distance =
            std::max(distance, arm.dot(back) + std::max(std::abs(arm.dot(right)), std::abs(arm.dot(top))) / half_image);
    }
    distance *= kMargin;
    scene.view.at = box.centre();
    scene.view.from = box.centre() + distance * back;
    scene.view.up = up;
    scene.lights = {{scene.view.from + distance / 2 * (top - right), {}}, {scene.view.from + distance / 2 * right, {}}};
}

/// The running program raya_import, and what it writes (import_program.cpp). assimp, which reads some file formats, has
/// a history of memory errors; in a process of its own they cannot damage raya.
class ImportProcess {
  public:
    explicit ImportProcess(const std::string& file)
        : child_({module_file(kProgram).string(), std::to_string(kReportDescriptor), file, std::to_string(limit_s_)}) {}

    /// Reads the next `count` values. Throws UserError if the program ends before.
    template <class Value>
    void take(Value* values, std::size_t count) {
        char* next = reinterpret_cast<char*>(values);
        for (std::size_t left = count * sizeof(Value); left > 0;) {
            if (unread_.empty()) fill();
            const std::size_t bytes = std::min(left, unread_.size());
            next = std::copy_n(unread_.begin(), bytes, next);
            unread_ = unread_.subspan(bytes);
            left -= bytes;
        }
    }

  private:
    static constexpr const char* kProgram = "raya_import";

    static long time_limit() {
        constexpr long kDefault = 120, kMax = 1'000'000;
        const std::string text = environment_value("RAYA_MESH_TIMEOUT");
        if (text.empty()) return kDefault;
        const long seconds = parsed_number<long>(text).value_or(0);
        if (seconds < 1 || seconds > kMax)
            throw UserError(fmt::format("RAYA_MESH_TIMEOUT={}: must be a number of seconds from 1 to {}", text, kMax));
        return seconds;
    }

    [[noreturn]] void refuse_end() {
        const int status = child_.wait();
        if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)
            throw UserError(fmt::format(
                "cannot read meshes: {} does not start; remedy: install assimp (Debian: libassimp5)", kProgram));
        if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
            throw UserError(
                fmt::format("reading the mesh takes more than {} s; the file may be damaged; remedy for a large file: "
                            "set RAYA_MESH_TIMEOUT",
                            limit_s_));
        throw UserError(fmt::format("cannot read the mesh: the import process ended with {}; the file may be damaged",
                                    ending_text(status)));
    }

    void fill() {
        std::optional<std::size_t> bytes;
        while (!bytes) bytes = child_.read(block_.data(), block_.size(), std::chrono::seconds(1));
        if (*bytes == 0) refuse_end();
        unread_ = {block_.data(), *bytes};
    }

    long limit_s_ = time_limit();
    Child child_;
    std::array<char, 1 << 16> block_{};
    std::span<const char> unread_;
};

/// A mesh whose faces the program writes.
struct Mesh {
    std::string name;
    int surface;
    bool has_normals;
};

/// Makes a scene of what the program writes. Checks every number.
class MeshReader {
  public:
    /// `remarks`: null in strict mode, in which each remark is a UserError instead.
    MeshReader(const std::string& file, std::vector<SceneRemark>* remarks) : process_(file), remarks_(remarks) {
        scene_.name = fs::path(file).filename().string();
        scene_.surfaces.emplace_back();  // for meshes without a material
    }

    /// Returns the scene with the default camera and lights.
    Scene read(UpAxis up) {
        const Json document = take_document();
        for (const std::string& file : json_strings(document.at("files"))) register_input(file);
        for (const Json& ignored : json_array(document.at("ignored"))) {
            const std::string &what = json_text(ignored.at(0)), &place = json_text(ignored.at(1));
            remark_or_refuse(place, what + " has no counterpart in raya", what + ", ignored");
        }
        for (const Json& surface : json_array(document.at("surfaces"))) add_surface(surface);
        std::uint64_t all_faces = 0;
        for (const Json& mesh : json_array(document.at("meshes"))) {
            const std::uint64_t faces = json_integer(mesh.at("faces"), kMaxMeshFaces);
            all_faces += faces;
            if (all_faces > kMaxMeshFaces)
                throw UserError(fmt::format("it has more than {} faces; use a coarser mesh", kMaxMeshFaces));
            reserve_in_huge_pages(scene_.polygons, all_faces);
            const Mesh made{json_text(mesh.at("name")),
                            static_cast<int>(json_integer(mesh.at("surface"), scene_.surfaces.size() - 1)),
                            mesh.at("has_normals").get<bool>()};
            for (std::uint64_t face = 1; face <= faces; ++face) add_face(made, face);
        }
        return finished(up);
    }

  private:
    void remark_or_refuse(const std::string& place, const std::string& reason, const std::string& what) {
        if (!remarks_) throw UserError(place.empty() ? reason : place + ": " + reason);
        add_remark(*remarks_, {.what = what, .place = place});
    }

    Json take_document() {
        constexpr std::uint64_t kMaxBytes = 1 << 30;
        std::uint64_t bytes = 0;
        process_.take(&bytes, 1);
        if (bytes > kMaxBytes) throw UserError("the import process sends invalid data");
        std::string text(bytes, '\0');
        process_.take(text.data(), bytes);
        Json document = Json::from_cbor(text);
        if (const Json* error = find_member(document, "error"))
            throw UserError("cannot read the mesh: " + json_text(*error));
        return document;
    }

    /// Adds a surface. Refuses numbers out of the range of NFF's `f`.
    void add_surface(const Json& numbers) {
        const auto number = [&](std::size_t i) { return numbers.at(i).get<double>(); };
        const Surface s{{number(1), number(2), number(3)}, number(4), number(5), number(6), number(7), number(8)};
        const bool is_legal = is_colour(s.colour) && is_weight(s.diffuse) && is_weight(s.specular) && s.shine >= 0 &&
                              s.shine <= kMaxNumber && is_weight(s.transmittance) && s.refraction_index > 0 &&
                              s.refraction_index <= kMaxNumber;
        if (!is_legal)
            throw UserError(
                fmt::format("material {}: a number is negative, too large or not finite: colour {} {} {}, Kd {}, Ks "
                            "{}, Shine {}, T {}, index of refraction {}",
                            in_quotes(json_text(numbers.at(0))), s.colour.x, s.colour.y, s.colour.z, s.diffuse,
                            s.specular, s.shine, s.transmittance, s.refraction_index));
        scene_.surfaces.push_back(s);
    }

    /// Adds the triangles of the next face. Leaves out faces without area, points, lines, and faces with a vertex that
    /// is not finite or beyond kMaxSceneLength, each with a remark. A face becomes a patch if its normals differ.
    void add_face(const Mesh& mesh, std::uint64_t face) {
        // Called only for messages, because a mesh has millions of faces.
        const auto place = [&] {
            return (mesh.name.empty() ? "" : "mesh " + in_quotes(mesh.name) + ", ") + fmt::format("face {}", face);
        };
        const auto report = [&](const std::string& reason, const std::string& what) {
            remark_or_refuse(place(), reason, what);
        };
        Polygon polygon{{}, {}, mesh.surface};
        std::uint32_t size = 0;
        process_.take(&size, 1);
        if (size > kMaxCutCorners)
            throw UserError(fmt::format("{}: it has {} corners; the most is {}; cut it in the program that made it",
                                        place(), size, kMaxCutCorners));
        vectors_.resize(mesh.has_normals ? 2 * size : size);
        process_.take(vectors_.data(), vectors_.size());
        polygon.vertices.reserve(size);
        for (std::size_t i = 0; i < vectors_.size(); ++i)
            (mesh.has_normals && i % 2 != 0 ? polygon.normals : polygon.vertices)
                .emplace_back(vectors_[i][0], vectors_[i][1], vectors_[i][2]);
        if (size < 3) return report("it is a point or a line", "point or line, left out");
        if (!std::ranges::all_of(polygon.vertices, is_point))
            return report("a coordinate is not finite or above 1e30 in magnitude",
                          "face with a coordinate that is not finite or above 1e30, left out");
        if (!std::ranges::all_of(polygon.normals, is_direction)) {
            report("a normal is missing, zero or not finite", "face in which a normal is missing or 0, taken as flat");
            polygon.normals.clear();
        }
        // Equal normals are those of flat shading. A flat polygon needs fewer words in a PE than a patch.
        if (std::ranges::adjacent_find(polygon.normals, std::not_equal_to()) == polygon.normals.end())
            polygon.normals.clear();
        for (Vec3& normal : polygon.normals) normal = unit_vector(normal);
        const OutlineFault fault = size > 3 ? clean_outline(polygon).fault : OutlineFault::kNoArea;
        if (fault == OutlineFault::kNone || fault == OutlineFault::kNotFlat) {
            for (Polygon& triangle : triangles_of(polygon)) add_polygon(scene_, std::move(triangle), std::cref(report));
            return;
        }
        add_polygon(scene_, std::move(polygon), std::cref(report));  // a copy would need memory for each face
    }

    Scene finished(UpAxis up) {
        constexpr double kFar = 100;  // at which the margin of secondary rays in e6m15 is 2 % of the mesh
        if (scene_.polygons.empty()) throw UserError("it has no triangle: the image would be empty");
        const Box box = scene_box(scene_);
        const double distance = box.centre().length(), size = box.size().length();
        if (distance > kFar * size)
            remark_or_refuse("", "it is too far from the origin for its size; move it to the origin",
                             fmt::format("its distance from the origin is {:.2g} times its size, so that rounding "
                                         "errors deform it: move it to the origin",
                                         distance / size));
        merge_equal_surfaces(scene_);
        set_default_view(scene_, box, up);
        return std::move(scene_);
    }

    ImportProcess process_;
    std::vector<SceneRemark>* remarks_;
    Scene scene_;
    std::vector<std::array<float, 3>> vectors_;  // of a face: its vertices, or a vertex and a normal for each corner
};

/// Checks that the file can be read, because assimp's messages do not say why it cannot.
void check_readable(const fs::path& file) {
    std::error_code error;
    const bool is_regular = fs::is_regular_file(file, error);
    if (!error && is_regular && ::access(file.c_str(), R_OK) != 0) error.assign(errno, std::generic_category());
    if (error || !is_regular)
        throw UserError(fmt::format("cannot read the mesh: {}", error ? error.message() : "it is not a regular file"));
}

constexpr std::array<std::string_view, 5> kMeshes = {".obj", ".ply", ".gltf", ".glb", ".stl"};
constexpr std::array<std::string_view, 12> kOtherMeshes = {".off", ".fbx",  ".dae",  ".3ds",  ".3mf",   ".x3d",
                                                           ".usd", ".usda", ".usdc", ".usdz", ".blend", ".abc"};

std::string lower_case_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
    return extension;
}

}  // namespace

bool is_mesh_file(const fs::path& path) { return std::ranges::count(kMeshes, lower_case_extension(path)) > 0; }

Scene read_scene_file(const fs::path& path, std::vector<SceneRemark>* remarks) {
    const std::string extension = lower_case_extension(path);
    if (std::ranges::count(kOtherMeshes, extension) > 0)
        throw UserError(fmt::format("{}: raya does not read {} files; convert it to OBJ, PLY, glTF or STL",
                                    path.string(), extension));
    if (!is_mesh_file(path)) return read_nff(path, remarks);
    const auto error_of = [&](const std::string& reason) { return UserError(path.string() + ": " + reason); };
    register_input(path);
    try {
        check_readable(path);
        return MeshReader(path.string(), remarks).read(extension == ".stl" ? UpAxis::kZ : UpAxis::kY);
    } catch (const Json::exception& error) {
        throw error_of("the import process sends invalid data: " + json_reason(error));
    } catch (const ModuleError& error) {
        throw error_of(
            fmt::format("cannot read meshes: {}; remedy: use a complete installation of raya", error.what()));
    } catch (const UserError& error) {
        throw error_of(error.what());
    }
}

}  // namespace raya
