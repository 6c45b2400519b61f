#include "host/mesh/import_records.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "host/base/whole_file.hpp"
#include "host/mesh/mesh_file.hpp"

namespace raya {
namespace {

class RecordReader {
  public:
    RecordReader(RecordSource& source, MeshScene& scene) : source_(source), scene_(scene) {}

    void read() {
        if (take<ImportRecord>() != ImportRecord::kStart) refuse();
        while (true) {
            switch (take<ImportRecord>()) {
                case ImportRecord::kFile:
                    register_input(take_text());
                    break;
                case ImportRecord::kSurface:
                    take_surface();
                    break;
                case ImportRecord::kIgnored: {
                    const std::string what = take_text();
                    scene_.ignore(what, take_text());
                    break;
                }
                case ImportRecord::kMesh:
                    scene_.add(take_mesh());
                    break;
                case ImportRecord::kError:
                    scene_.refuse("cannot read the mesh: " + take_text());
                case ImportRecord::kEnd:
                    return;
                default:
                    refuse();
            }
        }
    }

  private:
    [[noreturn]] void refuse() const { scene_.refuse("the import process sends an invalid record"); }

    template <class Value>
    Value take() {
        Value value;
        source_.take(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    }

    std::string take_text() {
        const auto size = take<std::uint32_t>();
        if (size > kMaxImportedText) refuse();
        std::string text(size, '\0');
        source_.take(text.data(), size);
        return text;
    }

    /// Takes `count` values in pieces. The memory grows with the bytes that arrive, because `count` may be wrong.
    template <class Value>
    std::vector<Value> take_list(std::uint64_t count) {
        constexpr std::uint64_t kPiece = 1 << 16;
        std::vector<Value> list;
        while (list.size() < count) {
            const std::size_t old_size = list.size(), piece = std::min(count - old_size, kPiece);
            list.resize(old_size + piece);
            source_.take(reinterpret_cast<char*>(&list[old_size]), piece * sizeof(Value));
        }
        return list;
    }

    void take_surface() {
        const std::string name = take_text();
        const auto s = take<ImportedSurface>();
        const Surface surface{{s.colour[0], s.colour[1], s.colour[2]},
                              s.diffuse,
                              s.specular,
                              s.shine,
                              s.transmittance,
                              s.refraction_index};
        surfaces_.push_back(scene_.add_surface(name, surface));
    }

    Mesh take_mesh() {
        Mesh mesh;
        mesh.name = take_text();
        const auto header = take<ImportedMesh>();
        const bool normals_fit = header.normals == 0 || header.normals == header.vertices;
        if (std::max({header.vertices, header.faces, header.corners}) > UINT32_MAX || !normals_fit ||
            header.surface >= surfaces_.size())
            refuse();
        mesh.surface = surfaces_[header.surface];
        mesh.vertices = take_list<Imath::V3f>(header.vertices);
        mesh.normals = take_list<Imath::V3f>(header.normals);
        mesh.sizes = take_list<std::uint32_t>(header.faces);
        mesh.corners = take_list<std::uint32_t>(header.corners);
        return mesh;
    }

    RecordSource& source_;
    MeshScene& scene_;
    std::vector<int> surfaces_ = {0};  // index in the scene of each record kSurface; first the default surface
};

}  // namespace

void read_records(RecordSource& source, MeshScene& scene) { RecordReader(source, scene).read(); }

}  // namespace raya
