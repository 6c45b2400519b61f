// Small mesh files, made by the tests.
#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "host/base/encoding.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/mesh/mesh_file.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {

/// A scene and the texts of its remarks, without the folder of the file.
struct ReadMesh {
    Scene scene;
    std::vector<std::string> remarks;
};

/// Writes `bytes` to the file `name` in a new folder and reads it. In messages of UserError, the name has no folder.
inline ReadMesh read_mesh(const std::string& name, const std::string& bytes, bool strict = false) {
    const ScratchFolder folder;
    write_whole_file(folder / name, bytes);
    std::vector<SceneRemark> remarks;
    ReadMesh mesh;
    try {
        mesh.scene = read_scene_file(folder / name, strict ? nullptr : &remarks);
    } catch (const UserError& error) {
        throw UserError(replaced(error.what(), folder.path().string() + "/", ""));
    }
    for (const SceneRemark& remark : remarks)
        mesh.remarks.push_back(replaced(remark_text(name, remark), folder.path().string() + "/", ""));
    return mesh;
}

/// Appends the bytes of a number, in the byte order of a little-endian computer or reversed.
template <class Number>
void append(std::string& bytes, Number number, bool big_endian = false) {
    std::array<char, sizeof number> text;
    std::memcpy(text.data(), &number, sizeof number);
    if (big_endian) std::reverse(text.begin(), text.end());
    bytes.append(text.data(), text.size());
}

// A tetrahedron with four vertices, and its faces.
inline const std::vector<std::array<float, 3>> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline const std::vector<std::array<std::uint32_t, 3>> kFaces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

inline std::string tetrahedron_obj(const std::string& before = "") {
    std::string text = before;
    for (const auto& v : kCorners) text += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
    for (const auto& f : kFaces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    return text;
}

/// A binary PLY file of the tetrahedron with all of the format's types of integers.
inline std::string tetrahedron_ply(bool big_endian = false) {
    std::string bytes = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                        "_endian 1.0\ncomment made by a test\nelement vertex 4\nproperty float x\nproperty double y\n"
                        "property float32 z\nproperty short quality\nelement face 4\nproperty uint8 flags\n"
                        "property list uchar int vertex_indices\nproperty list ushort int16 extra\n"
                        "element edge 1\nproperty int8 length\nend_header\n";
    for (const auto& v : kCorners) {
        append(bytes, v[0], big_endian);
        append(bytes, double{v[1]}, big_endian);
        append(bytes, v[2], big_endian);
        append(bytes, std::int16_t{-7}, big_endian);
    }
    for (const auto& f : kFaces) {
        append(bytes, std::uint8_t{1});
        append(bytes, std::uint8_t{3});
        for (const std::uint32_t corner : f) append(bytes, corner, big_endian);
        append(bytes, std::uint16_t{1}, big_endian);
        append(bytes, std::int16_t{9}, big_endian);
    }
    return bytes + '\x05';
}

inline std::string tetrahedron_ascii_ply() {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    for (const auto& v : kCorners) text += fmt::format("{} {} {}\n", v[0], v[1], v[2]);
    for (const auto& f : kFaces) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    return text;
}

inline std::string tetrahedron_binary_stl() {
    std::string bytes(80, ' ');
    append(bytes, std::uint32_t{4});
    for (const auto& f : kFaces) {
        for (int i = 0; i < 3; ++i) append(bytes, 0.0f);  // normal
        for (const std::uint32_t corner : f)
            for (const float x : kCorners[corner]) append(bytes, x);
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

/// Vertices and indices of the tetrahedron, as a glTF buffer of 48 + 24 bytes.
inline std::string tetrahedron_buffer() {
    std::string buffer;
    for (const auto& v : kCorners)
        for (const float x : v) append(buffer, x);
    for (const auto& f : kFaces)
        for (const std::uint32_t corner : f) append(buffer, static_cast<std::uint16_t>(corner));
    return buffer;
}

/// The JSON of a glTF file of the tetrahedron. `node` and `material` contain further members; `uri`: of the buffer.
inline std::string tetrahedron_gltf(const std::string& uri, const std::string& node = "",
                                    const std::string& material = "", const std::string& more = "") {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
           R"(}],"meshes":[{"name":"tetra","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)" +
           R"("materials":[{"name":"paint")" + material + R"(}],"buffers":[{)" + uri +
           R"("byteLength":72}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},)" +
           R"({"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[{"bufferView":0,"componentType":5126,)" +
           R"("count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":12,)" +
           R"("type":"SCALAR"}])" + more + "}";
}

inline std::string embedded_buffer() {
    return "\"uri\":\"data:application/octet-stream;base64," + base64(tetrahedron_buffer()) + "\",";
}

/// A GLB file: the header, a chunk of JSON and a chunk with the buffer.
inline std::string tetrahedron_glb() {
    std::string json = tetrahedron_gltf(""), buffer = tetrahedron_buffer(), bytes = "glTF";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    append(bytes, std::uint32_t{2});
    append(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
    append(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    append(bytes, static_cast<std::uint32_t>(buffer.size()));
    return bytes + std::string("BIN\0", 4) + buffer;
}

}  // namespace raya
