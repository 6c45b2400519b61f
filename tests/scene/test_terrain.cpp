#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <string>

#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/polygon.hpp"

using namespace raya;

namespace {

std::string joined(const std::function<std::string_view()>& next_piece) {
    std::string text;
    for (std::string_view piece = next_piece(); !piece.empty(); piece = next_piece()) text += piece;
    return text;
}

/// FNV-1a, so that the hash does not depend on a library.
std::uint64_t hash_of(const std::string& bytes) {
    std::uint64_t hash = 14695981039346656037u;
    for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return hash;
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes.at(at + i));
    return word;
}

}  // namespace

TEST_CASE("terrain: the requested number of triangles, which face upwards and share their corners", "[generate]") {
    for (const int triangles : {1, 2, 3, 7, 8, 9, 1000, 20001}) {
        const Scene scene = generate_terrain(triangles, 5);
        CAPTURE(triangles);
        REQUIRE(scene.polygons.size() == static_cast<std::size_t>(triangles));
        double lowest = 0, highest = 0;
        for (const Polygon& polygon : scene.polygons) {
            const Vec3 normal = newell_normal(polygon.vertices);
            CHECK(normal.z == 1);  // twice the area of half a cell, seen from above
            CHECK(std::abs(normal.x) + std::abs(normal.y) < 6);
            for (const Vec3& v : polygon.vertices) {
                lowest = std::min(lowest, v.z);
                highest = std::max(highest, v.z);
            }
        }
        if (triangles > 1000) CHECK(highest - lowest > 2);
    }
}

TEST_CASE("terrain: the same bytes on all platforms, other bytes with another seed", "[generate]") {
    CHECK(hash_of(joined(terrain_nff(20000, 1))) == 0x1b0ed0ab47090b08);
    CHECK(hash_of(joined(terrain_ply(20000, 1))) == 0x3abb6da565f73843);
    CHECK(joined(terrain_ply(200, 1)) == joined(terrain_ply(200, 1)));
    CHECK(joined(terrain_ply(200, 1)) != joined(terrain_ply(200, 2)));
}

TEST_CASE("terrain: NFF and PLY contain the generated scene", "[generate]") {
    for (const int triangles : {1, 2, 5, 250}) {
        CAPTURE(triangles);
        const Scene scene = generate_terrain(triangles, 3);
        CHECK(joined(terrain_nff(triangles, 3)) == write_nff(scene));
        const std::string ply = joined(terrain_ply(triangles, 3));
        const std::size_t header = ply.find("end_header\n") + 11, side = triangles == 1 || triangles == 2 ? 1
                                                                         : triangles == 5                 ? 2
                                                                                                          : 12;
        const std::size_t rows = (static_cast<std::size_t>(triangles) + 2 * side - 1) / (2 * side);
        const std::size_t vertices = (side + 1) * (rows + 1);
        CHECK(ply.substr(0, header) ==
              "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) +
                  "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(triangles) +
                  "\nproperty list uchar int vertex_indices\nend_header\n");
        REQUIRE(ply.size() == header + 12 * vertices + 13 * scene.polygons.size());
        for (std::size_t i = 0; i < scene.polygons.size(); ++i) {
            const std::size_t face = header + 12 * vertices + 13 * i;
            CHECK(ply[face] == 3);
            for (std::size_t corner = 0; corner < 3; ++corner)
                for (int axis = 0; axis < 3; ++axis) {
                    const std::size_t vertex = word_at(ply, face + 1 + 4 * corner);
                    const std::uint32_t word = word_at(ply, header + 12 * vertex + 4 * static_cast<std::size_t>(axis));
                    CHECK(std::bit_cast<float>(word) == scene.polygons[i].vertices[corner][axis]);
                }
        }
    }
}
