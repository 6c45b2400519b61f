// What raya_import writes (import_program.cpp).
#pragma once
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace raya {

using Json = nlohmann::json;

/// A fault of the file.
struct MeshFault : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What the program writes. If raya has closed the pipe, SIGPIPE ends the program.
class ImportOutput {
  public:
    explicit ImportOutput(int descriptor) : file_(::fdopen(descriptor, "wb")) {
        if (file_ == nullptr || std::setvbuf(file_, nullptr, _IOFBF, 1 << 16) != 0) std::exit(EXIT_FAILURE);
    }

    template <class Value>
    void put(const Value* values, std::size_t count) {
        if (std::fwrite(values, sizeof(Value), count, file_) != count) std::exit(EXIT_FAILURE);
    }
    void put(const Json& json) {
        const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
        const std::uint64_t size = bytes.size();
        put(&size, 1);
        put(bytes.data(), bytes.size());
    }
    void ignore(const std::string& what, const std::string& place = "") {
        document["ignored"].push_back(Json::array({what, place}));
    }

    [[noreturn]] void end() {
        std::fflush(file_);
        ::_exit(EXIT_SUCCESS);  // without destructors, which a damaged heap could crash
    }
    [[noreturn]] void refuse(const std::string& error) {
        put(Json{{"error", error}});
        end();
    }

    Json document = {
        {"files", Json::array()}, {"ignored", Json::array()}, {"surfaces", Json::array()}, {"meshes", Json::array()}};

  private:
    std::FILE* file_;
};

/// Refuses a corner that is no vertex. `face`: from 1.
inline void check_corner(std::uint32_t corner, std::uint64_t vertices, const std::string& mesh, std::uint64_t face) {
    if (corner >= vertices)
        throw MeshFault((mesh.empty() ? "" : "mesh '" + mesh + "', ") + "face " + std::to_string(face) +
                        ": there is no vertex " + std::to_string(corner) + "; the mesh has " +
                        std::to_string(vertices) + ", numbered from 0; the file may be damaged");
}

}  // namespace raya
