// Decoded jobs: every word belongs to one record and equals the scene's value rounded to fp32.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "host/scene/nff.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/polygon.hpp"
#include "tests/paths.h"
#include "tests/reference/reference.hpp"
#include "tests/scene/fp32.hpp"
#include "tests/scene/packed_scene.hpp"

using namespace raya;

namespace {

constexpr double kRounding = 0x1p-24;  // relative error of one rounding to fp32

// Bound of the error of a shading normal at a corner: a few roundings of the patch's origin, divided by the patch's
// shortest side. In the scenes of this file, this side is at least 1/100 of the scene's extent.
constexpr double kNormalLimit = 8 * 100 * kRounding;

Surface rounded(Surface s) {
    for (double* value : {&s.diffuse, &s.specular, &s.shine, &s.transmittance, &s.refraction_index})
        *value = fp32(*value);
    if (s.checker) s.checker = Checker{fp32(s.checker->even), fp32(s.checker->odd), fp32(s.checker->size)};
    s.colour = s.checker ? s.checker->even : fp32(s.colour);  // a checkered surface has the colour of its even squares
    return s;
}

struct Point2 {
    double u, v;
};
Point2 flattened(const Vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

/// Compares the words of a job with the job's scene, record by record.
class JobCheck {
  public:
    explicit JobCheck(const Scene& scene, const std::vector<std::uint32_t>& words)
        : scene_(scene), packed_(words), limit_(8 * kRounding * scene_extent(scene)) {}

    void run() {
        for (std::size_t i = 0; i < scene_.surfaces.size(); ++i) {
            const std::size_t at = sizeof(raya_job) / 4 + i * RAYA_SURFACE_WORDS;
            surface_at_.push_back(static_cast<std::uint32_t>(at));
            CHECK(packed_.surface(at) == rounded(scene_.surfaces[i]));
        }
        const raya_job& job = packed_.job();
        REQUIRE(job.lights == scene_.lights.size());
        REQUIRE(job.objects.spheres == scene_.spheres.size());
        REQUIRE(job.objects.planes == scene_.planes.size());
        REQUIRE(job.objects.cones == scene_.cones.size());
        for (std::size_t i = 0; i < job.lights; ++i)
            check_light(scene_.lights[i], job.lights_at + i * RAYA_LIGHT_WORDS);
        for (std::size_t i = 0; i < job.objects.spheres; ++i)
            check_sphere(scene_.spheres[i], job.objects.spheres_at + i * RAYA_SPHERE_WORDS,
                         raya_sphere_surfaces_at(job.objects.spheres_at, job.objects.spheres) + i);
        CHECK(job.objects.spheres_at % 4 == 0);
        for (std::size_t i = 0; i < job.objects.planes; ++i)
            check_plane(scene_.planes[i], job.objects.planes_at + i * RAYA_PLANE_WORDS);
        for (std::size_t i = 0; i < job.objects.cones; ++i)
            check_cone(scene_.cones[i], job.objects.cones_at + i * RAYA_CONE_WORDS);
        std::size_t face = 0;
        for (const Polygon& polygon : scene_.polygons) check_faces(polygon, face);
        CHECK(face == job.objects.polygons);
        CHECK(packed_.unread_words() == 0);
        CHECK(packed_.reread_words() == 0);
    }

  private:
    void check_surface(int surface, std::size_t at) { check_surface_word(surface, at + RAYA_OBJECT_SURFACE_AT); }
    void check_surface_word(int surface, std::size_t at) {
        CHECK(packed_.word(at) == surface_at_.at(static_cast<std::size_t>(surface)));
    }

    void check_light(const Light& light, std::size_t at) {
        CHECK(packed_.vector(at + RAYA_LIGHT_POSITION) == fp32(light.position));
        CHECK(packed_.vector(at + RAYA_LIGHT_COLOUR) == fp32(light_colour(scene_, light)));
    }

    void check_sphere(const Sphere& sphere, std::size_t at, std::size_t surface_at) {
        CHECK(packed_.vector(at + RAYA_SPHERE_CENTRE) == fp32(sphere.centre));
        CHECK(packed_.real(at + RAYA_SPHERE_SQUARE) == fp32(sphere.radius * std::abs(sphere.radius)));
        check_surface_word(sphere.surface, surface_at);
    }

    void check_plane(const Plane& plane, std::size_t at) {
        CHECK(packed_.vector(at + RAYA_PLANE_NORMAL) == fp32(plane.normal));
        CHECK(packed_.real(at + RAYA_PLANE_DISTANCE) == fp32(plane.distance));
        check_surface(plane.surface, at);
    }

    void check_cone(const Cone& cone, std::size_t at) {
        const Vec3 base = packed_.vector(at + RAYA_CONE_BASE), axis = packed_.vector(at + RAYA_CONE_AXIS);
        const double radius = packed_.real(at + RAYA_CONE_RADIUS), height = packed_.real(at + RAYA_CONE_HEIGHT);
        CHECK(base == fp32(cone.base));
        CHECK(radius == fp32(std::abs(cone.base_radius)));
        CHECK((base + height * axis - cone.apex).length() <= limit_);
        CHECK(std::abs(radius + packed_.real(at + RAYA_CONE_SLOPE) * height - std::abs(cone.apex_radius)) <= limit_);
        CHECK(packed_.word(at + RAYA_CONE_INSIDE) == (cone.base_radius < 0 || cone.apex_radius < 0 ? 1u : 0u));
        check_surface(cone.surface, at);
    }

    /// Checks the job's faces of a polygon: the polygon itself, or the triangles of a patch. `face` is the number of
    /// the first face; the function adds the number of faces to it.
    void check_faces(const Polygon& polygon, std::size_t& face) {
        const Vec3 normal = newell_normal(polygon.vertices);
        for (const std::vector<int>& corners : faces_of(polygon)) {
            CAPTURE(face);
            const std::size_t at = packed_.job().objects.polygons_at + face++ * RAYA_POLYGON_WORDS;
            CHECK(packed_.vector(at + RAYA_PLANE_NORMAL) == fp32(normal.normalized()));
            CHECK(packed_.real(at + RAYA_PLANE_DISTANCE) == fp32(normal.normalized().dot(polygon.vertices[0])));
            CHECK(packed_.word(at + RAYA_POLYGON_AXIS) == static_cast<std::uint32_t>(dropped_axis(normal)));
            check_surface(polygon.surface, at);
            REQUIRE(packed_.word(at + RAYA_POLYGON_CORNERS) == corners.size());
            check_outline(polygon, corners, packed_.word(at + RAYA_POLYGON_CORNERS_AT));
            const std::size_t normals_at = packed_.word(at + RAYA_POLYGON_NORMALS_AT);
            REQUIRE((normals_at == 0) == polygon.normals.empty());
            if (normals_at != 0) check_normals(polygon, corners, normals_at);
        }
    }

    static std::vector<std::vector<int>> faces_of(const Polygon& polygon) {
        std::vector<std::vector<int>> faces;
        if (!polygon.normals.empty()) {
            for (const auto& t : triangulate(polygon.vertices, newell_normal(polygon.vertices)))
                faces.emplace_back(t.begin(), t.end());
            return faces;
        }
        faces.emplace_back(polygon.vertices.size());
        std::iota(faces[0].begin(), faces[0].end(), 0);
        return faces;
    }

    static Vec3 vertex(const Polygon& polygon, int corner) {
        return polygon.vertices[static_cast<std::size_t>(corner)];
    }

    void check_outline(const Polygon& polygon, const std::vector<int>& corners, std::size_t corners_at) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            CAPTURE(i);
            CHECK(packed_.vector(corners_at + i * RAYA_CORNER_WORDS) == fp32(vertex(polygon, corners[i])));
            CHECK(packed_.real(corners_at + i * RAYA_CORNER_WORDS + 3) == 0);
        }
    }

    /// Checks that the normal interpolated at the corners of a patch's triangle equals the vertex normal.
    void check_normals(const Polygon& patch, const std::vector<int>& corners, std::size_t at) {
        const int axis = dropped_axis(newell_normal(patch.vertices));
        const double u0 = packed_.real(at + RAYA_PATCH_ORIGIN), v0 = packed_.real(at + RAYA_PATCH_ORIGIN + 1);
        const Vec3 n0 = packed_.vector(at + RAYA_PATCH_N0), nu = packed_.vector(at + RAYA_PATCH_NU);
        const Vec3 nv = packed_.vector(at + RAYA_PATCH_NV);
        for (const int corner : corners) {
            const Point2 p = flattened(vertex(patch, corner), axis);
            const Vec3 normal = n0 + (p.u - u0) * nu + (p.v - v0) * nv;
            CHECK((normal - patch.normals[static_cast<std::size_t>(corner)]).length() <= kNormalLimit);
        }
    }

    const Scene& scene_;
    PackedScene packed_;
    double limit_;  // bound of the error of a position: a few roundings of the largest coordinate
    std::vector<std::uint32_t> surface_at_;
};

template <class Record>
WordsOf<Record> words_of(const Record& record) {
    return std::bit_cast<WordsOf<Record>>(record);
}

JobSettings settings_for(std::uint32_t width, std::uint32_t height, Sampling sampling = Sampling::kCentres) {
    JobSettings settings;
    settings.image = {width, height};
    settings.sampling = sampling;
    return settings;
}

/// Returns a scene of two patches (a quadrangle and a triangle), a concave polygon and a checkered surface.
Scene patch_scene() {
    Scene scene;
    scene.view.from = {0, 0, -5};
    scene.surfaces.resize(2);
    scene.surfaces[1].checker = Checker{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.7};
    const Vec3 a = Vec3(0.6, 0, 0.8), b = Vec3(0, 0.6, 0.8), c = Vec3(0, 0, 1);
    scene.polygons = {{{{0, 0, 1}, {1, 0, 1}, {1.2, 1, 1}, {0, 1, 1}}, {a, b, c, a}, 0},
                      {{{0, 0, 2}, {2, 0, 1}, {0, 2, 1}}, {b, a, c}, 1},
                      {{{0, 0, 3}, {3, 0, 3}, {1, 1, 3}, {0, 3, 3}}, {}, 0}};
    return scene;
}

}  // namespace

TEST_CASE("the jobs of all scenes decode to the scenes, and every word belongs to one record", "[packer]") {
    int scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(RAYA_SOURCE_DIR "/scenes")) {
        if (entry.path().extension() != ".nff") continue;
        ++scenes;
        CAPTURE(entry.path().filename().string());
        const Scene scene = read_nff(entry.path());
        const PackedJob packed = pack_job(scene, settings_for(64, 48));
        JobCheck(scene, packed.words()).run();
        const auto is_patch = [](const Polygon& p) { return !p.normals.empty(); };
        CHECK(packed.has_patches() == std::any_of(scene.polygons.begin(), scene.polygons.end(), is_patch));
    }
    CHECK(scenes >= 6);
}

TEST_CASE("patches are packed as triangles, polygons as outlines", "[packer]") {
    const Scene scene = patch_scene();
    const PackedJob packed = pack_job(scene, settings_for(8, 8));
    JobCheck(scene, packed.words()).run();
    CHECK(PackedScene(packed.words()).job().objects.polygons == 2 + 1 + 1);
    CHECK(packed.has_patches());
    const std::size_t words = sizeof(raya_job) / 4 + 2 * RAYA_SURFACE_WORDS + 4 * RAYA_POLYGON_WORDS +
                              (3 + 3 + 3 + 4) * RAYA_CORNER_WORDS + 3 * RAYA_PATCH_WORDS;
    CHECK(packed.words().size() == words);
}

TEST_CASE("a job's header contains settings, background, ambient light and extent", "[packer]") {
    Scene scene = patch_scene();
    scene.background = {0.1, 0.2, 0.3};
    JobSettings settings = settings_for(32, 24);
    settings.bounces = 3;
    for (std::uint32_t i = 0; i < RAYA_EVENTS; ++i) settings.cycles[i] = 100 + i;
    raya_job job = PackedScene(pack_job(scene, settings).words()).job();
    CHECK((job.mapping.width == 32 && job.mapping.height == 24 && job.mapping.pes == 1));
    CHECK((job.mapping.parameter == 0 && job.mapping.kind == RAYA_FOLD_CYCLIC));
    CHECK(job.bounces == 3);
    CHECK(std::equal(settings.cycles.begin(), settings.cycles.end(), job.cycles));
    CHECK(Vec3(job.eye[0], job.eye[1], job.eye[2]) == Vec3(0, 0, -5));
    CHECK(Vec3(job.background[0], job.background[1], job.background[2]) == fp32(scene.background));
    CHECK(job.ambient == 1);  // the scene has no lights
    CHECK(job.extent == 5);   // the eye's distance
    scene.lights = {{{1, 2, 3}, {}}, {{4, 5, 6}, Colour(0.1, 0.2, 0.3)}};
    scene.spheres = {{{-8, 0, 0}, -2, 0}};
    job = PackedScene(pack_job(scene, settings).words()).job();
    CHECK(job.ambient == static_cast<float>(std::sqrt(2.0) / 4));
    CHECK(job.extent == 10);
}

TEST_CASE("header() agrees with the words after set_header() and append()", "[packer]") {
    PackedJob job = pack_job(patch_scene(), settings_for(8, 6));
    const std::vector<std::uint32_t> before = job.words();
    CHECK(words_of(job.header()) == words_of(PackedScene(before).job()));
    raya_job header = job.header();
    header.mapping = {8, 6, 5, 7, RAYA_FOLD_BLOCK};
    job.set_header(header);
    job.append(std::vector<std::uint32_t>{11, 12, 13});
    CHECK(words_of(job.header()) == words_of(header));
    CHECK(words_of(PackedScene(job.words()).job()) == words_of(header));
    const auto first = static_cast<std::ptrdiff_t>(kWordsOf<raya_job>);
    REQUIRE(job.words().size() == before.size() + 3);
    CHECK(std::equal(before.begin() + first, before.end(), job.words().begin() + first));
    CHECK(std::vector<std::uint32_t>(job.words().end() - 3, job.words().end()) ==
          std::vector<std::uint32_t>{11, 12, 13});
}

TEST_CASE("put_record() writes a record at its index and no other word", "[packer]") {
    std::vector<std::uint32_t> words = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const raya_mapping mapping{20, 30, 40, 50, RAYA_TILES};
    put_record(words, 2, mapping);
    CHECK(words == std::vector<std::uint32_t>{1, 2, 20, 30, 40, 50, RAYA_TILES, 8, 9});
    CHECK(words_of(record_at<raya_mapping>(words, 2)) == words_of(mapping));
    CHECK(record_at<raya_mapping>(words, 4).width == 40);
}

TEST_CASE("a job's corner and steps give the reference's primary rays", "[packer]") {
    Scene scene = patch_scene();
    scene.view = {{3, -4, 5}, {0.5, 1, -2}, {0.1, 0.2, 1}, 50, 0, 1, 1};
    for (const bool corners : {false, true})
        for (const auto& [width, height] :
             {std::pair{64u, 48u}, std::pair{1u, 7u}, std::pair{9u, 1u}, std::pair{1u, 1u}}) {
            const Sampling sampling = corners ? Sampling::kCorners : Sampling::kCentres;
            const raya_job job = PackedScene(pack_job(scene, settings_for(width, height, sampling)).words()).job();
            reference::Options options;
            options.width = static_cast<int>(width);
            options.height = static_cast<int>(height);
            options.corners = corners;
            const auto vector = [](const float(&xyz)[3]) { return Vec3(xyz[0], xyz[1], xyz[2]); };
            for (std::uint32_t j = 0; j < height; ++j)
                for (std::uint32_t x = 0; x < width; ++x) {
                    const Vec3 direction =
                        vector(job.corner) + double(x) * vector(job.column_step) + double(j) * vector(job.row_step);
                    const reference::Ray ray = reference::primary_ray(scene, options, x, j);
                    CAPTURE(corners, width, height, x, j);
                    CHECK((direction.normalized() - ray.direction).length() <= 8 * kRounding);
                    CHECK(vector(job.eye) == ray.origin);
                }
        }
}
