#include "host/accel/tree_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/accel/hit_regions.hpp"
#include "host/accel/tree.hpp"
#include "host/error.hpp"
#include "host/scene/word_records.hpp"

namespace raya {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kWidth = RAYA_BVH_WIDTH;

// How far from a side of its box a ray can be by the walk's rounding. t of a side is side / D - O / D in two
// operations, with 1 / D rounded: off by 4 2^-24 (|side| + |O|) / |D|.
double walk_error(double side, double reach) { return 8 * 0x1p-24 * (std::abs(side) + reach); }

float below(double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -kInfinity) : nearest;
}
float above(double x) { return -below(-x); }

Bounds bounds_of(const Box& box, double reach) {
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        bounds.low[a] = below(box.min[axis] - walk_error(box.min[axis], reach));
        bounds.high[a] = above(box.max[axis] + walk_error(box.max[axis], reach));
    }
    return bounds;
}

// How far rays may come from: with infinite planes, on which rays start anywhere, farther as long as boxes of usual
// size grow by little.
double reach_for(const PackedJob& job, const NumberFormat& format) {
    constexpr double kLeast = 2, kMost = 1024, kShareOfBox = 1.0 / 64;
    const HitRegions regions(job, format, kLeast);
    if (!regions.known() || regions.size() == 0 || job.header().objects.planes == 0) return kLeast;
    double sides = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Vec3 size = regions.region(i).box.size();
        sides += std::max({size.x, size.y, size.z});
    }
    const double usual = sides / static_cast<double>(regions.size());
    double reach = kLeast;
    while (reach < kMost && regions.slack(2 * reach) <= kShareOfBox * usual &&
           HitRegions(job, format, 2 * reach).known())
        reach *= 2;
    return reach;
}

const std::uint32_t* polygon_words(const PackedJob& job, std::uint32_t number) {
    const raya_objects& objects = job.header().objects;
    const std::size_t polygon = number - objects.spheres - objects.planes;
    return job.words().data() + objects.polygons_at + polygon * RAYA_POLYGON_WORDS;
}

std::uint32_t kind_of(const PackedJob& job, std::uint32_t number) {
    const raya_objects& objects = job.header().objects;
    if (number < objects.spheres) return RAYA_LINK_SPHERES;
    if (number >= objects.spheres + objects.planes + objects.polygons) return RAYA_LINK_CONES;
    const bool is_face = polygon_words(job, number)[RAYA_POLYGON_CORNERS] <= RAYA_BVH_MOST_CORNERS;
    return is_face ? RAYA_LINK_FACES : RAYA_LINK_POLYGONS;
}

std::uint32_t rows_of(std::uint32_t kind) {
    if (kind == RAYA_LINK_SPHERES) return RAYA_BVH_SPHERES;
    return kind == RAYA_LINK_FACES ? RAYA_BVH_FACES : 1;
}

// Lays a tree out row by row: a node, what its children hold, and so on.
class TreeWriter {
  public:
    TreeWriter(const Tree& tree, const PackedJob& job) : tree_(tree), job_(job) {}

    std::uint32_t put(const TreeChild& child) {
        if (child.kind == RAYA_LINK_NODE) return put_node(tree_.nodes[child.first]);
        const std::uint32_t row = take_rows(rows_of(child.kind));
        ++leaves_;
        for (std::uint32_t column = 0; column < kWidth; ++column) {
            const std::uint32_t i = child.first + (column < child.items ? column : 0);
            put_object(row, column, child.kind, tree_.items[i].number);
        }
        return raya_link(child.kind, child.items, row);
    }

    const std::vector<std::uint32_t>& words() const { return words_; }
    std::uint64_t leaves() const { return leaves_; }

  private:
    std::uint32_t take_rows(std::uint32_t rows) {
        const auto row = static_cast<std::uint32_t>(words_.size() / kWidth);
        words_.resize(words_.size() + std::size_t{rows} * kWidth);
        return row;
    }

    std::uint32_t& word(std::uint32_t row, std::uint32_t column) { return words_[std::size_t{row} * kWidth + column]; }

    std::uint32_t put_node(const TreeNode& node) {
        const std::uint32_t row = take_rows(RAYA_BVH_NODE);
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

    void put_object(std::uint32_t row, std::uint32_t column, std::uint32_t kind, std::uint32_t number) {
        word(row + rows_of(kind) - 1, column) = number;  // in the last row
        if (kind == RAYA_LINK_SPHERES) {
            const std::size_t sphere = job_.header().objects.spheres_at + std::size_t{number} * RAYA_SPHERE_WORDS;
            for (std::uint32_t w = 0; w < RAYA_BVH_NUMBERS; ++w) word(row + w, column) = job_.words()[sphere + w];
        }
        if (kind == RAYA_LINK_FACES) put_face(row, column, polygon_words(job_, number));
    }

    void put_face(std::uint32_t row, std::uint32_t column, const std::uint32_t* polygon) {
        const std::uint32_t* corners = job_.words().data() + polygon[RAYA_POLYGON_CORNERS_AT];
        const std::uint32_t last = polygon[RAYA_POLYGON_CORNERS] - 1;
        for (std::uint32_t i = 0; i < RAYA_BVH_MOST_CORNERS; ++i)
            for (std::uint32_t axis = 0; axis < 3; ++axis)
                word(row + RAYA_BVH_CORNERS + 3 * i + axis, column) =
                    corners[std::min(i, last) * RAYA_CORNER_WORDS + axis];
        for (std::uint32_t w = 0; w < 4; ++w) word(row + RAYA_BVH_PLANE + w, column) = polygon[RAYA_PLANE_NORMAL + w];
    }

    const Tree& tree_;
    const PackedJob& job_;
    std::vector<std::uint32_t> words_;
    std::uint64_t leaves_ = 0;
};

struct TreeItems {
    std::vector<TreeItem> items;  // none where no boxes are known that hold all hits
    double reach = -1;            // largest coordinate of the origins of rays that they are good for
};

TreeItems tree_items(const PackedJob& job, const NumberFormat& format) {
    const HitRegions regions(job, format, reach_for(job, format));
    TreeItems all;
    if (!regions.known()) return all;
    all.reach = regions.reach();
    all.items.reserve(regions.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const std::uint32_t number = regions.number(i);
        all.items.push_back({bounds_of(regions.region(i).box, all.reach), number, kind_of(job, number)});
    }
    return all;
}

}  // namespace

AccelSummary append_tree(PackedJob& job, const NumberFormat& format) {
    TreeItems items = tree_items(job, format);
    const Tree tree = build_tree(std::move(items.items));
    TreeWriter writer(tree, job);
    raya_bvh header{};
    header.reach = static_cast<float>(items.reach);
    header.root = tree.items.empty() ? RAYA_NO_LINK : writer.put(tree.root);
    const std::size_t end = job.words().size();
    const std::size_t rows_at = (end + kWordsOf<raya_bvh> + kWidth - 1) / kWidth * kWidth;
    if (writer.words().size() / kWidth > RAYA_LINK_ROW)
        throw UserError(fmt::format("--accel bvh packs to {} rows of 64 bytes, more than its links reach",
                                    writer.words().size() / kWidth));
    header.rows_at = static_cast<std::uint32_t>(rows_at);
    std::vector<std::uint32_t> words(rows_at - end);
    put_record(words, 0, header);
    words.insert(words.end(), writer.words().begin(), writer.words().end());
    job.append(words);
    raya_job with_tree = job.header();
    with_tree.accel_at = static_cast<std::uint32_t>(end);
    job.set_header(with_tree);
    return {.kind = AccelKind::kBvh,
            .words = words.size(),
            .nodes = tree.nodes.size(),
            .leaves = writer.leaves(),
            .depth = tree.depth};
}

}  // namespace raya
