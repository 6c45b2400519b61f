// Fuzz target for NFF. The reader must throw an error or return a scene. If the scene is written and read again, it
// must not change.
#include <algorithm>
#include <vector>

#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/polygon.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace raya;
using namespace raya::fuzz;

const char* const kFile = "fuzz.nff";

/// Checks that the packer splits each patch into n - 2 triangles of three different vertices. Skips long outlines,
/// because triangulation takes cubic time.
void check_triangles(const Polygon& polygon) {
    constexpr std::size_t kMaxVertices = 32;
    const std::size_t n = polygon.vertices.size();
    if (n > kMaxVertices) return;
    const auto triangles = triangulate(polygon.vertices, newell_normal(polygon.vertices));
    if (triangles.size() != n - 2)
        report_finding("a patch has a wrong number of triangles", std::to_string(triangles.size()));
    for (const auto& [a, b, c] : triangles)
        if (a == b || b == c || c == a || a < 0 || b < 0 || c < 0 || static_cast<std::size_t>(std::max({a, b, c})) >= n)
            report_finding("an invalid triangle", std::to_string(a));
}

void check_round_trip(const Scene& scene) {
    const std::string written = write_nff(scene);
    if (!(parse_nff(written, kFile) == scene))
        report_finding("a scene changes if it is written and read again", written);
}

/// Checks lenient reading. Without remarks, it must give the same scene as strict reading.
void check_leniently(std::string_view text) {
    std::vector<SceneRemark> remarks;
    const Scene scene = parse_nff(text, kFile, &remarks);
    check_round_trip(scene);
    for (const SceneRemark& remark : remarks) {
        if (remark.count == 0 || remark.line < 1) report_finding("a remark without count or line", remark.what);
        check_refusal_with_line(remark_text(kFile, remark), kFile);
    }
    if (remarks.empty() && !(parse_nff(text, kFile) == scene))
        report_finding("the lenient reader changes a scene without a remark", text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = text_of(data, size);
    try {
        check_leniently(text);
    } catch (const UserError& error) {
        check_refusal_with_line(error.what(), kFile);
    }
    try {
        const Scene scene = parse_nff(text, kFile);
        check_round_trip(scene);
        for (const Polygon& polygon : scene.polygons) check_triangles(polygon);
    } catch (const UserError& error) {
        check_refusal_with_line(error.what(), kFile);
    }
    return 0;  // any other exception ends the program, which libFuzzer reports as a finding
}
