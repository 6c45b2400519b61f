#include "host/mesh/import_checks.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

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

}  // namespace

std::string fault_of_file(const std::string& file, const std::string& extension) {
    std::ifstream in(file, std::ios::binary);
    return extension == "ply"                          ? fault_of_ply(in)
           : extension == "stl"                        ? fault_of_stl(in)
           : extension == "gltf" || extension == "glb" ? fault_of_gltf(in, extension == "glb")
                                                       : "";
}

}  // namespace raya
