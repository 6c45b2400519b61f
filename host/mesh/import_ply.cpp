#include "host/mesh/import_ply.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

namespace raya {
namespace {

constexpr const char* kTruncated = "PLY: numbers are missing; the file may be truncated";

struct PlyProperty {
    std::string name, type, length_type;  // length_type: of a list, otherwise empty
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// Returns the number of the property with this name, or of properties if there is none.
    std::size_t index_of(const std::string& property) const {
        return static_cast<std::size_t>(std::ranges::find(properties, property, &PlyProperty::name) -
                                        properties.begin());
    }
    bool has(const std::string& property) const { return index_of(property) < properties.size(); }
};

struct PlyHeader {
    std::string format;
    std::vector<PlyElement> elements;
};

/// Reads the numbers of an element in ascii, a line each, the length of a list before its numbers.
void check_numbers(std::istream& in, const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
        std::string line;
        while (line.find_first_not_of(" \t\r") == line.npos && std::getline(in, line)) continue;
        std::istringstream numbers(line);
        const auto next_number = [&] {
            std::string number;
            if (!(numbers >> number)) throw MeshFault(kTruncated);
            return std::atof(number.c_str());
        };
        for (const PlyProperty& property : element.properties)
            for (double left = next_number(); !property.length_type.empty() && left >= 1; --left) next_number();
    }
}

/// Reads the header. Refuses one that is incomplete or has triangle strips, vertices without x, y or z, and ascii data
/// that breaks off.
PlyHeader read_ply_header(std::istream& in) {
    PlyHeader header;
    std::vector<PlyElement>& elements = header.elements;
    for (std::string line, word, next; word != "end_header"; next.clear()) {
        if (!std::getline(in, line)) throw MeshFault("PLY: the header has no end_header");
        std::istringstream words(line);
        words >> word >> next;
        if (word == "format") header.format = next;
        if (word == "element") {
            elements.push_back({next, 0, {}});
            if (!(words >> elements.back().count)) throw MeshFault("PLY: the header has an element without a number");
            if (elements.back().count > UINT32_MAX) throw MeshFault("PLY: more elements than raya reads");
        }
        if (word == "property" && !elements.empty()) {
            PlyProperty property{.name = {}, .type = next, .length_type = {}};
            if (next == "list") words >> property.length_type >> property.type;
            words >> property.name;
            elements.back().properties.push_back(property);
        }
    }
    for (const PlyElement& element : elements) {
        if (element.name == "tristrips")
            throw MeshFault("PLY: raya does not read triangle strips; store the faces instead");
        for (const char* const axis : {"x", "y", "z"})
            if (element.name == "vertex" && !element.has(axis))
                throw MeshFault(std::string("PLY: the vertices have no property ") + axis);
        if (header.format == "ascii") check_numbers(in, element);
    }
    return header;
}

/// Reads binary PLY files of millions of faces: assimp takes seconds and several copies of them.
class BinaryPly {
  public:
    BinaryPly(std::istream& in, const PlyHeader& header)
        : in_(in), header_(header), swaps_(header.format != kNativeFormat) {}

    /// True if the elements are vertices and faces in this order, with properties that this class reads. Others are
    /// left to assimp.
    bool is_plain() const {
        if (header_.format != kNativeFormat && header_.format != kOtherFormat) return false;
        if (header_.elements.size() != 2 || header_.elements[1].count == 0) return false;
        const PlyElement &vertex = header_.elements[0], &face = header_.elements[1];
        if (vertex.name != "vertex" || face.name != "face" || face.properties.size() != 1) return false;
        const PlyProperty& corners = face.properties[0];
        return (corners.name == "vertex_indices" || corners.name == "vertex_index") && bytes_of(corners.type) == 4 &&
               !is_floating(corners.type) && bytes_of(corners.length_type) == 1 &&
               std::ranges::all_of(vertex.properties, [](const PlyProperty& property) {
                   return property.length_type.empty() && bytes_of(property.type) > 0;
               });
    }

    void put(ImportOutput& output) {
        const PlyElement& vertex = header_.elements[0];
        const bool has_normals = vertex.has("nx") && vertex.has("ny") && vertex.has("nz");
        if (vertex.has("red") || vertex.has("green") || vertex.has("blue")) output.ignore("colour of vertices");
        const std::vector<float> vectors = read_vertices(has_normals);
        const std::size_t floats = has_normals ? 6 : 3, faces = header_.elements[1].count;
        output.document["meshes"].push_back(
            {{"name", ""}, {"surface", 0}, {"faces", faces}, {"has_normals", has_normals}});
        const std::vector<char> lists = read_lists(vertex.count);
        output.put(output.document);
        std::vector<float> of_face;  // all bits of a face: its number of corners, then their vectors
        for (auto next = lists.begin(); next != lists.end();) {
            const auto size = static_cast<unsigned char>(*next++);
            of_face.assign(1, std::bit_cast<float>(std::uint32_t{size}));
            for (unsigned k = 0; k < size; ++k, next += 4) {
                const auto corner = vectors.begin() + floats * value_at<std::uint32_t>(&*next);
                of_face.insert(of_face.end(), corner, corner + floats);
            }
            output.put(of_face.data(), of_face.size());
        }
    }

  private:
    static constexpr bool kIsLittle = std::endian::native == std::endian::little;
    static constexpr const char* kNativeFormat = kIsLittle ? "binary_little_endian" : "binary_big_endian";
    static constexpr const char* kOtherFormat = kIsLittle ? "binary_big_endian" : "binary_little_endian";

    static bool is_floating(const std::string& type) { return type.starts_with("float") || type == "double"; }

    /// Returns 0 for an unknown type.
    static std::size_t bytes_of(const std::string& type) {
        static const std::vector<std::vector<std::string>> kTypes = {
            {"char", "uchar", "int8", "uint8"},
            {"short", "ushort", "int16", "uint16"},
            {"int", "uint", "int32", "uint32", "float", "float32"},
            {"double", "float64"}};
        for (std::size_t i = 0; i < kTypes.size(); ++i)
            if (std::ranges::count(kTypes[i], type) > 0) return std::size_t{1} << i;
        return 0;
    }

    void read(char* bytes, std::size_t count) {
        if (!in_.read(bytes, static_cast<std::streamsize>(count))) throw MeshFault(kTruncated);
    }

    template <class Value>
    Value value_at(const char* bytes) const {
        std::array<char, sizeof(Value)> copy;
        std::copy_n(bytes, sizeof(Value), copy.begin());
        if (swaps_) std::ranges::reverse(copy);
        return std::bit_cast<Value>(copy);
    }

    /// Returns for each vertex x, y and z and, if the mesh has normals, nx, ny and nz.
    std::vector<float> read_vertices(bool has_normals) {
        const PlyElement& vertex = header_.elements[0];
        std::vector<std::pair<std::size_t, bool>> places;  // byte in a vertex; true: a double
        std::size_t stride = 0;
        std::vector<std::size_t> starts;
        for (const PlyProperty& property : vertex.properties) {
            starts.push_back(stride);
            stride += bytes_of(property.type);
        }
        for (const char* const name : {"x", "y", "z", "nx", "ny", "nz"}) {
            if (places.size() == 3 && !has_normals) break;
            const std::size_t i = vertex.index_of(name);
            const std::string& type = vertex.properties[i].type;
            if (!is_floating(type))
                throw MeshFault(std::string("PLY: raya reads ") + name + " only as float or double");
            places.emplace_back(starts[i], bytes_of(type) == 8);
        }
        constexpr std::size_t kBatch = 4096;
        std::vector<char> batch(kBatch * stride);
        std::vector<float> vectors;
        for (std::size_t first = 0; first < vertex.count; first += kBatch) {
            const std::size_t count = std::min<std::size_t>(kBatch, vertex.count - first);
            read(batch.data(), count * stride);
            for (std::size_t i = 0; i < count; ++i)
                for (const auto& [byte, is_double] : places) {
                    const char* const at = batch.data() + i * stride + byte;
                    vectors.push_back(is_double ? static_cast<float>(value_at<double>(at)) : value_at<float>(at));
                }
        }
        return vectors;
    }

    /// Returns the bytes of the faces: number of corners, 8 bits, and corners, 32 bits each.
    std::vector<char> read_lists(std::uint64_t vertices) {
        constexpr std::size_t kBlock = 1 << 24;
        std::vector<char> bytes;
        do {
            bytes.resize(bytes.size() + kBlock);
            in_.read(bytes.data() + (bytes.size() - kBlock), kBlock);
            bytes.resize(bytes.size() - kBlock + static_cast<std::size_t>(in_.gcount()));
        } while (in_);
        std::size_t at = 0;
        for (std::uint64_t face = 1; face <= header_.elements[1].count; ++face) {
            const std::size_t size = at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0;
            if (at + 1 + 4 * size > bytes.size()) throw MeshFault(kTruncated);
            for (std::size_t k = 0; k < size; ++k)
                check_corner(value_at<std::uint32_t>(&bytes[at + 1 + 4 * k]), vertices, "", face);
            at += 1 + 4 * size;
        }
        bytes.resize(at);
        return bytes;
    }

    std::istream& in_;
    const PlyHeader& header_;
    bool swaps_;
};

}  // namespace

bool put_plain_ply(const std::string& file, ImportOutput& output) {
    std::ifstream in(file, std::ios::binary);
    const PlyHeader header = read_ply_header(in);
    BinaryPly ply(in, header);
    if (!ply.is_plain()) return false;
    ply.put(output);
    return true;
}

}  // namespace raya
