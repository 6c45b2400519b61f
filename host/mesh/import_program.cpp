// raya_import DESCRIPTOR FILE SECONDS: reads a mesh, a plain binary PLY itself and others with assimp, and writes it to
// the descriptor of a pipe. SIGALRM ends it after this time. raya starts it. It uses no code of raya, so that a memory
// error of assimp meets nothing but assimp's data.
//
// It writes the number of bytes of a document as 64 bits, the document in CBOR, and the faces of all meshes. The
// document is {"error": TEXT}, or has the members
//
//     files       paths of the files that it has read besides the mesh
//     ignored     what has no counterpart in raya: [WHAT, PLACE] each
//     surfaces    [NAME, red, green, blue, Kd, Ks, Shine, T, index of refraction] each
//     meshes      {name, surface, faces, has_normals} each; surface: from 1, 0 is raya's default
//
// A face is its number of corners, 32 bits, and for each corner the position and, if the mesh has normals, the normal,
// as floats. Numbers have the byte order of the computer.
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/GltfMaterial.h>
#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/mesh/import_output.hpp"
#include "host/mesh/import_ply.hpp"

namespace raya {
namespace {

// The checks find faults that assimp 5.2 passes over silently, or never ends on.

/// Returns the little-endian word at byte `at`.
std::uint32_t word_at(const std::string& bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t k = 4; k-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + k]);
    return word;
}

/// Refuses ascii that breaks off. A binary file may begin with "solid", too.
void check_stl(std::istream& in) {
    constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of a binary file
    std::string bytes(kHeader, '\0');
    if (!in.read(bytes.data(), kHeader) || !bytes.starts_with("solid")) return;
    const std::size_t binary_size = kFacet * word_at(bytes, kHeader - 4);
    bytes.append(std::istreambuf_iterator<char>(in), {});
    if (bytes.size() != kHeader + binary_size && bytes.find("endsolid") == bytes.npos)
        throw MeshFault("STL: there is no endsolid; the file may be truncated");
}

/// Refuses broken JSON, and required extensions that change the geometry.
void check_gltf(std::string bytes, bool is_binary) {
    constexpr std::size_t kHeader = 20;  // bytes of a .glb before the JSON; the word at byte 12 is the JSON's length
    if (is_binary) {
        if (bytes.size() < kHeader || !bytes.starts_with("glTF")) throw MeshFault("glTF: the file is not a .glb");
        bytes = bytes.substr(kHeader, word_at(bytes, 12));
    }
    const Json json = Json::parse(bytes, nullptr, false);
    if (!json.is_object()) throw MeshFault("glTF: the JSON is broken or no object");
    const auto required = json.find("extensionsRequired");
    for (const Json& name : required != json.end() && required->is_array() ? *required : Json::array()) {
        const std::string text = name.is_string() ? name.get<std::string>() : "";
        if (std::ranges::none_of(std::vector{"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"},
                                 [&](const char* start) { return text.starts_with(start); }))
            throw MeshFault("glTF: raya cannot read the required extension " + text + "; export the file without it");
    }
}

/// `extension`: in lower case, without dot; not "ply".
void check_file(const std::string& file, const std::string& extension) {
    std::ifstream in(file, std::ios::binary);
    if (extension == "stl") return check_stl(in);
    if (extension != "obj") check_gltf({std::istreambuf_iterator<char>(in), {}}, extension == "glb");
}

/// Limits the memory to half of the computer's, and forbids files, so that a damaged file cannot exhaust them.
void limit_resources() {
    const auto limit_to = [](__rlimit_resource_t resource, rlim_t value) {
        rlimit limit{};
        ::getrlimit(resource, &limit);
        limit.rlim_cur = limit.rlim_max = std::min(limit.rlim_max, value);
        ::setrlimit(resource, &limit);
    };
#ifndef __SANITIZE_ADDRESS__  // the sanitizer reserves more address space than any computer has memory
    limit_to(RLIMIT_AS,
             static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES)) / 2 * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)));
#endif
    limit_to(RLIMIT_CORE, 0);
    limit_to(RLIMIT_FSIZE, 0);
}

/// Opens files for assimp: regular files in the mesh's folder or in folders below it, also by their links. Reports
/// them, and the first that cannot be opened. After a missing material file of an OBJ file, assimp tries another name
/// and the same names again.
class ReportingFiles : public Assimp::IOSystem {  // assimp 6 makes DefaultIOSystem final
  public:
    ReportingFiles(ImportOutput& output, const std::filesystem::path& mesh)
        : output_(output),
          mesh_(std::filesystem::canonical(mesh)),
          folder_(std::filesystem::canonical(std::filesystem::absolute(mesh).parent_path()) / "") {}
    bool Exists(const char* file) const override {  // assimp 5.2 would open a pipe, and wait
        std::error_code error;
        return is_regular_file(std::filesystem::path(file), error);
    }
    char getOsSeparator() const override { return files_.getOsSeparator(); }
    void Close(Assimp::IOStream* stream) override { files_.Close(stream); }
    bool ComparePaths(const char* one, const char* other) const override { return files_.ComparePaths(one, other); }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        std::error_code error;
        const std::filesystem::path path = std::filesystem::canonical(file, error);
        Assimp::IOStream* stream = nullptr;
        if (!error && is_regular_file(path, error)) {
            if (path != mesh_ && !path.native().starts_with(folder_.native()))
                output_.refuse(std::string("the file '") + file +
                               "' is not in the mesh's folder; remedy: copy it there");
            output_.document["files"].push_back(path.native());
            stream = files_.Open(file, mode);
        }
        if (stream == nullptr && !std::exchange(is_missing_, true))
            output_.ignore("file that cannot be opened", std::string("file '") + file + "'");
        return stream;
    }

  private:
    Assimp::DefaultIOSystem files_;
    ImportOutput& output_;
    std::filesystem::path mesh_, folder_;
    bool is_missing_ = false;
};

/// Removes all importers of assimp but that of the extension, because assimp would choose one by the file's contents.
void keep_one_format(Assimp::Importer& importer, const std::string& extension) {
    std::vector<Assimp::BaseImporter*> others;
    for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
        std::set<std::string> extensions;
        importer.GetImporter(i)->GetExtensionList(extensions);
        if (!extensions.contains(extension)) others.push_back(importer.GetImporter(i));
    }
    for (Assimp::BaseImporter* const other : others) importer.UnregisterLoader(other);
}

template <class Value>
Value property(const aiMaterial& material, const char* key, unsigned type, unsigned index, Value value) {
    material.Get(key, type, index, value);  // leaves the value unchanged if there is no such property
    return value;
}

bool is_black(const aiColor3D& c) { return c.r == 0 && c.g == 0 && c.b == 0; }

float largest(const aiColor3D& c) { return std::max({c.r, c.g, c.b}); }

/// The numbers of an `f` of NFF.
struct Surface {
    aiColor3D colour{1, 1, 1};
    float diffuse = 1, specular = 0, shine = 0, transmittance = 0, refraction_index = 1;
};

/// Maps the reflection of an MTL material. Its illumination models 3 to 9 reflect; the others have only a highlight.
void map_obj_reflection(const aiMaterial& material, Surface& s, ImportOutput& output, const std::string& place) {
    constexpr int kFirstMirror = 3;
    const auto specular = property(material, AI_MATKEY_COLOR_SPECULAR, aiColor3D(0, 0, 0));
    if (is_black(specular)) return;
    if (property(material, AI_MATKEY_OBJ_ILLUM, 0) < kFirstMirror)
        return output.ignore("highlight without reflection", place);
    s.specular = largest(specular);
    s.shine = property(material, AI_MATKEY_SHININESS, 0.0f);
    if (specular.r != specular.g || specular.g != specular.b) output.ignore("colour of a reflection", place);
}

/// Maps the reflection of a glTF material: raya's mirrors are sharp, so that a rough metal is mostly diffuse.
void map_gltf_reflection(const aiMaterial& material, Surface& s, ImportOutput& output, const std::string& place) {
    const float metallic = property(material, AI_MATKEY_METALLIC_FACTOR, 1.0f);
    const float smoothness = 1 - property(material, AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
    s.specular = metallic * smoothness;
    s.diffuse = 1 - s.specular;
    s.shine = 1000 * smoothness * smoothness;
    if (s.specular > 0 && !(s.colour.r == s.colour.g && s.colour.g == s.colour.b))
        output.ignore("colour of a reflection", place);
    if (metallic < 1 && smoothness > 0) output.ignore("highlight without reflection", place);
}

void map_transparency(const aiMaterial& material, Surface& s) {
    const std::string mode = property(material, AI_MATKEY_GLTF_ALPHAMODE, aiString()).C_Str();
    const float opacity = mode == "OPAQUE" ? 1 : property(material, AI_MATKEY_OPACITY, 1.0f);
    s.transmittance = 1 - opacity * (1 - property(material, AI_MATKEY_TRANSMISSION_FACTOR, 0.0f));
    s.diffuse *= 1 - s.transmittance;
    const float index = property(material, AI_MATKEY_REFRACTI, 1.0f);
    if (index > 0) s.refraction_index = index;
}

void count_textures(const aiMaterial& material, ImportOutput& output, const std::string& place) {
    std::set<std::string> textures;  // assimp lists some of them in two types
    for (int type = aiTextureType_NONE + 1; type <= AI_TEXTURE_TYPE_MAX; ++type)
        for (unsigned i = 0; i < material.GetTextureCount(static_cast<aiTextureType>(type)); ++i) {
            aiString name;
            material.GetTexture(static_cast<aiTextureType>(type), i, &name);
            textures.insert(name.C_Str());
        }
    for (std::size_t i = 0; i < textures.size(); ++i) output.ignore("texture", place);
}

void put_material(const aiMaterial& material, bool is_gltf, ImportOutput& output) {
    Surface s;
    const std::string name = property(material, AI_MATKEY_NAME, aiString()).C_Str();
    const std::string place = "material '" + name + "'";
    if (name != AI_DEFAULT_MATERIAL_NAME) {  // assimp's own, for a mesh without a material, is grey
        s.colour = property(material, AI_MATKEY_COLOR_DIFFUSE, s.colour);
        const bool is_metallic = is_gltf && property(material, AI_MATKEY_METALLIC_FACTOR, -1.0f) >= 0;
        (is_metallic ? map_gltf_reflection : map_obj_reflection)(material, s, output, place);
        map_transparency(material, s);
        if (!is_black(property(material, AI_MATKEY_COLOR_EMISSIVE, aiColor3D(0, 0, 0))))
            output.ignore("emission", place);
        count_textures(material, output, place);
    }
    output.document["surfaces"].push_back({name, s.colour.r, s.colour.g, s.colour.b, s.diffuse, s.specular, s.shine,
                                           s.transmittance, s.refraction_index});
}

/// A mesh of a node. `to_scene` transforms its points; a mirroring transformation turns the faces around.
struct PlacedMesh {
    const aiMesh* mesh;
    aiMatrix4x4 to_scene;
};

std::vector<PlacedMesh> placed_meshes(const aiScene& scene) {
    std::vector<PlacedMesh> meshes;
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> nodes = {{scene.mRootNode, aiMatrix4x4()}};
    while (!nodes.empty()) {
        const aiNode& node = *nodes.back().first;
        const aiMatrix4x4 to_scene = nodes.back().second * node.mTransformation;
        nodes.pop_back();
        for (unsigned i = 0; i < node.mNumMeshes; ++i) meshes.push_back({scene.mMeshes[node.mMeshes[i]], to_scene});
        for (unsigned i = node.mNumChildren; i > 0; --i) nodes.emplace_back(node.mChildren[i - 1], to_scene);
    }
    return meshes;
}

void check_corners(const aiMesh& mesh) {
    for (unsigned i = 0; i < mesh.mNumFaces; ++i)
        for (unsigned k = 0; k < mesh.mFaces[i].mNumIndices; ++k)
            check_corner(mesh.mFaces[i].mIndices[k], mesh.mNumVertices, mesh.mName.C_Str(), i + 1);
}

void put_faces(const PlacedMesh& placed, bool has_normals, ImportOutput& output) {
    const aiMesh& mesh = *placed.mesh;
    const bool is_mirrored = placed.to_scene.Determinant() < 0;
    const aiMatrix3x3 of_normals = aiMatrix3x3(placed.to_scene).Inverse().Transpose();
    std::vector<aiVector3D> vectors;  // of a face
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        vectors.clear();
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
            const unsigned corner = face.mIndices[is_mirrored ? face.mNumIndices - 1 - k : k];
            vectors.push_back(placed.to_scene * mesh.mVertices[corner]);
            if (has_normals) vectors.push_back(of_normals * mesh.mNormals[corner]);
        }
        output.put(&face.mNumIndices, 1);
        output.put(vectors.data(), vectors.size());
    }
}

/// assimp invents grey materials for STL and PLY. STL's normals are those of the facets, which raya computes.
void put_scene(const aiScene& scene, const std::string& extension, ImportOutput& output) {
    const bool has_materials = extension != "stl" && extension != "ply";
    const auto ignore = [&](unsigned count, const char* what) {
        for (; count > 0; --count) output.ignore(what);
    };
    ignore(scene.mNumCameras, "camera");
    ignore(scene.mNumLights, "light");
    ignore(scene.mNumAnimations, "animation");
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        ignore(scene.mMeshes[i]->HasVertexColors(0), "colour of vertices");
        ignore(scene.mMeshes[i]->HasBones(), "skeleton");
        ignore(scene.mMeshes[i]->mNumAnimMeshes, "morph target");
    }
    for (unsigned i = 0; has_materials && i < scene.mNumMaterials; ++i)
        put_material(*scene.mMaterials[i], extension.starts_with("gl"), output);
    const auto has_normals = [&](const aiMesh& mesh) { return extension != "stl" && mesh.HasNormals(); };
    const std::vector<PlacedMesh> meshes = placed_meshes(scene);
    for (const auto& [mesh, to_scene] : meshes) {
        check_corners(*mesh);
        output.document["meshes"].push_back({{"name", mesh->mName.C_Str()},
                                             {"surface", has_materials ? mesh->mMaterialIndex + 1 : 0},
                                             {"faces", mesh->mNumFaces},
                                             {"has_normals", has_normals(*mesh)}});
    }
    output.put(output.document);
    for (const PlacedMesh& placed : meshes) put_faces(placed, has_normals(*placed.mesh), output);
}

[[noreturn]] void import(ImportOutput& output, const std::string& file) {
    try {
        Assimp::Importer importer;
        importer.SetIOHandler(new ReportingFiles(output, file));  // the importer deletes it
        std::string extension = file.substr(file.rfind('.') + 1);
        for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
        if (extension == "ply") {
            if (put_plain_ply(file, output)) output.end();
        } else {
            check_file(file, extension);
        }
        keep_one_format(importer, extension);
        const aiScene* const scene = importer.ReadFile(file, 0);
        if (scene == nullptr) output.refuse(std::string("assimp: ") + importer.GetErrorString());
        put_scene(*scene, extension, output);
        output.end();
    } catch (const MeshFault& fault) {
        output.refuse(fault.what());
    } catch (const std::bad_alloc&) {
        output.refuse("it needs more than half of this computer's memory; the file may be damaged");
    } catch (const std::exception& error) {
        output.refuse(std::string("assimp: ") + error.what());
    }
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc != 4) return EXIT_FAILURE;
    ::alarm(static_cast<unsigned>(std::atoi(argv[3])));
    raya::limit_resources();
    // A message of the C library on a damaged heap would stand between raya's own messages.
    if (std::freopen("/dev/null", "w", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr)
        return EXIT_FAILURE;
    raya::ImportOutput output(std::atoi(argv[1]));
    raya::import(output, argv[2]);
}
