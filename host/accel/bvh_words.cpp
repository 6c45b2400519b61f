#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <span>

#include "host/accel/bvh.hpp"
#include "host/base/parallel.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kWidth = RAYA_BVH_WIDTH;
constexpr std::size_t kMinNodes = 64;  // of a thread

// Writes the rows of a BVH in depth-first order: a node is followed by the rows of its children.
class BvhWriter {
  public:
    BvhWriter(const Bvh& tree, const PackedJob& job, unsigned threads)
        : tree_(tree), job_(job), threads_(threads), rows_(tree.nodes.size()) {
        parallel_for_items(tree.nodes.size(), threads, kMinNodes, [&](std::size_t node) {
            for (std::uint32_t c = 0; c < tree_.nodes[node].count; ++c)
                rows_[node][c] = rows_of_leaf(tree_.nodes[node].children[c]);
        });
        for (std::size_t node = rows_.size(); node-- > 0;)
            for (std::uint32_t c = 0; c < tree_.nodes[node].count; ++c)
                if (const BvhChild& child = tree_.nodes[node].children[c]; child.kind == RAYA_LINK_NODE)
                    rows_[node][c] = rows_of_node(child.first);
    }

    /// Number of rows of the whole BVH.
    std::uint64_t rows() const { return is_node(tree_.root) ? rows_of_node(0) : rows_of_leaf(tree_.root); }

    std::uint64_t leaves() const {
        std::uint64_t leaves = is_node(tree_.root) ? 0 : 1;
        for (const BvhNode& node : tree_.nodes)
            for (std::uint32_t c = 0; c < node.count; ++c) leaves += !is_node(node.children[c]);
        return leaves;
    }

    /// Writes all rows to `words`, which are 0, and returns the link to the root.
    std::uint32_t write(std::span<std::uint32_t> words) {
        words_ = words;
        if (!is_node(tree_.root)) return write_leaf(tree_.root, 0);
        std::vector<std::uint32_t> first_rows(tree_.nodes.size());  // of each node
        for (std::size_t node = 0; node < tree_.nodes.size(); ++node)
            for_children(node, first_rows[node], [&](const BvhChild& child, std::uint32_t, std::uint32_t row) {
                if (is_node(child)) first_rows[child.first] = row;
            });
        parallel_for_items(tree_.nodes.size(), threads_, kMinNodes,
                           [&](std::size_t node) { write_node(node, first_rows[node]); });
        return raya_link(RAYA_LINK_NODE, 1, 0);
    }

  private:
    static bool is_node(const BvhChild& child) { return child.kind == RAYA_LINK_NODE; }

    /// Calls work(child, column, first row of the child) for each child of the node whose first row is `row`.
    template <class Work>
    void for_children(std::size_t node, std::uint32_t row, const Work& work) const {
        row += RAYA_BVH_NODE;
        for (std::uint32_t column = 0; column < tree_.nodes[node].count; ++column) {
            work(tree_.nodes[node].children[column], column, row);
            row += static_cast<std::uint32_t>(rows_[node][column]);
        }
    }

    std::uint64_t rows_of_node(std::size_t node) const {
        return std::accumulate(rows_[node].begin(), rows_[node].end(), std::uint64_t{RAYA_BVH_NODE});
    }

    std::span<const BvhItem> items_of(const BvhChild& leaf) const {
        return {tree_.items.data() + leaf.first, leaf.items};
    }

    bool are_triangles(std::span<const BvhItem> faces) const {
        return std::ranges::all_of(faces, [&](const BvhItem& item) {
            return job_.object(item.number)[RAYA_POLYGON_CORNERS] < RAYA_BVH_MAX_CORNERS;
        });
    }

    /// Returns the number of rows of a leaf; 0 for a node.
    std::uint32_t rows_of_leaf(const BvhChild& child) const {
        if (child.kind == RAYA_LINK_NODE || child.kind == RAYA_LINK_OBJECT) return 0;
        if (child.kind == RAYA_LINK_FACES) return are_triangles(items_of(child)) ? RAYA_BVH_TRIANGLES : RAYA_BVH_FACES;
        const std::uint32_t number = items_of(child)[0].number;
        if (child.kind == RAYA_LINK_POLYGON)
            return 1 + 3 * raya_outline_rows(job_.object(number)[RAYA_POLYGON_CORNERS]);
        return std::max<std::uint32_t>(words_of_kind(kind_of_object(job_.header().objects, number)), RAYA_OBJECT_WORDS);
    }

    std::uint32_t& word(std::uint32_t row, std::uint32_t column) { return words_[std::size_t{row} * kWidth + column]; }

    void write_node(std::size_t index, std::uint32_t row) {
        const BvhNode& node = tree_.nodes[index];
        for (std::uint32_t column = 0; column < kWidth; ++column)
            for (std::uint32_t axis = 0; axis < 3; ++axis) {
                const bool used = column < node.count;
                const Bounds& box = node.children[column].box;
                word(row + RAYA_BVH_LOW + axis, column) =
                    std::bit_cast<std::uint32_t>(used ? box.low[axis] : kInfinity);
                word(row + RAYA_BVH_HIGH + axis, column) =
                    std::bit_cast<std::uint32_t>(used ? box.high[axis] : -kInfinity);
            }
        for_children(index, row, [&](const BvhChild& child, std::uint32_t column, std::uint32_t first_row) {
            word(row + RAYA_BVH_LINKS, column) =
                is_node(child) ? raya_link(RAYA_LINK_NODE, 1, first_row) : write_leaf(child, first_row);
        });
    }

    /// Writes a leaf from `row` on and returns the link to it.
    std::uint32_t write_leaf(const BvhChild& leaf, std::uint32_t row) {
        const std::span<const BvhItem> items = items_of(leaf);
        const auto count = static_cast<std::uint32_t>(items.size());
        if (leaf.kind == RAYA_LINK_OBJECT) return raya_link_to_object(items[0].number);
        if (leaf.kind == RAYA_LINK_FACES) return raya_link(write_faces(items, row), count, row);
        if (leaf.kind == RAYA_LINK_POLYGON)
            write_outline(items[0].number, row);
        else
            write_objects(items, row, rows_of_leaf(leaf));
        return raya_link(leaf.kind, count, row);
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

    void write_objects(std::span<const BvhItem> items, std::uint32_t row, std::uint32_t rows) {
        for_columns(items, [&](std::uint32_t column, std::uint32_t number) {
            put_column(row, column, job_.object(number), rows);
            word(row + RAYA_BVH_NUMBERS, column) = number;
        });
    }

    /// Returns the kind of the leaf.
    std::uint32_t write_faces(std::span<const BvhItem> items, std::uint32_t row) {
        const bool triangles = are_triangles(items);
        for_columns(items, [&](std::uint32_t column, std::uint32_t number) {
            const std::uint32_t* polygon = job_.object(number);
            const std::uint32_t last = polygon[RAYA_POLYGON_CORNERS] - 1;
            for (std::uint32_t i = 0; i < 3; ++i)
                put_column(row + RAYA_BVH_CORNERS + 3 * i, column, corner(polygon, std::min(i, last)), 3);
            put_column(row + RAYA_BVH_PLANE, column, polygon + RAYA_PLANE_NORMAL, 4);
            word(row + RAYA_BVH_FACE_NUMBERS, column) = number;
            if (!triangles) put_column(row + RAYA_BVH_FOURTH, column, corner(polygon, last), 3);
        });
        return triangles ? RAYA_LINK_TRIANGLES : RAYA_LINK_FACES;
    }

    void write_outline(std::uint32_t number, std::uint32_t row) {
        const std::uint32_t* polygon = job_.object(number);
        const std::uint32_t corners = polygon[RAYA_POLYGON_CORNERS], rows = raya_outline_rows(corners);
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
    }

    const std::uint32_t* corner(const std::uint32_t* polygon, std::uint32_t i) const {
        return job_.words().data() + polygon[RAYA_POLYGON_CORNERS_AT] + std::size_t{i} * RAYA_CORNER_WORDS;
    }

    const Bvh& tree_;
    const PackedJob& job_;
    unsigned threads_;
    // [node][column]: number of rows of a child and of all nodes and leaves below it
    std::vector<std::array<std::uint64_t, kWidth>> rows_;
    std::span<std::uint32_t> words_;
};

}  // namespace

AccelSummary append_bvh(PackedJob& job, const NumberFormat& format, unsigned threads) {
    BvhItems objects = bvh_items(job, format, threads);
    const Bvh tree = build_bvh(std::move(objects.items), threads);
    BvhWriter writer(tree, job, threads);
    const bool is_empty = tree.items.empty();
    const std::uint64_t rows = is_empty ? 0 : writer.rows();
    if (rows > RAYA_LINK_ROW)
        throw UserError(fmt::format(
            "--accel bvh: the BVH needs {} rows of 64 bytes, more than its links can address; use fewer objects",
            rows));
    raya_bvh header{};
    const std::size_t bvh_at = job.words().size(), end = bvh_at + kWordsOf<raya_bvh> + objects.separate.size();
    const std::size_t rows_at = (end + kWidth - 1) / kWidth * kWidth;
    const std::span<std::uint32_t> words = job.append_zeros(rows_at - bvh_at + rows * kWidth);
    header.reach = static_cast<float>(objects.reach);
    header.spread = static_cast<float>(objects.spread);
    header.root = is_empty ? RAYA_NO_TREE : writer.write(words.subspan(rows_at - bvh_at));
    header.separate = static_cast<std::uint32_t>(objects.separate.size());
    header.separate_at = static_cast<std::uint32_t>(bvh_at + kWordsOf<raya_bvh>);
    header.rows_at = static_cast<std::uint32_t>(rows_at);
    put_record(words, 0, header);
    std::copy(objects.separate.begin(), objects.separate.end(), words.begin() + kWordsOf<raya_bvh>);
    raya_job new_header = job.header();
    new_header.accel_at = static_cast<std::uint32_t>(bvh_at);
    job.set_header(new_header);
    return {.kind = AccelKind::kBvh,
            .words = words.size(),
            .separate = header.separate,
            .nodes = tree.nodes.size(),
            .leaves = is_empty ? 0 : writer.leaves(),
            .depth = tree.depth};
}

}  // namespace raya
