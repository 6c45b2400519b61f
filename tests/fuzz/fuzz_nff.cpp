// The NFF reader as libFuzzer drives it: any bytes are read or refused, and what is read survives being written.
//   tools/fuzz [SECONDS]
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/scene/nff_reader.hpp"
#include "host/scene/nff_writer.hpp"
#include "host/scene/polygon_plane.hpp"
#include "host/scene/triangulate.hpp"

namespace {

using namespace raya;

[[noreturn]] void complain(const char* what, std::string_view detail) {
    std::fprintf(stderr, "fuzz_nff: %s: %.*s\n", what, static_cast<int>(detail.size()), detail.data());
    std::abort();
}

/// A refusal names file and line: "fuzz.nff:LINE: reason".
void check_message(std::string_view message) {
    constexpr std::string_view kName = "fuzz.nff:";
    if (!message.starts_with(kName)) complain("a refusal without file", message);
    const std::size_t end = message.find_first_not_of("0123456789", kName.size());
    if (end == std::string_view::npos || end == kName.size() || message[kName.size()] == '0' ||
        message.substr(end, 2) != ": " || message.size() <= end + 2)
        complain("a refusal without line or reason", message);
}

/// n - 2 triangles of an outline of n vertices, each of three different ones, as the packer cuts patches. Long outlines
/// take cubic time and are left out.
void check_triangles(const Polygon& polygon) {
    constexpr std::size_t kMostVertices = 32;
    const std::size_t n = polygon.vertices.size();
    if (n > kMostVertices) return;
    const auto triangles = triangulate(polygon.vertices, newell_normal(polygon.vertices));
    if (triangles.size() != n - 2) complain("wrong number of triangles", std::to_string(triangles.size()));
    for (const auto& [a, b, c] : triangles)
        if (a == b || b == c || c == a || a < 0 || b < 0 || c < 0 || static_cast<std::size_t>(std::max({a, b, c})) >= n)
            complain("a wrong triangle", std::to_string(a));
}

/// What is left of a file in which something was passed over is NFF, and a file that is NFF has nothing of the kind.
void check_leniently(std::string_view text) {
    std::vector<NffRemark> remarks;
    const Scene scene = parse_nff(text, "fuzz.nff", &remarks);
    const std::string written = write_nff(scene);
    if (!(parse_nff(written, "fuzz.nff") == scene)) complain("changed by being written and read", written);
    for (const NffRemark& remark : remarks)
        if (remark.count == 0 || remark.line < 1) complain("a remark without count or line", remark.what);
    if (remarks.empty() && !(parse_nff(text, "fuzz.nff") == scene)) complain("passed over without a remark", text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        check_leniently(text);
    } catch (const UserError& error) {
        check_message(error.what());
    }
    try {
        const Scene scene = parse_nff(text, "fuzz.nff");
        const std::string written = write_nff(scene);
        if (!(parse_nff(written, "fuzz.nff") == scene)) complain("changed by being written and read", written);
        for (const Polygon& polygon : scene.polygons) check_triangles(polygon);
    } catch (const UserError& error) {
        check_message(error.what());
    }
    return 0;  // any other exception ends the program: a find
}
