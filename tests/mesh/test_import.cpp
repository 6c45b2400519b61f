// Meshes that the program raya_import reads: formats, materials, messages.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "host/scene/split_mix.hpp"
#include "tests/mesh/mesh_files.hpp"

namespace raya {
namespace {

using Catch::Contains;
using Remarks = std::vector<std::string>;

std::vector<Vec3> vertices_of(const Scene& scene) {
    std::vector<Vec3> vertices;
    for (const Polygon& polygon : scene.polygons)
        vertices.insert(vertices.end(), polygon.vertices.begin(), polygon.vertices.end());
    return vertices;
}

TEST_CASE("OBJ, PLY, glTF, GLB and STL give the same triangles", "[mesh]") {
    std::vector<Vec3> expected;
    for (const auto& face : kFaces)
        for (const std::uint32_t c : face) expected.emplace_back(kCorners[c][0], kCorners[c][1], kCorners[c][2]);
    std::string stl = "solid tetra\n";
    for (const auto& face : kFaces) {
        stl += "facet normal 0 0 0\nouter loop\n";
        for (const std::uint32_t c : face)
            stl += fmt::format("vertex {} {} {}\n", kCorners[c][0], kCorners[c][1], kCorners[c][2]);
        stl += "endloop\nendfacet\n";
    }
    for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
             {"t.obj", tetrahedron_obj()},
             {"T.OBJ", tetrahedron_obj()},
             {"t.ply", tetrahedron_ascii_ply()},
             {"T.PLY", tetrahedron_ply()},
             {"t.ply", tetrahedron_ply(true)},
             {"t.ply", replaced(tetrahedron_ply(), "4\nprop", "4\r\nprop")},
             {"t.stl", tetrahedron_binary_stl()},
             {"t.stl", stl + "endsolid tetra\n"},
             {"t.gltf", tetrahedron_gltf(embedded_buffer())},
             {"t.glb", tetrahedron_glb()}}) {
        CAPTURE(name, bytes);
        const ReadMesh mesh = read_mesh(name, bytes);
        CHECK(mesh.remarks.empty());
        CHECK(vertices_of(mesh.scene) == expected);
        CHECK(mesh.scene.surfaces == std::vector{Surface{}});
        CHECK(mesh.scene.name == name);
        CHECK(read_mesh(name, bytes, true).scene == mesh.scene);
    }
}

TEST_CASE("OBJ: materials become surfaces of NFF; what has no counterpart is counted", "[mesh]") {
    const ScratchFolder folder;
    write_whole_file(folder / "m.mtl",
                     "newmtl matt\nKd 0.5 0.25 1\nKs 0.5 0.5 0.5\nNs 50\nillum 2\nmap_Kd wood.png\nKe 0 1 0\n"
                     "newmtl mirror\nKd 0.25 0.25 0.25\nKs 0.5 0.75 0.5\nNs 20\nillum 3\n"
                     "newmtl glass\nKd 1 1 1\nd 0.25\nNi 1.5\nmap_Kd a.png\n");
    write_whole_file(folder / "m.obj",
                     "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl matt\nf 1 2 3\n"
                     "usemtl mirror\nf 1 2 4\nusemtl glass\nf 1 3 4\n");
    std::vector<SceneRemark> remarks;
    const Scene scene = read_scene_file(folder / "m.obj", &remarks);
    Surface matt, mirror, glass;
    matt.colour = {0.5, 0.25, 1};
    mirror.colour = {0.25, 0.25, 0.25};
    mirror.specular = 0.75;
    mirror.shine = 20;
    glass.diffuse = 0.25;
    glass.transmittance = 0.75;
    glass.refraction_index = 1.5;
    CHECK(scene.surfaces == std::vector{matt, mirror, glass});
    Remarks texts;
    for (const SceneRemark& remark : remarks) texts.push_back(remark_text("m.obj", remark));
    CHECK(texts == Remarks{"m.obj: material 'matt': highlight without reflection, ignored",
                           "m.obj: material 'matt': emission, ignored",
                           "m.obj: material 'matt': texture, ignored (2 in all)",
                           "m.obj: material 'mirror': colour of a reflection, ignored"});
    CHECK_THROWS_WITH(read_scene_file(folder / "m.obj"),
                      Contains("m.obj: material 'matt': highlight without reflection has no counterpart in raya"));
}

TEST_CASE("glTF: materials, nodes and contents without counterpart", "[mesh]") {
    const ReadMesh metal =
        read_mesh("g.gltf", tetrahedron_gltf(embedded_buffer(), "",
                                             R"(,"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,0.25],)"
                                             R"("metallicFactor":1,"roughnessFactor":0.5},"emissiveFactor":[0,0,1])"));
    Surface surface;
    surface.colour = {0.5, 0.5, 0.5};
    surface.diffuse = 0.5;
    surface.specular = 0.5;
    surface.shine = 250;
    CHECK(metal.scene.surfaces == std::vector{surface});
    CHECK(metal.remarks == Remarks{"g.gltf: material 'paint': emission, ignored"});
    const ReadMesh blended =
        read_mesh("g.gltf", tetrahedron_gltf(embedded_buffer(), "",
                                             R"(,"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":)"
                                             R"([1,0,0,0.25],"metallicFactor":0,"roughnessFactor":0.5})"));
    CHECK(blended.scene.surfaces[0].transmittance == 0.75);
    CHECK(blended.scene.surfaces[0].diffuse == 0.25);
    CHECK(blended.remarks == Remarks{"g.gltf: material 'paint': highlight without reflection, ignored"});
    const ReadMesh moved = read_mesh(
        "g.gltf", tetrahedron_gltf(embedded_buffer(), R"(,"translation":[1,2,3],"scale":[-1,1,1],"camera":0)", "",
                                   R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}])"));
    CHECK(moved.remarks == Remarks{"g.gltf: camera, ignored"});
    // Mirrored faces are turned around, so that their fronts stay outside.
    CHECK(moved.scene.polygons[0].vertices == std::vector<Vec3>{{0, 2, 3}, {1, 3, 3}, {1, 2, 3}});
}

TEST_CASE("OBJ: a missing material file is counted, and its materials are grey", "[mesh]") {
    const ReadMesh mesh = read_mesh("m.obj", tetrahedron_obj("mtllib none.mtl\nusemtl wood\n"));
    REQUIRE(mesh.remarks.size() == 1);
    CHECK_THAT(mesh.remarks[0],
               Contains("m.obj: file '") && Catch::EndsWith("none.mtl': file that cannot be opened, ignored"));
    Surface grey;
    grey.colour = Colour(0.6f);
    CHECK(mesh.scene.surfaces == std::vector{grey});
    CHECK(read_mesh("m.obj", tetrahedron_obj("mtllib m.mtl\n")).remarks.size() == 1);
}

TEST_CASE("OBJ: messages name file, mesh and face", "[mesh]") {
    const ReadMesh mesh = read_mesh("m.obj", "o wheel\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nl 1 2\n");
    CHECK(mesh.remarks == Remarks{"m.obj: mesh 'wheel', face 2: polygon without area, left out",
                                  "m.obj: mesh 'wheel', face 3: point or line, left out"});
    const ReadMesh pentagon = read_mesh("m.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n");
    CHECK(pentagon.scene.polygons.size() == 3);
    CHECK(pentagon.remarks.empty());
}

TEST_CASE("files that assimp does not accept are refused with its reason", "[mesh]") {
    for (const auto& [name, bytes] :
         std::vector<std::pair<std::string, std::string>>{{"e.obj", ""},
                                                          {"e.obj", "# nothing\n"},
                                                          {"e.gltf", "{}"},
                                                          {"e.gltf", tetrahedron_obj()},
                                                          {"e.gltf", tetrahedron_gltf("\"uri\":\"none.bin\",")},
                                                          {"e.glb", "glTF"},
                                                          {"e.stl", "solid"},
                                                          {"e.stl", tetrahedron_binary_stl().substr(0, 200)},
                                                          {"e.ply", "ply\nformat ascii 1.0\nend_header\n"}}) {
        CAPTURE(name, bytes);
        CHECK_THROWS_WITH(read_mesh(name, bytes), Catch::StartsWith(name + ": "));
        CHECK_THROWS_AS(read_mesh(name, bytes), UserError);
    }
    const ScratchFolder folder;
    CHECK_THROWS_WITH(read_scene_file(folder / "none.obj"),
                      Contains("none.obj: cannot read the mesh: No such file or directory"));
    std::filesystem::create_directory(folder / "d.stl");
    CHECK_THROWS_WITH(read_scene_file(folder / "d.stl"),
                      Contains("d.stl: cannot read the mesh: it is not a regular file"));
}

TEST_CASE("mutated meshes are either read or refused with the file's name", "[mesh]") {
    const char* variable = std::getenv("RAYA_MUTATIONS");
    const int count = variable != nullptr ? std::atoi(variable) / 10 : 100;  // a process for each
    const std::vector<std::pair<std::string, std::string>> files = {
        {"m.obj", tetrahedron_obj("g a\nvn 0 0 1\nvt 0 0\n")},
        {"m.ply", tetrahedron_ply()},
        {"m.ply", tetrahedron_ascii_ply()},
        {"m.stl", tetrahedron_binary_stl()},
        {"m.gltf", tetrahedron_gltf(embedded_buffer())},
        {"m.glb", tetrahedron_glb()}};
    ::setenv("RAYA_MESH_TIMEOUT", "1", 1);
    int accepted = 0;
    for (int seed = 0; seed < count; ++seed) {
        SplitMix random(static_cast<std::uint64_t>(seed));
        auto [name, bytes] = files[random.next() % files.size()];
        for (std::uint64_t changes = 1 + random.next() % 4; changes > 0; --changes)
            bytes[random.next() % bytes.size()] = static_cast<char>(random.next() % 256);
        if (random.next() % 8 == 0) bytes.resize(random.next() % bytes.size());
        CAPTURE(seed, name);
        try {
            const Scene scene = read_mesh(name, bytes).scene;
            ++accepted;
            for (const Polygon& polygon : scene.polygons) CHECK(polygon.vertices.size() == 3);
        } catch (const UserError& error) {
            CHECK_THAT(error.what(), Catch::StartsWith(name + ": "));
        }
    }
    ::unsetenv("RAYA_MESH_TIMEOUT");
    INFO("raya accepts " << accepted << " of " << count << " files");
    CHECK(accepted > count / 20);
    CHECK(accepted < count * 19 / 20);
}

}  // namespace
}  // namespace raya
