// Error bounds. The regions follow from bounds of the rounding errors of the intersection tests in kernels/geometry/,
// derived operation by operation, to first order in u. The constants in the code are rounded up enough to cover terms
// of higher order for Y >= 10.
//
//   u  relative rounding error of one operation      f  flush-to-zero threshold: smaller results become 0
//   s  maximum of | |D|^2 - 1 |, D: the direction     n  maximum distance from a ray's origin O to the object
//   w  square root of the discriminant               a' computed value of a
//   "a = b up to e" means |a - b| <= e
//
// The region of an object contains the exact point X = O + t'D for every computed hit distance t'.
//
// Sphere (centre C, radius r), c = C - O. b' has an error of 4un, l' = c' - b'D has an error of 6un, and a
// discriminant >= 0 implies |l'|^2 <= r^2 (1 + 3u) + 3f. X - C = -l' +- w' D up to u (2n + r), and
// l'.D = b (1 - |D|^2) up to 6un. Hence |X - C|^2 = r^2 up to 2r (s + 6u) n + r^2 (s + 5u) + 3f.
//
// Polygon in the plane N.x = d. The sheared coordinates of a corner (kernels/geometry/polygon.clh) have an error of 4un
// along each of the two axes, and an edge has an additional error of un, so the distance of the ray from some point Q
// of the polygon is at most 8un. The kernel compares O + t'D with the bounding box of the corners, widened by a margin.
// If the point is inside, the region contains it, because the region's box has that margin and the rounding errors of
// both. Otherwise t' is the distance at which the ray enters or leaves the box; that point lies between Q and the point
// at the plane's t. The numerator and the denominator of the plane's t have errors of 3u (|d| + |O|) and 3u, so the
// point at that t is off the plane by at most 4u (|d| + |O|) + 4ut. O + t'D is no farther from the plane than this
// point or than Q.
//
// Cone, p = O - base; other names as in kernels/geometry/cone.clh. The ray's point closest to the base, p' + m'D,
// has an error of 3un along the ray and of 2un across it; these errors shift X. All later quantities have at most the
// size S = |start| + |t|. Errors of the quadratic's coefficients are equivalent to an error of its value
// Q(t) = |side + t dside|^2 - (r0 + k z)^2, of at most e = 32u (S^2 + (r0 + |k| S)^2) in total. Flushing changes the
// discriminant by d <= 2f, and therefore Q by d / a at the zero t = q / a and by d c / q^2 at the zero t = c / q, where
// q = -(b +- w). As the discriminant is > 0, |q| >= w >= sqrt(f), so Q changes by at most 2 sqrt(f) S. Hence the
// distance of X from the axis is at most sqrt((r0 + k z)^2 + e), with 0 <= z <= h up to 8uS. This bounds S in turn,
// because start and D are perpendicular up to (s + 6u) n. For a steep cone in a format with few fraction bits, no
// finite S satisfies the bound.
//
// A sphere's bound is at most (s + 8u) n + r (s + 7u) / 2 with n <= t' (1 + s) + 2r, and a polygon's margins are 48u
// times the distance to its farthest corner. So box() leaves out what is proportional to t', and the traversal of the
// BVH adds it for each ray, with the ray's own s.
#include "host/accel/hit_regions.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace raya {
namespace {

Vec3 absolute(const Vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

void widen(Box& box, double margin) {
    box.min -= Vec3(margin);
    box.max += Vec3(margin);
}

// Squared distance from a point to the farthest point of a box.
double farthest_square(const Vec3& p, const Box& box) {
    Vec3 distance;
    for (int axis = 0; axis < 3; ++axis) distance[axis] = std::max(p[axis] - box.min[axis], box.max[axis] - p[axis]);
    return distance.length2();
}

// Distance from the point p to a segment.
double segment_distance(const Vec3& p, const Vec3& start, const Vec3& segment) {
    const double square = segment.length2();
    const double fraction = square > 0 ? std::clamp((p - start).dot(segment) / square, 0.0, 1.0) : 0;
    return (p - start - fraction * segment).length();
}

constexpr int kMinFractionBits = 10;  // minimum Y for which the constants cover terms of higher order in u

}  // namespace

bool HitRegion::touches(const Box& other_box) const {
    if (!box.intersects(other_box)) return false;
    if (outer_radius < kUnbounded && ((centre - other_box.nearest(centre)).length2() > outer_radius * outer_radius ||
                                      farthest_square(centre, other_box) < inner_radius * inner_radius))
        return false;
    const Vec3 box_centre = 0.5 * (other_box.min + other_box.max), half_sides = 0.5 * (other_box.max - other_box.min);
    if (half_thickness < kUnbounded &&
        std::abs(normal.dot(box_centre) - plane_distance) > half_thickness + absolute(normal).dot(half_sides))
        return false;
    return capsule_radius == kUnbounded ||
           segment_distance(box_centre, centre, segment) <= capsule_radius + half_sides.length();
}

HitRegions::HitRegions(const PackedJob& job, const NumberFormat& format, double reach,
                       const std::vector<std::uint32_t>& separate)
    : words_(&job.words()), objects_(job.header().objects) {
    const std::uint32_t end = raya_first_object(objects_, RAYA_OBJECT_KINDS);
    numbers_.reserve(end - objects_.planes);
    for (std::uint32_t number = 0; number < end; ++number)
        if (kind_of_object(objects_, number) != RAYA_PLANE &&
            !std::binary_search(separate.begin(), separate.end(), number))
            numbers_.push_back(number);
    const int quarter_range = 1 << (format.exponent_bits - 2);  // a quarter of the number of exponents
    unit_ = std::ldexp(format.truncates ? 1.0 : 0.5, -format.fraction_bits) + 0x1p-24;
    smallest_ = smallest_number(format);
    stretch_ = std::ldexp(format.is_fp32() ? 32.0 : 16.0, -format.fraction_bits) +
               0x1p-21;  // RAYA_STRETCH, and the rounding of |D|^2 - 1 in is_wide()
    far_ = farthest_hit(format);
    square_limit_ = std::ldexp(1.0, quarter_range - 1);
    extent_ = job.header().extent;
    reach_ = reach * extent_;
    all_bounded_ = format.fraction_bits >= kMinFractionBits && reach_ <= square_limit_ && cones_bounded();
    if (!all_bounded_) reach_ = far_;
    is_fp32_ = format.is_fp32();
}

double HitRegions::slack(double reach) const {
    return (24 * unit_ + 1.5 * stretch_) * std::sqrt(3.0) * (reach + 1) * extent_;
}

double HitRegions::real(std::size_t at) const { return std::bit_cast<float>((*words_)[at]); }
Vec3 HitRegions::vector(std::size_t at) const { return {real(at), real(at + 1), real(at + 2)}; }

double HitRegions::max_distance(const Vec3& point) const { return std::sqrt(3.0) * reach_ + point.length(); }

HitRegion HitRegions::region(std::size_t i) const {
    const std::size_t at = object_at(objects_, numbers_[i]);
#define RAYA_REGION(kind, kinds, KIND) \
    case RAYA_##KIND:                  \
        return kind(at);
    switch (kind_of_object(objects_, numbers_[i])) {
        RAYA_SHAPE_LIST(RAYA_REGION)
        default:
            return sphere(at);
    }
}

Box HitRegions::box(std::size_t i) const {
    const std::size_t at = object_at(objects_, numbers_[i]);
    const std::uint32_t kind = kind_of_object(objects_, numbers_[i]);
    if (kind == RAYA_POLYGON) {
        double farthest_corner = 0;
        Box box = corner_box(at, farthest_corner);
        widen(box, polygon_margin(is_fp32_ ? farthest_corner : 1.1 * box.size().length()));
        return box;
    }
    if (is_fp32_ || kind != RAYA_SPHERE) return region(i).box;
    const double radius = std::sqrt(std::abs(real(at + RAYA_SPHERE_SQUARE)));
    Box box{vector(at + RAYA_SPHERE_CENTRE), vector(at + RAYA_SPHERE_CENTRE)};
    widen(box, radius * (1 + 3 * (spread(kind) + 1.1 * stretch_)) + 4 * std::sqrt(smallest_));
    return box;
}

// Returns the bounding box of a polygon's corners. Sets the maximum distance of a corner from a ray's origin.
Box HitRegions::corner_box(std::size_t at, double& farthest_corner) const {
    Box box;
    double farthest_square = 0;
    std::size_t corner = (*words_)[at + RAYA_POLYGON_CORNERS_AT];
    for (std::size_t n = (*words_)[at + RAYA_POLYGON_CORNERS]; n > 0; --n, corner += RAYA_CORNER_WORDS) {
        box.extend(vector(corner));
        farthest_square = std::max(farthest_square, vector(corner).length2());
    }
    farthest_corner = std::sqrt(3.0) * reach_ + std::sqrt(farthest_square);
    return box;
}

// The error along a polygon's plane, at a distance.
double HitRegions::in_plane(double distance) const { return 16 * unit_ * distance + 8 * std::sqrt(smallest_); }
// Covers the kernel's margin, too: RAYA_MARGIN is 16 or 8 times u.
double HitRegions::polygon_margin(double distance) const { return 32 * unit_ * distance + in_plane(distance); }

HitRegion HitRegions::sphere(std::size_t at) const {
    HitRegion region;
    region.centre = vector(at + RAYA_SPHERE_CENTRE);
    const double radius = std::sqrt(std::abs(real(at + RAYA_SPHERE_SQUARE)));
    const double slack =
        (24 * unit_ + 1.5 * stretch_) * (max_distance(region.centre) + radius) + 4 * std::sqrt(smallest_);
    region.outer_radius = radius + slack;
    region.inner_radius = std::max(0.0, radius - slack);
    region.box = {region.centre, region.centre};
    widen(region.box, region.outer_radius);
    return region;
}

HitRegion HitRegions::polygon(std::size_t at) const {
    HitRegion region;
    region.normal = vector(at + RAYA_PLANE_NORMAL);
    region.plane_distance = real(at + RAYA_PLANE_DISTANCE);
    double off_plane = 0, farthest_corner = 0;  // maximum distance of a corner: from the plane; from a ray's origin
    region.box = corner_box(at, farthest_corner);
    std::size_t corner = (*words_)[at + RAYA_POLYGON_CORNERS_AT];
    for (std::size_t i = (*words_)[at + RAYA_POLYGON_CORNERS]; i > 0; --i, corner += RAYA_CORNER_WORDS)
        off_plane = std::max(off_plane, std::abs(region.normal.dot(vector(corner)) - region.plane_distance));
    const double plane_and_origin = std::abs(region.plane_distance) + std::sqrt(3.0) * reach_;
    widen(region.box, polygon_margin(farthest_corner));
    region.half_thickness = 5 * unit_ * (plane_and_origin + 2 * farthest_corner) +
                            4 * smallest_ * (1 + farthest_corner) + in_plane(farthest_corner) + off_plane;
    return region;
}

// The error e of Q(t) (see the top of this file), for a cone with S = `size`.
double HitRegions::cone_error(std::size_t at, double size) const {
    const double radius = real(at + RAYA_CONE_RADIUS), slope = std::abs(real(at + RAYA_CONE_SLOPE));
    const double square = size * size, max_radius = radius + slope * size;
    return 32 * unit_ * (square + max_radius * max_radius) + 4 * std::sqrt(smallest_) * size +
           16 * smallest_ * (1 + square) * (1 + slope * slope);
}

// The bound S (see the top of this file), by fixed-point iteration; infinite if the iteration diverges.
double HitRegions::cone_size(std::size_t at) const {
    const double r0 = real(at + RAYA_CONE_RADIUS), height = real(at + RAYA_CONE_HEIGHT);
    const double slope = real(at + RAYA_CONE_SLOPE), r1 = std::abs(r0 + slope * height);
    const double exact_square = height * height + std::max(r0, r1) * std::max(r0, r1);
    const double skew = 2 * (6 * unit_ + stretch_) * max_distance(vector(at + RAYA_CONE_BASE));
    double size = 0;
    constexpr int kMaxIterations = 60;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        const double next = std::sqrt(2.1 * (exact_square + cone_error(at, size))) + skew;
        if (next <= size * 1.001) return next * 1.01;
        size = next;
    }
    return HitRegion::kUnbounded;
}

bool HitRegions::cones_bounded() const {
    for (std::size_t i = 0; i < objects_.cones; ++i) {
        const std::size_t at = objects_.cones_at + i * RAYA_CONE_WORDS;
        const double slope_factor = 1 + std::abs(real(at + RAYA_CONE_SLOPE));
        // No square in the kernel may saturate.
        const double largest =
            (max_distance(vector(at + RAYA_CONE_BASE)) * slope_factor + real(at + RAYA_CONE_RADIUS)) * slope_factor;
        if (largest > square_limit_ || cone_size(at) == HitRegion::kUnbounded) return false;
    }
    return true;
}

HitRegion HitRegions::cone(std::size_t at) const {
    HitRegion region;
    const double height = real(at + RAYA_CONE_HEIGHT), slope = real(at + RAYA_CONE_SLOPE);
    const double r0 = real(at + RAYA_CONE_RADIUS), r1 = std::abs(r0 + slope * height);
    const double size = cone_size(at), error = cone_error(at, size);
    const double z_error = 8 * unit_ * size;  // error of the position z along the axis, at z = 0 and z = h
    const double shift = 6 * unit_ * max_distance(vector(at + RAYA_CONE_BASE)) + 12 * unit_ * size + 8 * smallest_;
    const Vec3 axis = vector(at + RAYA_CONE_AXIS).normalized();
    region.centre = vector(at + RAYA_CONE_BASE);
    region.segment = height * axis;
    double max_end_radius = 0;
    for (const auto& [z, radius] : {std::pair{-z_error, r0}, std::pair{height + z_error, r1}}) {
        const double end_radius = radius + std::abs(slope) * z_error;
        const double outer_end_radius = std::sqrt(end_radius * end_radius + error);
        max_end_radius = std::max(max_end_radius, outer_end_radius);
        extend_by_disk(region.box, region.centre + z * axis, outer_end_radius, axis);
    }
    widen(region.box, shift);
    region.capsule_radius = max_end_radius + z_error + shift;
    region.normal = axis;
    region.plane_distance = axis.dot(region.centre) + 0.5 * height;
    region.half_thickness = 0.5 * height + z_error + shift;
    return region;
}

double reach_for(const PackedJob& job, const NumberFormat& format,
                 const std::function<double(const HitRegions&)>& max_slack,
                 const std::vector<std::uint32_t>& separate) {
    constexpr double kMin = 2, kMax = 1024;
    const HitRegions regions(job, format, kMin, separate);
    if (!regions.all_bounded() || job.header().objects.planes == 0) return kMin;
    const double limit = max_slack(regions);
    double reach = kMin;
    while (reach < kMax && regions.slack(2 * reach) <= limit &&
           HitRegions(job, format, 2 * reach, separate).all_bounded())
        reach *= 2;
    return reach;
}

}  // namespace raya
