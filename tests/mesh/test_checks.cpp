// The checks of faces, in binary PLY: normals, polygons, faults.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/mesh/mesh_files.hpp"

namespace raya {
namespace {

using Catch::Contains;
using Remarks = std::vector<std::string>;

/// Returns a little-endian PLY file of triangles, with floats x, y, z and further properties of the vertices.
std::string ply(const std::vector<std::vector<float>>& vertices, const std::vector<std::vector<std::int32_t>>& faces,
                const std::string& more_properties = "") {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\n{}element face {}\nproperty list uchar int vertex_index\nend_header\n",
        vertices.size(), more_properties, faces.size());
    for (const std::vector<float>& vertex : vertices)
        for (const float x : vertex) append(bytes, x);
    for (const std::vector<std::int32_t>& face : faces) {
        append(bytes, static_cast<std::uint8_t>(face.size()));
        for (const std::int32_t corner : face) append(bytes, corner);
    }
    return bytes;
}

const char* const kNormals = "property float nx\nproperty float ny\nproperty float nz\n";

/// As ply(), with x as double, normals, either byte order and, for_assimp, an element that leaves the file to assimp.
std::string other_ply(const std::vector<std::vector<float>>& vertices,
                      const std::vector<std::vector<std::int32_t>>& faces, bool big_endian, bool for_assimp) {
    std::string bytes = fmt::format(
        "ply\nformat binary_{}_endian 1.0\nelement vertex {}\nproperty double x\nproperty float y\nproperty float "
        "z\n{}element face {}\nproperty list uchar uint vertex_indices\n{}end_header\n",
        big_endian ? "big" : "little", vertices.size(), kNormals, faces.size(),
        for_assimp ? "element edge 1\nproperty uchar flags\n" : "");
    for (const std::vector<float>& vertex : vertices) {
        append(bytes, double{vertex[0]}, big_endian);
        for (std::size_t i = 1; i < vertex.size(); ++i) append(bytes, vertex[i], big_endian);
    }
    for (const std::vector<std::int32_t>& face : faces) {
        append(bytes, static_cast<std::uint8_t>(face.size()));
        for (const std::int32_t corner : face) append(bytes, static_cast<std::uint32_t>(corner), big_endian);
    }
    return for_assimp ? bytes + '\1' : bytes;
}

const std::vector<std::vector<float>> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST_CASE("meshes: faces with equal normals are flat, others become patches with normals of length 1", "[mesh]") {
    const auto normals_of = [](std::vector<std::vector<float>> vertices) {
        return read_mesh("n.ply", ply(vertices, {{0, 1, 2}}, kNormals));
    };
    CHECK(normals_of({{0, 0, 0, 0, 0, 1}, {1, 0, 0, 0, 0, 1}, {0, 1, 0, 0, 0, 1}}).scene.polygons[0].normals.empty());
    const ReadMesh patch = normals_of({{0, 0, 0, 0, 0, 2}, {1, 0, 0, 3, 0, 4}, {0, 1, 0, 0, 0, 1}});
    CHECK(patch.remarks.empty());
    CHECK(patch.scene.polygons[0].normals == std::vector<Vec3>{{0, 0, 1}, {0.6, 0, 0.8}, {0, 0, 1}});
    const ReadMesh zero = normals_of({{0, 0, 0, 0, 0, 0}, {1, 0, 0, 3, 0, 4}, {0, 1, 0, 0, 0, 1}});
    CHECK(zero.remarks == Remarks{"n.ply: face 1: face in which a normal is missing or 0, taken as flat"});
    CHECK(zero.scene.polygons[0].normals.empty());
}

TEST_CASE("meshes: raya's reader of binary PLY reads the same as assimp", "[mesh]") {
    std::mt19937 random(20261130);
    const auto number = [&] { return static_cast<float>(random() % 2000) / 1000 - 1; };
    std::vector<std::vector<float>> vertices(50);
    for (auto& vertex : vertices) vertex = {number(), number(), number(), number(), number(), 1};
    std::vector<std::vector<std::int32_t>> faces(40);
    for (auto& face : faces)
        for (unsigned k = 0; k < 3; ++k) face.push_back(static_cast<std::int32_t>(random() % 50));
    const auto polygons_of = [&](bool big_endian, bool for_assimp) {
        return read_mesh("r.ply", other_ply(vertices, faces, big_endian, for_assimp)).scene.polygons;
    };
    const auto wanted = polygons_of(false, true);
    REQUIRE(wanted.size() > 30);
    for (const bool big_endian : {false, true}) {
        const auto polygons = polygons_of(big_endian, false);
        REQUIRE(polygons.size() == wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            CHECK(polygons[i].vertices == wanted[i].vertices);
            CHECK(polygons[i].normals == wanted[i].normals);
        }
    }
    const std::string bytes = other_ply(vertices, faces, false, false);
    for (const std::size_t cut : {1, 100, 600})
        CHECK_THROWS_WITH(read_mesh("r.ply", bytes.substr(0, bytes.size() - cut)),
                          "r.ply: cannot read the mesh: PLY: numbers are missing; the file may be truncated");
}

TEST_CASE("meshes: polygons are cut into triangles", "[mesh]") {
    const ReadMesh square = read_mesh("s.ply", ply(kSquare, {{0, 1, 2, 3}}));
    CHECK(square.remarks.empty());
    CHECK(square.scene.polygons.size() == 2);
    const auto bent = std::vector<std::vector<float>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0}};
    const ReadMesh bent_mesh = read_mesh("s.ply", ply(bent, {{0, 1, 2}, {0, 1, 2, 3}}));
    CHECK(bent_mesh.remarks.empty());
    CHECK(bent_mesh.scene.polygons.size() == 3);
    CHECK(read_mesh("s.ply", ply(bent, {{0, 1, 2, 3}}), true).scene.polygons.size() == 2);
}

TEST_CASE("meshes: faces that cannot be traced are left out and counted; --strict refuses them", "[mesh]") {
    const float nan = std::nanf("");
    auto vertices = kSquare;
    vertices.insert(vertices.end(), {{nan, 0, 0}, {2, 0, 0}});
    const std::string bytes = ply(vertices, {{0, 1, 2}, {0, 1, 4}, {0, 1, 5}, {0, 0, 1}, {0, 1}, {2}, {4, 1, 2}});
    const ReadMesh mesh = read_mesh("f.ply", bytes);
    CHECK(mesh.remarks ==
          Remarks{"f.ply: face 2: face with a coordinate that is not finite or above 1e30, left out (2 in all)",
                  "f.ply: face 3: polygon without area, left out (2 in all)",
                  "f.ply: face 5: point or line, left out (2 in all)"});
    CHECK(mesh.scene.polygons.size() == 1);
    CHECK_THROWS_WITH(read_mesh("f.ply", bytes, true),
                      "f.ply: face 2: a coordinate is not finite or above 1e30 in magnitude");
    CHECK_THROWS_WITH(read_mesh("f.ply", ply(vertices, {{0, 0, 1}}), true),
                      "f.ply: face 1: the polygon has fewer than three different vertices");
    CHECK_THROWS_WITH(read_mesh("f.ply", ply(vertices, {{0, 1}}), true), "f.ply: face 1: it is a point or a line");
}

TEST_CASE("meshes: a mesh far from the origin gets a remark; --strict refuses it", "[mesh]") {
    const auto moved = [](float x, bool strict = false) {
        return read_mesh("f.ply", ply({{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}}, {{0, 1, 2}}), strict).remarks;
    };
    CHECK(moved(100).empty());
    CHECK(moved(1000) ==
          Remarks{"f.ply: its distance from the origin is 7.1e+02 times its size, so that rounding errors "
                  "deform it: move it to the origin"});
    CHECK_THROWS_WITH(moved(1000, true), "f.ply: it is too far from the origin for its size; move it to the origin");
}

TEST_CASE("meshes: damaged files that assimp accepts or never ends on are refused", "[mesh]") {
    const auto check = [](const std::string& name, const std::string& bytes, const std::string& message) {
        CAPTURE(bytes);
        CHECK_THROWS_WITH(read_mesh(name, bytes), name + ": cannot read the mesh: " + message);
    };
    const std::string ascii = tetrahedron_ascii_ply(), binary = tetrahedron_ply();
    const std::string no_end = "PLY: the header has no end_header";
    const std::string missing = "PLY: numbers are missing; the file may be truncated";
    for (const std::string& bytes : {ascii, binary})
        for (const std::size_t size : {0, 1, 3, 20, 60}) check("d.ply", bytes.substr(0, size), no_end);
    const std::size_t body = ascii.find("end_header\n") + 11, last_line = ascii.find_last_of('\n', ascii.size() - 2);
    for (const std::size_t size : {body, (body + ascii.size()) / 2, last_line})
        check("d.ply", ascii.substr(0, size), missing);
    std::string shorter = ascii;
    check("d.ply", shorter.erase(ascii.find(' ', body), 2), missing);  // a vertex without its last number
    check("d.ply", replaced(binary, "element vertex 4", "element vertex  "),
          "PLY: the header has an element without a number");
    check("d.ply", replaced(binary, "property double y", "property double w"), "PLY: the vertices have no property y");
    check("d.ply", replaced(binary, "element edge 1", "element tristrips 1"),
          "PLY: raya does not read triangle strips; store the faces instead");
    check("d.stl",
          "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
          "STL: there is no endsolid; the file may be truncated");
    check("d.gltf", "{\"asset\":", "glTF: the JSON is broken or no object");
    check("d.glb", "glTF", "glTF: the file is not a .glb");
    const auto requiring = [](const std::string& extension) {
        return tetrahedron_gltf(embedded_buffer(), "", "", ",\"extensionsRequired\":[\"" + extension + "\"]");
    };
    check("d.gltf", requiring("KHR_mesh_quantization"),
          "glTF: raya cannot read the required extension KHR_mesh_quantization; export the file without it");
    CHECK(read_mesh("d.gltf", requiring("KHR_materials_unlit")).scene.polygons.size() == 4);
    CHECK_THROWS_WITH(read_mesh("d.fbx", "Kaydara"),
                      "d.fbx: raya does not read .fbx files; convert it to OBJ, PLY, glTF or STL");
}

TEST_CASE("meshes: errors name the file and the face", "[mesh]") {
    const auto check = [](const std::string& bytes, const std::string& message) {
        CAPTURE(bytes);
        CHECK_THROWS_WITH(read_mesh("e.ply", bytes), Catch::StartsWith("e.ply: " + message));
    };
    const std::string good = ply(kSquare, {{0, 1, 2}});
    check(ply(kSquare, {{0, 1, 2}, {0, 1, 4}}),
          "cannot read the mesh: face 2: there is no vertex 4; the mesh has 4, numbered from 0");
    check(ply(kSquare, {{0, 1, -1}}),
          "cannot read the mesh: face 1: there is no vertex 4294967295; the mesh has 4, numbered from 0");
    check(ply(kSquare, {}), "");
    check(ply(kSquare, {{0, 0, 0}}), "it has no triangle: the image would be empty");
    check(good.substr(0, good.size() - 1), "");
    check("", "cannot read the mesh: ");
    check("plx\n", "cannot read the mesh: ");
    CHECK_THROWS_WITH(read_scene_file("/none/e.ply"), "/none/e.ply: cannot read the mesh: No such file or directory");
}

TEST_CASE("meshes: colours of vertices are ignored with a warning; --strict refuses them", "[mesh]") {
    const std::string bytes = ply({{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}}, {{0, 1, 2}}, "property float red\n");
    CHECK(read_mesh("c.ply", bytes).remarks == Remarks{"c.ply: colour of vertices, ignored"});
    CHECK_THROWS_WITH(read_mesh("c.ply", bytes, true), "c.ply: colour of vertices has no counterpart in raya");
}

}  // namespace
}  // namespace raya
