// Fuzz target for the records of raya_import: the reader must throw an error with the file's name, or return a scene of
// triangles that does not change if it is written as NFF and read again.
#include <cstring>

#include "host/error.hpp"
#include "host/mesh/import_records.hpp"
#include "host/mesh/mesh_file.hpp"
#include "host/scene/nff.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace raya;
using namespace raya::fuzz;

const char* const kFile = "fuzz.obj";

class Input : public RecordSource {
  public:
    explicit Input(std::string_view bytes) : rest_(bytes) {}
    void take(char* bytes, std::size_t count) override {
        if (count > rest_.size()) throw UserError(std::string(kFile) + ": the input ends");
        std::memcpy(bytes, rest_.data(), count);
        rest_.remove_prefix(count);
    }

  private:
    std::string_view rest_;
};

void check_scene(const Scene& scene) {
    for (const Polygon& polygon : scene.polygons)
        if (polygon.vertices.size() != 3) report_finding("not a triangle", std::to_string(polygon.vertices.size()));
    const std::string nff = write_nff(scene);
    if (!(parse_nff(nff, kFile) == scene)) report_finding("the scene is not valid in NFF", nff);
}

/// Reads the records with remarks, or if `remarks` is null strictly.
void read_and_check(std::string_view text, std::vector<SceneRemark>* remarks, UpAxis up) try {
    MeshScene mesh(kFile, remarks);
    Input input(text);
    read_records(input, mesh);
    check_scene(mesh.finish(up));
    if (remarks == nullptr) return;
    for (const SceneRemark& remark : *remarks) check_refusal(remark_text(kFile, remark), kFile);
} catch (const UserError& error) {
    check_refusal(error.what(), kFile);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<SceneRemark> remarks;
    read_and_check(text_of(data, size), &remarks, UpAxis::kY);
    read_and_check(text_of(data, size), nullptr, UpAxis::kZ);
    return 0;
}
