// The bytes that the program raya_import writes into a pipe for raya: records, each a kind and its contents. Numbers
// have the byte order of the computer, because both programs are from the same build.
#pragma once
#include <cstddef>
#include <cstdint>

namespace raya {

class MeshScene;

/// Name of the program, which is in module_folder().
inline constexpr const char* kImportProgram = "raya_import";

/// Kind of a record. The first record is kStart, the last kEnd or kError.
enum class ImportRecord : std::uint32_t {
    kStart = 0x5241594D,
    kSurface,  // text: name; ImportedSurface
    kIgnored,  // text: what has no counterpart in raya; text: its place
    kMesh,     // text: name; ImportedMesh; vertices and normals as floats, sizes and corners as 32-bit numbers
    kError,    // text: message
    kEnd,      // nothing
    kFile      // text: path of a file that is read, such as an .mtl
};

/// A text is its number of bytes, a 32-bit number of at most kMaxImportedText, and its bytes.
inline constexpr std::uint32_t kMaxImportedText = 4096;

/// The numbers of Surface.
struct ImportedSurface {
    float colour[3] = {1, 1, 1};
    float diffuse = 1, specular = 0, shine = 0, transmittance = 0, refraction_index = 1;
};

struct ImportedMesh {
    std::uint64_t vertices = 0, normals = 0;  // normals: 0, or the number of vertices
    std::uint64_t faces = 0, corners = 0;     // lengths of Mesh::sizes, which may be empty, and of Mesh::corners
    std::uint32_t surface = 0;                // number of the record kSurface, from 1; 0: the default surface
    std::uint32_t padding = 0;
};

/// Delivers the bytes of the records.
class RecordSource {
  public:
    virtual ~RecordSource() = default;
    /// Writes the next `count` bytes to `bytes`. Throws UserError if there are fewer.
    virtual void take(char* bytes, std::size_t count) = 0;
};

/// Reads all records and adds their surfaces and meshes to the scene. Throws UserError for invalid records and for an
/// error that the program reports. Uses no more memory than a multiple of the bytes that the source delivers.
void read_records(RecordSource& source, MeshScene& scene);

}  // namespace raya
