#include "host/scene/packer.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "host/base/parallel.hpp"
#include "host/error.hpp"
#include "host/scene/polygon.hpp"

namespace raya {
namespace {

// The words of a job, with the number format and the length scale of its numbers.
struct JobWords : std::vector<std::uint32_t> {
    NumberFormat format;
    double unit;  // job units per scene unit, a power of two

    JobWords(const NumberFormat& number_format, double job_unit) : format(number_format), unit(job_unit) {}
};

void put(JobWords& words, double value) {
    words.push_back(std::bit_cast<std::uint32_t>(round_to_format(value, words.format)));
}
void put(JobWords& words, const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) put(words, v[axis]);
}
// put() appends a dimensionless number, which is not scaled. The following functions scale their argument: put_length()
// a length or position, put_square() the square of a length, put_per_length() a reciprocal length.
template <class Value>
void put_length(JobWords& words, const Value& value) {
    put(words, words.unit * value);
}
void put_square(JobWords& words, double value) { put(words, words.unit * words.unit * value); }
void put_per_length(JobWords& words, const Vec3& v) { put(words, v / words.unit); }
void put_index(JobWords& words, std::size_t value) { words.push_back(static_cast<std::uint32_t>(value)); }

void store(float (&field)[3], const Vec3& value, const NumberFormat& format) {
    for (int axis = 0; axis < 3; ++axis) field[axis] = round_to_format(value[axis], format);
}

// Writes the camera into the job: the eye, and the directions of primary rays as a corner and two steps
// (kernels/README.md, Camera).
void pack_camera(raya_job& job, const View& view, const JobSettings& settings) {
    const bool at_corners = settings.sampling == Sampling::kCorners;
    const auto sample_count = [&](std::uint32_t pixels) {
        return at_corners ? std::max(1.0, pixels - 1.0) : double(pixels);
    };
    const auto first_sample = [&](std::uint32_t pixels) { return at_corners ? (pixels == 1 ? 0.5 : 0.0) : 0.5; };
    const double columns = sample_count(settings.image.width), rows = sample_count(settings.image.height);
    const Vec3 gaze = (view.at - view.from).normalized();
    const Vec3 right = gaze.cross(view.up).normalized(), top = right.cross(gaze);
    const double half_height = std::tan(view.angle_degrees * std::numbers::pi / 360);
    const double step = 2 * half_height / rows;  // pixels are square
    store(job.eye, std::ldexp(1.0, settings.length_exponent) * view.from, settings.format);
    store(job.column_step, step * right, settings.format);
    store(job.row_step, -step * top, settings.format);
    store(job.corner,
          gaze + (first_sample(settings.image.width) - columns / 2) * step * right -
              (first_sample(settings.image.height) - rows / 2) * step * top,
          settings.format);
}

void pack_surface(JobWords& words, const Surface& s) {
    const Checker checker = s.checker.value_or(Checker{s.colour, s.colour, 0});
    put(words, checker.even);
    for (const double value : {s.diffuse, s.specular, s.shine, s.transmittance, s.refraction_index}) put(words, value);
    put(words, checker.odd);
    put_length(words, checker.size);
}

// A flat polygon of the packed scene: a whole polygon, or one triangle of a patch.
struct Face {
    const Polygon* polygon;
    std::span<const int> corners;  // indices of vertices
};

bool is_one_face(const Polygon& p) { return p.normals.empty() || p.vertices.size() == 3; }

// Calls visit(face) for each face of a polygon.
template <class Visit>
void for_faces(const Polygon& p, const Visit& visit) {
    if (is_one_face(p)) {
        std::vector<int> corners(p.vertices.size());
        std::iota(corners.begin(), corners.end(), 0);
        return visit(Face{&p, corners});
    }
    for (const std::array<int, 3>& triangle : triangulate(p.vertices, newell_normal(p.vertices)))
        visit(Face{&p, triangle});
}

struct Point2 {
    double u, v;
};

Point2 outline_point(const Vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

void pack_corners(JobWords& words, const Face& face) {
    for (const int corner : face.corners) {
        put_length(words, face.polygon->vertices[static_cast<std::size_t>(corner)]);
        put(words, 0);
    }
}

// Appends the shading normal as a linear function of the outline's coordinates.
void pack_patch(JobWords& words, const Face& face, int axis) {
    const auto corner = [&](int i) { return outline_point(face.polygon->vertices[face.corners[i]], axis); };
    const auto normal = [&](int i) { return face.polygon->normals[face.corners[i]]; };
    const Point2 a = corner(0);
    const Point2 b{corner(1).u - a.u, corner(1).v - a.v}, c{corner(2).u - a.u, corner(2).v - a.v};
    const Vec3 nb = normal(1) - normal(0), nc = normal(2) - normal(0);
    const double area = b.u * c.v - b.v * c.u;
    put_length(words, a.u);
    put_length(words, a.v);
    put(words, normal(0));
    put_per_length(words, area != 0 ? (c.v * nb - b.v * nc) / area : Vec3(0));
    put_per_length(words, area != 0 ? (b.u * nc - c.u * nb) / area : Vec3(0));
}

// The words of some polygons: their faces' records, and the corners and normals to which the records refer.
struct FaceWords {
    std::size_t records = 0, details = 0;
};

FaceWords face_words(std::span<const Polygon> polygons) {
    FaceWords words;
    for (const Polygon& p : polygons) {
        const std::size_t corners = p.vertices.size(),
                          faces = is_one_face(p) ? 1 : std::max<std::size_t>(corners, 2) - 2;
        words.records += faces * RAYA_POLYGON_WORDS;
        words.details += (is_one_face(p) ? corners : 3 * faces) * RAYA_CORNER_WORDS;
        if (!p.normals.empty()) words.details += faces * RAYA_PATCH_WORDS;
    }
    return words;
}

// Appends a face to `records` and `details`. `details_at`: offset of `details` in the job.
void pack_face(JobWords& records, JobWords& details, std::size_t details_at, const Face& face,
               const std::vector<std::uint32_t>& surface_at) {
    const Polygon& polygon = *face.polygon;
    const Vec3 normal = newell_normal(polygon.vertices).normalized();
    const int axis = dropped_axis(normal);
    put(records, normal);
    put_length(records, normal.dot(polygon.vertices[0]));
    records.push_back(surface_at[polygon.surface]);
    put_index(records, axis);
    put_index(records, face.corners.size());
    put_index(records, details_at + details.size());
    pack_corners(details, face);
    put_index(records, polygon.normals.empty() ? 0 : details_at + details.size());
    if (!polygon.normals.empty()) pack_patch(details, face, axis);
}

// Appends all polygons, on several threads, and returns the number of their faces. Each thread packs a part of the
// polygons and copies their words into place.
std::size_t pack_polygons(JobWords& words, std::span<const Polygon> polygons,
                          const std::vector<std::uint32_t>& surface_at) {
    constexpr std::size_t kPolygons = 1 << 14;  // of a part
    const std::size_t parts = (polygons.size() + kPolygons - 1) / kPolygons;
    const auto polygons_of = [&](std::size_t part) {
        const std::size_t first = part * kPolygons;
        return polygons.subspan(first, std::min(kPolygons, polygons.size() - first));
    };
    std::vector<FaceWords> starts(parts + 1);  // the words of all earlier parts
    parallel_for(parts, core_count(), [&](std::size_t part) { starts[part + 1] = face_words(polygons_of(part)); });
    for (std::size_t part = 0; part < parts; ++part) {
        starts[part + 1].records += starts[part].records;
        starts[part + 1].details += starts[part].details;
    }
    const std::size_t records_at = words.size(), details_at = records_at + starts[parts].records;
    words.resize(details_at + starts[parts].details);
    parallel_for(parts, core_count(), [&](std::size_t part) {
        JobWords records(words.format, words.unit), details(words.format, words.unit);
        const std::size_t own_records_at = records_at + starts[part].records;
        const std::size_t own_details_at = details_at + starts[part].details;
        for (const Polygon& polygon : polygons_of(part))
            for_faces(polygon,
                      [&](const Face& face) { pack_face(records, details, own_details_at, face, surface_at); });
        std::copy(records.begin(), records.end(), words.begin() + static_cast<std::ptrdiff_t>(own_records_at));
        std::copy(details.begin(), details.end(), words.begin() + static_cast<std::ptrdiff_t>(own_details_at));
    });
    return starts[parts].records / RAYA_POLYGON_WORDS;
}

void pack(JobWords& words, const Cone& c, const std::vector<std::uint32_t>& surface_at) {
    const Vec3 along = c.apex - c.base;
    const double height = along.length(), r0 = std::abs(c.base_radius), r1 = std::abs(c.apex_radius);
    put_length(words, c.base);
    put_length(words, r0);
    words.push_back(surface_at[c.surface]);
    put(words, along / height);
    put_length(words, height);
    put(words, (r1 - r0) / height);
    put_index(words, c.base_radius < 0 || c.apex_radius < 0 ? 1 : 0);
}

// Returns the job's header without the sizes and offsets of its lists, which pack_objects() adds.
raya_job header_of(const Scene& scene, const JobSettings& settings) {
    raya_job job{};
    job.mapping = {settings.image.width, settings.image.height, 1, 0, RAYA_FOLD_CYCLIC};
    job.bounces = settings.bounces;
    std::copy(settings.cycles.begin(), settings.cycles.end(), job.cycles);
    pack_camera(job, scene.view, settings);
    store(job.background, scene.background, settings.format);
    job.ambient = round_to_format(ambient_intensity(scene), settings.format);
    job.extent = round_to_format(std::ldexp(scene_extent(scene), settings.length_exponent), settings.format);
    return job;
}

std::size_t words_of_objects(const Scene& scene) {
    const FaceWords faces = face_words(scene.polygons);
    return scene.spheres.size() * (RAYA_SPHERE_WORDS + 1) + scene.lights.size() * RAYA_LIGHT_WORDS +
#define RAYA_ADD_WORDS(kind, kinds, KIND) scene.kinds.size() * RAYA_##KIND##_WORDS +
           scene.planes.size() * RAYA_PLANE_WORDS + RAYA_FIXED_LIST(RAYA_ADD_WORDS) faces.records + faces.details;
}

// Appends spheres, lights, planes, other objects of fixed size, and polygons. Writes the number of each kind and the
// offset of its list into the job's header.
void pack_objects(JobWords& words, raya_job& job, const Scene& scene, const std::vector<std::uint32_t>& surface_at) {
    const auto start_list = [&](const auto& list, std::uint32_t& count, std::uint32_t& at) {
        count = static_cast<std::uint32_t>(list.size());
        at = static_cast<std::uint32_t>(words.size());
    };
    start_list(scene.spheres, job.objects.spheres, job.objects.spheres_at);
    for (const Sphere& s : scene.spheres) {
        put_length(words, s.centre);
        put_square(words, std::copysign(s.radius * s.radius, s.radius));
    }
    for (const Sphere& s : scene.spheres) words.push_back(surface_at[s.surface]);
    start_list(scene.lights, job.lights, job.lights_at);
    for (const Light& light : scene.lights) {
        put_length(words, light.position);
        put(words, light_colour(scene, light));
    }
    start_list(scene.planes, job.objects.planes, job.objects.planes_at);
    for (const Plane& p : scene.planes) {
        put(words, p.normal);
        put_length(words, p.distance);
        words.push_back(surface_at[p.surface]);
    }
#define RAYA_PACK(kind, kinds, KIND)                                    \
    start_list(scene.kinds, job.objects.kinds, job.objects.kinds##_at); \
    for (const auto& object : scene.kinds) pack(words, object, surface_at);
    RAYA_FIXED_LIST(RAYA_PACK)
    job.objects.polygons_at = static_cast<std::uint32_t>(words.size());
    job.objects.polygons = static_cast<std::uint32_t>(pack_polygons(words, scene.polygons, surface_at));
}

}  // namespace

std::uint32_t kind_of_object(const raya_objects& all, std::uint32_t number) {
    std::uint32_t end = 0;
#define RAYA_KIND_OF_OBJECT(kind, kinds, KIND) \
    if (number < (end += all.kinds)) return RAYA_##KIND;
    RAYA_OBJECT_LIST(RAYA_KIND_OF_OBJECT)
    return RAYA_OBJECT_KINDS;
}

std::size_t object_at(const raya_objects& all, std::uint32_t number) {
    const std::uint32_t kind = kind_of_object(all, number);
#define RAYA_KIND_AT(kind, kinds, KIND) all.kinds##_at,
    const std::uint32_t at[] = {RAYA_OBJECT_LIST(RAYA_KIND_AT)};
    return at[kind] + std::size_t{number - raya_first_object(all, kind)} * words_of_kind(kind);
}

std::uint32_t words_of_kind(std::uint32_t kind) {
#define RAYA_WORDS_OF_KIND(kind, kinds, KIND) RAYA_##KIND##_WORDS,
    constexpr std::uint32_t kWords[] = {RAYA_OBJECT_LIST(RAYA_WORDS_OF_KIND)};
    return kWords[kind];
}

PackedJob::PackedJob(const raya_job& header, std::vector<std::uint32_t> words, bool has_patches)
    : header_(header), words_(std::move(words)), has_patches_(has_patches) {
    set_header(header);
}

void PackedJob::set_header(const raya_job& header) {
    header_ = header;
    put_record(words_, 0, header);
}

std::span<std::uint32_t> PackedJob::append_zeros(std::size_t count) {
    const std::size_t at = words_.size();
    words_.resize(at + count);
    return std::span(words_).subspan(at);
}

std::uint32_t ObjectCopier::surface_of(std::uint32_t number) const {
    const raya_objects& all = job_.header().objects;
    return number < all.spheres ? job_.words()[raya_sphere_surfaces_at(all.spheres_at, all.spheres) + number]
                                : job_.object(number)[RAYA_OBJECT_SURFACE_AT];
}

void ObjectCopier::append_surfaces(std::span<const std::uint32_t> numbers) {
    for (const std::uint32_t number : numbers) surface_at_[surface_of(number)] = 0;
    for (auto& [at, copied_at] : surface_at_) {
        copied_at = offset();
        append(at, RAYA_SURFACE_WORDS);
    }
}

raya_objects ObjectCopier::append_objects(std::span<const std::uint32_t> numbers) {
    raya_objects copied{};
    const raya_objects& all = job_.header().objects;
    const auto of_kind = [&](std::uint32_t kind) {
        return std::span(std::ranges::lower_bound(numbers, raya_first_object(all, kind)),
                         std::ranges::lower_bound(numbers, raya_first_object(all, kind + 1)));
    };
    const auto append_kind = [&](std::uint32_t kind, std::uint32_t& count, std::uint32_t& at) {
        at = offset();
        count = static_cast<std::uint32_t>(of_kind(kind).size());
        for (const std::uint32_t number : of_kind(kind)) {
            const std::size_t object = words_.size();
            append(object_at(all, number), words_of_kind(kind));
            if (kind != RAYA_SPHERE) words_[object + RAYA_OBJECT_SURFACE_AT] = surface_at_.at(surface_of(number));
        }
    };
    append_kind(RAYA_SPHERE, copied.spheres, copied.spheres_at);
    for (const std::uint32_t number : of_kind(RAYA_SPHERE)) words_.push_back(surface_at_.at(surface_of(number)));
    append_kind(RAYA_PLANE, copied.planes, copied.planes_at);
#define RAYA_APPEND_KIND(kind, kinds, KIND) append_kind(RAYA_##KIND, copied.kinds, copied.kinds##_at);
    RAYA_FIXED_LIST(RAYA_APPEND_KIND)
    RAYA_APPEND_KIND(polygon, polygons, POLYGON)
    std::size_t polygon = start_ + copied.polygons_at;
    for (std::uint32_t i = 0; i < copied.polygons; ++i, polygon += RAYA_POLYGON_WORDS) {
        const std::uint32_t corners_at = std::exchange(words_[polygon + RAYA_POLYGON_CORNERS_AT], offset());
        append(corners_at, std::size_t{words_[polygon + RAYA_POLYGON_CORNERS]} * RAYA_CORNER_WORDS);
        if (words_[polygon + RAYA_POLYGON_NORMALS_AT] == 0) continue;
        append(std::exchange(words_[polygon + RAYA_POLYGON_NORMALS_AT], offset()), RAYA_PATCH_WORDS);
    }
    return copied;
}

PackedJob pack_job(const Scene& scene, const JobSettings& settings) {
    raya_job job = header_of(scene, settings);
    JobWords words(settings.format, std::ldexp(1.0, settings.length_exponent));
    words.resize(kWordsOf<raya_job>);
    std::vector<std::uint32_t> surface_at;
    for (const Surface& s : scene.surfaces) {
        surface_at.push_back(static_cast<std::uint32_t>(words.size()));
        pack_surface(words, s);
    }
    const std::size_t all_words = words.size() + words_of_objects(scene);
    if (all_words > kMaxWords)
        throw UserError(
            fmt::format("{}: the scene needs {} words, more than 32-bit indices can address; use fewer objects",
                        scene.name, all_words));
    reserve_in_huge_pages<std::uint32_t>(words, all_words + settings.spare_words);
    pack_objects(words, job, scene, surface_at);
    const bool has_patches = std::ranges::any_of(scene.polygons, [](const Polygon& p) { return !p.normals.empty(); });
    return {job, std::move(words), has_patches};
}

}  // namespace raya
