#include <fmt/core.h>

#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>

#include "host/scene/generate.hpp"
#include "host/scene/polygon.hpp"

using namespace raya;

namespace {

std::string joined(const std::function<std::string_view()>& next_piece) {
    std::string text;
    for (std::string_view piece = next_piece(); !piece.empty(); piece = next_piece()) text += piece;
    return text;
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

TEST_CASE("terrain: PLY contains the generated scene", "[generate]") {
    for (const int triangles : {1, 2, 5, 250}) {
        CAPTURE(triangles);
        const Scene scene = generate_terrain(triangles, 3);
        const std::string ply = joined(terrain_ply(triangles, 3));
        const std::size_t header = ply.find("end_header\n") + 11, faces = ply.size() - 13 * scene.polygons.size();
        CHECK_THAT(ply.substr(0, header), Catch::Contains(fmt::format("element vertex {}\n", (faces - header) / 12)) &&
                                              Catch::Contains(fmt::format("element face {}\n", triangles)));
        for (std::size_t i = 0; i < scene.polygons.size(); ++i) {
            const std::size_t face = faces + 13 * i;
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
