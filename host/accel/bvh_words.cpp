#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "host/accel/bvh.hpp"
#include "host/accel/hit_regions.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kWidth = RAYA_BVH_WIDTH;

// Upper bound of the traversal's rounding error in the position of a box side, for ray origins with coordinates up to
// `reach`. Along each axis the kernel computes the distance t to a side as side * (1 / D) - O * (1 / D), with rounded
// results, so t has an error of at most 4 2^-24 (|side| + |O|) / |D|. The bound has a margin of a factor of 2.
double traversal_error(double side, double reach) { return 8 * 0x1p-24 * (std::abs(side) + reach); }

// below() and above() return x rounded to a float that is at most, or at least, x.
float below(double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -kInfinity) : nearest;
}
float above(double x) { return -below(-x); }

Bounds bounds_of(const Box& box, double reach) {
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        bounds.low[a] = below(box.min[axis] - traversal_error(box.min[axis], reach));
        bounds.high[a] = above(box.max[axis] + traversal_error(box.max[axis], reach));
    }
    return bounds;
}

// Chooses the reach: the maximum coordinate of ray origins for which the boxes are valid, in multiples of the scene's
// extent. Reflected rays can start anywhere on an infinite plane, so a scene with planes gets a larger reach: it is
// doubled up to kMax as long as regions stay bounded and grow by at most kFractionOfBox of their mean longest side.
double reach_for(const PackedJob& job, const NumberFormat& format) {
    constexpr double kMin = 2, kMax = 1024, kFractionOfBox = 1.0 / 64;
    const HitRegions regions(job, format, kMin);
    if (!regions.all_bounded() || regions.size() == 0 || job.header().objects.planes == 0) return kMin;
    double sides = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Vec3 size = regions.region(i).box.size();
        sides += std::max({size.x, size.y, size.z});
    }
    const double mean_side = sides / static_cast<double>(regions.size());
    double reach = kMin;
    while (reach < kMax && regions.slack(2 * reach) <= kFractionOfBox * mean_side &&
           HitRegions(job, format, 2 * reach).all_bounded())
        reach *= 2;
    return reach;
}

const std::uint32_t* polygon_words(const PackedJob& job, std::uint32_t number) {
    const raya_objects& objects = job.header().objects;
    const std::size_t polygon = number - objects.spheres - objects.planes;
    return job.words().data() + objects.polygons_at + polygon * RAYA_POLYGON_WORDS;
}

// Returns the kind of leaf (RAYA_LINK_*) in which an object is stored.
std::uint32_t kind_of(const PackedJob& job, const NumberFormat& format, std::uint32_t number) {
    // In a reduced format, polygons with more corners are stored in leaves for one polygon.
    constexpr std::uint32_t kMaxObjectCorners = 16;
    const raya_objects& objects = job.header().objects;
    const bool is_polygon = number >= objects.spheres && number < objects.spheres + objects.planes + objects.polygons;
    const std::uint32_t corners = is_polygon ? polygon_words(job, number)[RAYA_POLYGON_CORNERS] : 0;
    if (!format.is_fp32()) return corners > kMaxObjectCorners ? RAYA_LINK_POLYGON : RAYA_LINK_OBJECT;
    if (is_polygon) return corners <= RAYA_BVH_MAX_CORNERS ? RAYA_LINK_FACES : RAYA_LINK_POLYGON;
    return number < objects.spheres ? RAYA_LINK_SPHERES : RAYA_LINK_CONES;
}

// Writes the rows of a BVH in depth-first order: a node is followed by the rows of its children.
class BvhWriter {
  public:
    BvhWriter(const Bvh& tree, const PackedJob& job) : tree_(tree), job_(job) {}

    std::uint32_t put(const BvhChild& child) {
        if (child.kind == RAYA_LINK_NODE) return put_node(tree_.nodes[child.first]);
        ++leaves_;
        const std::span items(tree_.items.data() + child.first, child.items);
        switch (child.kind) {
            case RAYA_LINK_OBJECT:
                return raya_link_to_object(items[0].number);
            case RAYA_LINK_POLYGON:
                return put_outline(items[0].number);
            case RAYA_LINK_FACES:
                return put_faces(items);
            case RAYA_LINK_CONES:
                return put_cones(items);
            default:
                return put_spheres(items);
        }
    }

    const std::vector<std::uint32_t>& words() const { return words_; }
    std::uint64_t leaves() const { return leaves_; }

  private:
    std::uint32_t append_rows(std::uint32_t rows) {
        const auto row = static_cast<std::uint32_t>(words_.size() / kWidth);
        words_.resize(words_.size() + std::size_t{rows} * kWidth);
        return row;
    }

    std::uint32_t& word(std::uint32_t row, std::uint32_t column) { return words_[std::size_t{row} * kWidth + column]; }

    std::uint32_t put_node(const BvhNode& node) {
        const std::uint32_t row = append_rows(RAYA_BVH_NODE);
        for (std::uint32_t column = 0; column < kWidth; ++column) {
            const bool used = column < node.count;
            for (std::uint32_t axis = 0; axis < 3; ++axis) {
                const Bounds& box = node.children[column].box;
                word(row + RAYA_BVH_LOW + axis, column) =
                    std::bit_cast<std::uint32_t>(used ? box.low[axis] : kInfinity);
                word(row + RAYA_BVH_HIGH + axis, column) =
                    std::bit_cast<std::uint32_t>(used ? box.high[axis] : -kInfinity);
            }
            if (!used) continue;
            const std::uint32_t link = put(node.children[column]);
            word(row + RAYA_BVH_LINKS, column) = link;
        }
        return raya_link(RAYA_LINK_NODE, 1, row);
    }

    // Calls put(column, object number) for each column of a leaf. Unused columns repeat the first item.
    template <class Put>
    static void for_columns(std::span<const BvhItem> items, const Put& put) {
        for (std::uint32_t column = 0; column < kWidth; ++column)
            put(column, items[column < items.size() ? column : 0].number);
    }

    // Copies `count` words into a column, one word in each row from `row` on.
    void put_column(std::uint32_t row, std::uint32_t column, const std::uint32_t* words, std::uint32_t count) {
        for (std::uint32_t w = 0; w < count; ++w) word(row + w, column) = words[w];
    }

    std::uint32_t put_spheres(std::span<const BvhItem> items) {
        const std::uint32_t row = append_rows(RAYA_BVH_SPHERES);
        for_columns(items, [&](std::uint32_t column, std::uint32_t number) {
            const std::size_t sphere_at = job_.header().objects.spheres_at + std::size_t{number} * RAYA_SPHERE_WORDS;
            put_column(row, column, job_.words().data() + sphere_at, RAYA_BVH_NUMBERS);
            word(row + RAYA_BVH_NUMBERS, column) = number;
        });
        return raya_link(RAYA_LINK_SPHERES, static_cast<std::uint32_t>(items.size()), row);
    }

    std::uint32_t put_faces(std::span<const BvhItem> items) {
        const bool triangles = std::all_of(items.begin(), items.end(), [&](const BvhItem& item) {
            return polygon_words(job_, item.number)[RAYA_POLYGON_CORNERS] < RAYA_BVH_MAX_CORNERS;
        });
        const std::uint32_t row = append_rows(triangles ? RAYA_BVH_TRIANGLES : RAYA_BVH_FACES);
        for_columns(items, [&](std::uint32_t column, std::uint32_t number) {
            const std::uint32_t* polygon = polygon_words(job_, number);
            const std::uint32_t last = polygon[RAYA_POLYGON_CORNERS] - 1;
            for (std::uint32_t i = 0; i < 3; ++i)
                put_column(row + RAYA_BVH_CORNERS + 3 * i, column, corner(polygon, std::min(i, last)), 3);
            put_column(row + RAYA_BVH_PLANE, column, polygon + RAYA_PLANE_NORMAL, 4);
            word(row + RAYA_BVH_FACE_NUMBERS, column) = number;
            if (!triangles) put_column(row + RAYA_BVH_FOURTH, column, corner(polygon, last), 3);
        });
        return raya_link(triangles ? RAYA_LINK_TRIANGLES : RAYA_LINK_FACES, static_cast<std::uint32_t>(items.size()),
                         row);
    }

    std::uint32_t put_outline(std::uint32_t number) {
        const std::uint32_t* polygon = polygon_words(job_, number);
        const std::uint32_t corners = polygon[RAYA_POLYGON_CORNERS], rows = raya_outline_rows(corners);
        const std::uint32_t row = append_rows(1 + 3 * rows);
        word(row, RAYA_BVH_OUTLINE_NUMBER) = number;
        word(row, RAYA_BVH_OUTLINE_CORNERS) = corners;
        for (std::uint32_t w = 0; w < 4; ++w) word(row, RAYA_BVH_OUTLINE_PLANE + w) = polygon[RAYA_PLANE_NORMAL + w];
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            float low = kInfinity, high = -kInfinity;
            for (std::uint32_t i = 0; i < rows * kWidth; ++i) {
                const std::uint32_t coordinate = corner(polygon, i < corners ? i : 0)[axis];
                low = std::min(low, std::bit_cast<float>(coordinate));
                high = std::max(high, std::bit_cast<float>(coordinate));
                word(row + 1 + axis * rows, i) = coordinate;
            }
            word(row, RAYA_BVH_OUTLINE_LOW + axis) = std::bit_cast<std::uint32_t>(low);
            word(row, RAYA_BVH_OUTLINE_HIGH + axis) = std::bit_cast<std::uint32_t>(high);
        }
        return raya_link(RAYA_LINK_POLYGON, 1, row);
    }

    std::uint32_t put_cones(std::span<const BvhItem> items) {
        const std::uint32_t row = append_rows(RAYA_BVH_CONES);
        const raya_objects& objects = job_.header().objects;
        const std::uint32_t first_cone = objects.spheres + objects.planes + objects.polygons;
        for_columns(items, [&](std::uint32_t column, std::uint32_t number) {
            const std::size_t cone_at = objects.cones_at + std::size_t{number - first_cone} * RAYA_CONE_WORDS;
            const std::uint32_t* cone = job_.words().data() + cone_at;
            put_column(row + RAYA_BVH_BASE, column, cone + RAYA_CONE_BASE, 3);
            word(row + RAYA_BVH_RADIUS, column) = cone[RAYA_CONE_RADIUS];
            put_column(row + RAYA_BVH_AXIS, column, cone + RAYA_CONE_AXIS, 3);
            word(row + RAYA_BVH_HEIGHT, column) = cone[RAYA_CONE_HEIGHT];
            word(row + RAYA_BVH_SLOPE, column) = cone[RAYA_CONE_SLOPE];
            word(row + RAYA_BVH_INSIDE, column) = cone[RAYA_CONE_INSIDE];
            word(row + RAYA_BVH_CONE_NUMBERS, column) = number;
        });
        return raya_link(RAYA_LINK_CONES, static_cast<std::uint32_t>(items.size()), row);
    }

    const std::uint32_t* corner(const std::uint32_t* polygon, std::uint32_t i) const {
        return job_.words().data() + polygon[RAYA_POLYGON_CORNERS_AT] + std::size_t{i} * RAYA_CORNER_WORDS;
    }

    const Bvh& tree_;
    const PackedJob& job_;
    std::vector<std::uint32_t> words_;
    std::uint64_t leaves_ = 0;
};

// The objects of a job, for a BVH.
struct BvhItems {
    std::vector<BvhItem> items;           // empty if the hit regions are unbounded
    std::vector<std::uint32_t> separate;  // numbers of the separate objects, ascending
    double reach = -1;  // maximum coordinate of ray origins for which the boxes are valid; -1: no boxes
};

// Large objects (the ground below a scene, walls around it) are listed separately. Nearly every ray reaches them, and
// testing such an object for V rays at once takes less time per ray than visiting a leaf. If there are more than
// kMaxSeparate large objects, none is listed separately.
constexpr std::size_t kMaxSeparate = 8;
// An object is large if the area of its box is more than this fraction of the area of the whole scene's box.
constexpr float kLargeArea = 1.0F / 8;

void separate_large_items(BvhItems& objects) {
    Bounds whole = kEmptyBounds;
    for (const BvhItem& item : objects.items) extend(whole, item.box);
    const auto is_large = [&](const BvhItem& item) { return half_area(item.box) > kLargeArea * half_area(whole); };
    const auto large = static_cast<std::size_t>(std::count_if(objects.items.begin(), objects.items.end(), is_large));
    if (large > kMaxSeparate) return;
    for (const BvhItem& item : objects.items)
        if (is_large(item)) objects.separate.push_back(item.number);
    std::erase_if(objects.items, is_large);
}

BvhItems bvh_items(const PackedJob& job, const NumberFormat& format) {
    BvhItems objects;
    const HitRegions regions(job, format, reach_for(job, format));
    if (!regions.all_bounded()) return objects;
    objects.reach = regions.reach();
    objects.items.reserve(regions.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const std::uint32_t number = regions.number(i);
        objects.items.push_back(
            {bounds_of(regions.region(i).box, objects.reach), number, kind_of(job, format, number)});
    }
    separate_large_items(objects);
    return objects;
}

}  // namespace

bool bvh_pays(const Scene& scene, const NumberFormat& format) {
    constexpr double kMinCost = 160;  // minimum cost of testing a ray against all objects, in sphere tests
    double corners = 0;
    for (const Polygon& polygon : scene.polygons) corners += static_cast<double>(polygon.vertices.size());
    const auto spheres = static_cast<double>(scene.spheres.size()), cones = static_cast<double>(scene.cones.size());
    return kMinCost < (format.is_fp32() ? spheres + 1.25 * corners + 8 * cones : spheres + 3 * corners + 32 * cones);
}

AccelSummary append_bvh(PackedJob& job, const NumberFormat& format) {
    BvhItems objects = bvh_items(job, format);
    const Bvh tree = build_bvh(std::move(objects.items));
    BvhWriter writer(tree, job);
    raya_bvh header{};
    header.reach = static_cast<float>(objects.reach);
    header.root = tree.items.empty() ? RAYA_NO_TREE : writer.put(tree.root);
    const std::size_t bvh_at = job.words().size(), end = bvh_at + kWordsOf<raya_bvh> + objects.separate.size();
    const std::size_t rows_at = (end + kWidth - 1) / kWidth * kWidth;
    if (writer.words().size() / kWidth > RAYA_LINK_ROW)
        throw UserError(fmt::format(
            "--accel bvh: the BVH needs {} rows of 64 bytes, more than its links can address; use fewer objects",
            writer.words().size() / kWidth));
    header.separate = static_cast<std::uint32_t>(objects.separate.size());
    header.separate_at = static_cast<std::uint32_t>(bvh_at + kWordsOf<raya_bvh>);
    header.rows_at = static_cast<std::uint32_t>(rows_at);
    std::vector<std::uint32_t> words(rows_at - bvh_at);
    put_record(words, 0, header);
    std::copy(objects.separate.begin(), objects.separate.end(), words.begin() + kWordsOf<raya_bvh>);
    job.append(words, writer.words());
    raya_job new_header = job.header();
    new_header.accel_at = static_cast<std::uint32_t>(bvh_at);
    job.set_header(new_header);
    return {.kind = AccelKind::kBvh,
            .words = words.size() + writer.words().size(),
            .separate = header.separate,
            .nodes = tree.nodes.size(),
            .leaves = writer.leaves(),
            .depth = tree.depth};
}

}  // namespace raya
