// raya_import DESCRIPTOR FILE: reads a mesh with assimp and writes it as records (import_records.hpp) to the descriptor
// of a pipe. raya starts it. It uses no code of raya, so that a memory error of assimp meets nothing but assimp's data.
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
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/mesh/import_records.hpp"

namespace raya {
namespace {

/// Returns the little-endian word at byte `at`.
std::uint32_t word_at(const std::string& bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t k = 4; k-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + k]);
    return word;
}

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<bool> is_list;  // for each property
    std::set<std::string> properties;
};

/// Reads the header. Returns its fault.
std::string read_ply_header(std::istream& in, bool& is_ascii, std::vector<PlyElement>& elements) {
    std::string line;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        std::string word, next;
        words >> word >> next;
        if (word == "end_header") return "";
        if (word == "format") is_ascii = next == "ascii";
        if (word == "element") {
            elements.push_back({next, 0, {}, {}});
            if (!(words >> elements.back().count)) return "PLY: the header has an element without a number";
            if (elements.back().count > UINT32_MAX) return "PLY: more elements than raya reads";
        }
        if (word == "property" && !elements.empty()) {
            elements.back().is_list.push_back(next == "list");
            while (words >> word) next = word;
            elements.back().properties.insert(next);
        }
    }
    return "PLY: the header has no end_header";
}

/// Returns true if the rest of an ascii file has all numbers of its elements.
bool has_all_numbers(std::istream& in, const std::vector<PlyElement>& elements) {
    std::string line;
    for (const PlyElement& element : elements)
        for (std::uint64_t i = 0; i < element.count; ++i) {
            do
                if (!std::getline(in, line)) return false;
            while (line.find_first_not_of(" \t\r") == std::string::npos);
            std::istringstream numbers(line);
            std::string number;
            for (const bool is_list : element.is_list) {
                if (!(numbers >> number)) return false;
                for (double left = is_list ? std::atof(number.c_str()) : 0; left >= 1; --left)
                    if (!(numbers >> number)) return false;
            }
        }
    return true;
}

std::string fault_of_ply(std::istream& in) {
    bool is_ascii = false;
    std::vector<PlyElement> elements;
    if (std::string fault = read_ply_header(in, is_ascii, elements); !fault.empty()) return fault;
    for (const PlyElement& element : elements) {
        if (element.name == "tristrips") return "PLY: raya does not read triangle strips; store the faces instead";
        for (const char* const axis : {"x", "y", "z"})
            if (element.name == "vertex" && !element.properties.contains(axis))
                return std::string("PLY: the vertices have no property ") + axis;
    }
    return is_ascii && !has_all_numbers(in, elements) ? "PLY: numbers are missing; the file may be truncated" : "";
}

std::string fault_of_stl(std::istream& in) {
    constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of a binary file
    std::string header(kHeader, '\0');
    in.read(header.data(), kHeader);
    if (!header.starts_with("solid")) return "";
    const std::uint32_t facets = word_at(header, kHeader - 4);
    in.clear();
    const auto size = static_cast<std::size_t>(in.seekg(0, std::ios::end).tellg());
    if (size == kHeader + std::size_t{facets} * kFacet) return "";  // a binary file may begin with "solid", too
    in.seekg(static_cast<std::streamoff>(size - std::min<std::size_t>(size, 1000)));  // the name follows endsolid
    const std::string tail(std::istreambuf_iterator<char>(in), {});
    return tail.find("endsolid") == std::string::npos ? "STL: there is no endsolid; the file may be truncated" : "";
}

std::string fault_of_gltf(std::istream& in, bool is_binary) {
    constexpr std::size_t kHeader = 20;  // bytes of a .glb before the JSON; the word at byte 12 is the JSON's length
    std::string bytes(std::istreambuf_iterator<char>(in), {});
    if (is_binary) {
        if (bytes.size() < kHeader || !bytes.starts_with("glTF")) return "glTF: the file is not a .glb";
        bytes = bytes.substr(kHeader, word_at(bytes, 12));
    }
    const auto json = nlohmann::json::parse(bytes, nullptr, false);
    if (!json.is_object()) return "glTF: the JSON is broken or no object";
    const auto required = json.find("extensionsRequired");
    for (const auto& name : required != json.end() && required->is_array() ? *required : nlohmann::json::array()) {
        const std::string text = name.is_string() ? name.get<std::string>() : "";
        const auto has_start = [&](const char* start) { return text.starts_with(start); };
        if (std::ranges::none_of(std::vector{"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"},
                                 has_start))
            return "glTF: raya cannot read the required extension " + text + "; export the file without it";
    }
    return "";
}

/// Returns the fault of the file, or an empty string if assimp may read it. Finds faults that assimp 5.2 passes over
/// silently, or never ends on. `extension`: in lower case, without dot.
/// - PLY: a header that is incomplete or has triangle strips, vertices without x, y or z, ascii data that breaks off.
/// - ascii STL that breaks off.
/// - glTF: broken JSON, and required extensions that change the geometry.
std::string fault_of_file(const std::string& file, const std::string& extension) {
    std::ifstream in(file, std::ios::binary);
    return extension == "ply"                          ? fault_of_ply(in)
           : extension == "stl"                        ? fault_of_stl(in)
           : extension == "gltf" || extension == "glb" ? fault_of_gltf(in, extension == "glb")
                                                       : "";
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

/// Writes records. If raya has closed the pipe, SIGPIPE ends the program.
class Records {
  public:
    explicit Records(int descriptor) : file_(::fdopen(descriptor, "wb")) {
        if (file_ == nullptr) std::exit(EXIT_FAILURE);
    }

    template <class Value>
    void put(const Value* values, std::size_t count) {
        if (std::fwrite(values, sizeof(Value), count, file_) != count) std::exit(EXIT_FAILURE);
    }
    template <class Value>
    void put(const Value& value) {
        put(&value, 1);
    }
    void put_text(std::string_view text) {
        text = text.substr(0, kMaxImportedText);
        put(static_cast<std::uint32_t>(text.size()));
        put(text.data(), text.size());
    }

    void ignore(std::string_view what, const std::string& place = "") {
        put(ImportRecord::kIgnored);
        put_text(what);
        put_text(place);
    }

    /// Writes the last record and ends the program.
    [[noreturn]] void end(const std::string& error = "") {
        put(error.empty() ? ImportRecord::kEnd : ImportRecord::kError);
        if (!error.empty()) put_text(error);
        std::fflush(file_);
        ::_exit(EXIT_SUCCESS);  // without destructors, which a damaged heap could crash
    }

  private:
    std::FILE* file_;
};

/// Opens files for assimp: regular files in the mesh's folder or in folders below it, also by their links. Reports
/// them, and the first that cannot be opened. After a missing material file of an OBJ file, assimp tries another name
/// and the same names again.
class ReportingFiles : public Assimp::IOSystem {  // assimp 6 makes DefaultIOSystem final
  public:
    ReportingFiles(Records& records, const std::filesystem::path& mesh)
        : records_(records),
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
                records_.end(std::string("the file '") + file + "' is not in the mesh's folder; remedy: copy it there");
            records_.put(ImportRecord::kFile);
            records_.put_text(path.native());
            stream = files_.Open(file, mode);
        }
        if (stream == nullptr && !std::exchange(is_missing_, true))
            records_.ignore("file that cannot be opened", std::string("file '") + file + "'");
        return stream;
    }

  private:
    Assimp::DefaultIOSystem files_;
    Records& records_;
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

/// Maps the reflection of an MTL material. Its illumination models 3 to 9 reflect; the others have only a highlight.
void map_obj_reflection(const aiMaterial& material, ImportedSurface& s, Records& records, const std::string& place) {
    constexpr int kFirstMirror = 3;
    const auto specular = property(material, AI_MATKEY_COLOR_SPECULAR, aiColor3D(0, 0, 0));
    if (is_black(specular)) return;
    if (property(material, AI_MATKEY_OBJ_ILLUM, 0) < kFirstMirror)
        return records.ignore("highlight without reflection", place);
    s.specular = largest(specular);
    s.shine = property(material, AI_MATKEY_SHININESS, 0.0f);
    if (specular.r != specular.g || specular.g != specular.b) records.ignore("colour of a reflection", place);
}

/// Maps the reflection of a glTF material: raya's mirrors are sharp, so that a rough metal is mostly diffuse.
void map_gltf_reflection(const aiMaterial& material, ImportedSurface& s, Records& records, const std::string& place) {
    const float metallic = property(material, AI_MATKEY_METALLIC_FACTOR, 1.0f);
    const float smoothness = 1 - property(material, AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
    s.specular = metallic * smoothness;
    s.diffuse = 1 - s.specular;
    s.shine = 1000 * smoothness * smoothness;
    if (s.specular > 0 && !(s.colour[0] == s.colour[1] && s.colour[1] == s.colour[2]))
        records.ignore("colour of a reflection", place);
    if (metallic < 1 && smoothness > 0) records.ignore("highlight without reflection", place);
}

void map_transparency(const aiMaterial& material, ImportedSurface& s) {
    const std::string mode = property(material, AI_MATKEY_GLTF_ALPHAMODE, aiString()).C_Str();
    const float opacity = mode == "OPAQUE" ? 1 : property(material, AI_MATKEY_OPACITY, 1.0f);
    s.transmittance = 1 - opacity * (1 - property(material, AI_MATKEY_TRANSMISSION_FACTOR, 0.0f));
    s.diffuse *= 1 - s.transmittance;
    const float index = property(material, AI_MATKEY_REFRACTI, 1.0f);
    if (index > 0) s.refraction_index = index;
}

void count_textures(const aiMaterial& material, Records& records, const std::string& place) {
    std::set<std::string> textures;  // assimp lists some of them in two types
    for (int type = aiTextureType_NONE + 1; type <= AI_TEXTURE_TYPE_MAX; ++type)
        for (unsigned i = 0; i < material.GetTextureCount(static_cast<aiTextureType>(type)); ++i) {
            aiString name;
            material.GetTexture(static_cast<aiTextureType>(type), i, &name);
            textures.insert(name.C_Str());
        }
    for (std::size_t i = 0; i < textures.size(); ++i) records.ignore("texture", place);
}

void put_material(const aiMaterial& material, bool is_gltf, Records& records) {
    ImportedSurface s;
    const std::string name = property(material, AI_MATKEY_NAME, aiString()).C_Str();
    const std::string place = "material '" + name + "'";
    if (name != AI_DEFAULT_MATERIAL_NAME) {  // assimp's own, for a mesh without a material, is grey
        const auto colour = property(material, AI_MATKEY_COLOR_DIFFUSE, aiColor3D(1, 1, 1));
        s.colour[0] = colour.r, s.colour[1] = colour.g, s.colour[2] = colour.b;
        const bool is_metallic = is_gltf && property(material, AI_MATKEY_METALLIC_FACTOR, -1.0f) >= 0;
        (is_metallic ? map_gltf_reflection : map_obj_reflection)(material, s, records, place);
        map_transparency(material, s);
        if (!is_black(property(material, AI_MATKEY_COLOR_EMISSIVE, aiColor3D(0, 0, 0))))
            records.ignore("emission", place);
        count_textures(material, records, place);
    }
    records.put(ImportRecord::kSurface);
    records.put_text(name);
    records.put(s);
}

/// What of assimp's data raya uses in a format.
struct Format {
    bool has_materials, has_normals, is_gltf;
};

/// Puts the mesh of a node. `to_scene` transforms its points; a mirroring transformation turns the faces around.
void put_mesh(const aiMesh& mesh, const aiMatrix4x4& to_scene, const Format& format, Records& records) {
    const bool has_normals = format.has_normals && mesh.HasNormals();
    const bool is_mirrored = to_scene.Determinant() < 0;
    std::vector<std::uint32_t> sizes, corners;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        sizes.push_back(face.mNumIndices);
        corners.insert(corners.end(), face.mIndices, face.mIndices + face.mNumIndices);
        if (is_mirrored) std::reverse(corners.end() - face.mNumIndices, corners.end());
    }
    if (std::ranges::all_of(sizes, [](std::uint32_t size) { return size == 3; })) sizes.clear();
    records.put(ImportRecord::kMesh);
    records.put_text(mesh.mName.C_Str());
    records.put(ImportedMesh{.vertices = mesh.mNumVertices,
                             .normals = has_normals ? mesh.mNumVertices : 0,
                             .faces = sizes.size(),
                             .corners = corners.size(),
                             .surface = format.has_materials ? mesh.mMaterialIndex + 1 : 0});
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) records.put(to_scene * mesh.mVertices[i]);
    const aiMatrix3x3 of_normals = aiMatrix3x3(to_scene).Inverse().Transpose();
    for (unsigned i = 0; has_normals && i < mesh.mNumVertices; ++i) records.put(of_normals * mesh.mNormals[i]);
    records.put(sizes.data(), sizes.size());
    records.put(corners.data(), corners.size());
}

void put_nodes(const aiScene& scene, const Format& format, Records& records) {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> nodes = {{scene.mRootNode, aiMatrix4x4()}};
    while (!nodes.empty()) {
        const aiNode& node = *nodes.back().first;
        const aiMatrix4x4 to_scene = nodes.back().second * node.mTransformation;
        nodes.pop_back();
        for (unsigned i = 0; i < node.mNumMeshes; ++i)
            put_mesh(*scene.mMeshes[node.mMeshes[i]], to_scene, format, records);
        for (unsigned i = node.mNumChildren; i > 0; --i) nodes.emplace_back(node.mChildren[i - 1], to_scene);
    }
}

void put_scene(const aiScene& scene, const Format& format, Records& records) {
    const auto ignore = [&](unsigned count, const char* what) {
        for (; count > 0; --count) records.ignore(what);
    };
    ignore(scene.mNumCameras, "camera");
    ignore(scene.mNumLights, "light");
    ignore(scene.mNumAnimations, "animation");
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        ignore(scene.mMeshes[i]->HasVertexColors(0), "colour of vertices");
        ignore(scene.mMeshes[i]->HasBones(), "skeleton");
        ignore(scene.mMeshes[i]->mNumAnimMeshes, "morph target");
    }
    for (unsigned i = 0; format.has_materials && i < scene.mNumMaterials; ++i)
        put_material(*scene.mMaterials[i], format.is_gltf, records);
    put_nodes(scene, format, records);
}

[[noreturn]] void import(Records& records, const std::string& file) {
    records.put(ImportRecord::kStart);
    try {
        Assimp::Importer importer;
        importer.SetIOHandler(new ReportingFiles(records, file));  // the importer deletes it
        std::string extension = file.substr(file.rfind('.') + 1);
        for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
        if (const std::string fault = fault_of_file(file, extension); !fault.empty()) records.end(fault);
        keep_one_format(importer, extension);
        const aiScene* const scene = importer.ReadFile(file, 0);
        if (scene == nullptr) records.end(std::string("assimp: ") + importer.GetErrorString());
        // assimp invents grey materials for STL and PLY. STL's normals are those of the facets, which raya computes.
        put_scene(*scene, {extension != "stl" && extension != "ply", extension != "stl", extension.starts_with("gl")},
                  records);
        records.end();
    } catch (const std::bad_alloc&) {
        records.end("it needs more than half of this computer's memory; the file may be damaged");
    } catch (const std::exception& error) {
        records.end(std::string("assimp: ") + error.what());
    }
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc != 3) return EXIT_FAILURE;
    raya::limit_resources();
    // A message of the C library on a damaged heap would stand between raya's own messages.
    if (std::freopen("/dev/null", "w", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr)
        return EXIT_FAILURE;
    raya::Records records(std::atoi(argv[1]));
    raya::import(records, argv[2]);
}
