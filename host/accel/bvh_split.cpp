#include "host/accel/bvh_split.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "host/base/parallel.hpp"

namespace raya {
namespace {

constexpr std::size_t kBins = 32;  // number of bins along each axis
// From this depth on, parts are split into equal halves, which bounds the depth of the tree.
constexpr std::uint32_t kMedianDepth = 24;
// Parts with fewer items are split on one thread, because starting threads would take longer than they save.
constexpr std::size_t kMinItemsOfThreads = 1 << 15;

using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 smaller(const Float4& a, const Float4& b) { return b < a ? b : a; }
Float4 larger(const Float4& a, const Float4& b) { return a < b ? b : a; }

void extend(Box4& box, const Box4& added) {
    box.low = smaller(box.low, added.low);
    box.high = larger(box.high, added.high);
}

// An item as it is in memory: low x, y, z, high x; high y, z, number, kind.
struct Item4 {
    Float4 first, second;

    explicit Item4(const BvhItem& item) {
        static_assert(sizeof(BvhItem) == sizeof(Item4) && offsetof(BvhItem, box) == 0);
        std::memcpy(&first, item.box.low.data(), sizeof(Float4));
        std::memcpy(&second, item.box.high.data() + 1, sizeof(Float4));
    }
    void store(BvhItem& item) const {
        std::memcpy(item.box.low.data(), &first, sizeof(Float4));
        std::memcpy(item.box.high.data() + 1, &second, sizeof(Float4));
    }
    // The unused elements are high x.
    Box4 box() const { return {first, __builtin_shufflevector(first, second, 3, 4, 5, 3)}; }
};

Box4 box_of(const BvhItem& item) { return Item4(item).box(); }

// Returns the number of leaves that `items` items need. The surface area heuristic multiplies the area of the items'
// box by this number.
float leaf_count(std::size_t items) { return static_cast<float>((items + RAYA_BVH_WIDTH - 1) / RAYA_BVH_WIDTH); }

bool fit_one_leaf(std::span<const BvhItem> items) {
    return items.size() <= max_leaf_items(items[0].kind) &&
           std::all_of(items.begin(), items.end(), [&](const BvhItem& i) { return i.kind == items[0].kind; });
}

Part make_part(std::span<BvhItem> items, const Box4& box, const Box4& centres) {
    return {items, box, centres, half_area(box), fit_one_leaf(items)};
}

// The chunks of the items on which threads work.
struct Chunks {
    std::span<BvhItem> items;
    unsigned threads;
    std::size_t count;

    Chunks(std::span<BvhItem> all_items, unsigned max_threads)
        : items(all_items),
          threads(all_items.size() < kMinItemsOfThreads ? 1 : max_threads),
          count(threads == 1 ? 1 : std::size_t{4} * threads) {}

    IndexRange range(std::size_t chunk) const { return part_of_range(chunk, count, items.size()); }
    std::span<BvhItem> of(std::size_t chunk) const { return items.subspan(range(chunk).begin, range(chunk).size()); }

    // Calls work(chunk) for each chunk.
    template <class Work>
    void for_each(const Work& work) const {
        if (threads == 1) return work(0);
        parallel_for(count, threads, work);
    }
};

struct Bin {
    Box4 box = kEmptyBox4;
    std::size_t items = 0;

    void add(const Bin& bin) {
        extend(box, bin.box);
        items += bin.items;
    }
};

using Bins = std::array<Bin, kBins>;  // all bins along one axis

// The division of the range of the items' doubled centres along each axis into kBins equal bins.
struct Binning {
    Float4 low, bins_per_unit{};

    explicit Binning(const Box4& centres) : low(centres.low) {
        for (int axis = 0; axis < 3; ++axis) {
            const float range = centres.high[axis] - low[axis], quotient = static_cast<float>(kBins) / range;
            if (range > 0 && quotient < kInfinity) bins_per_unit[axis] = quotient;
        }
    }
    // Returns the bin along each axis; the fourth element is unused.
    Int4 bins(const Float4& doubled_centre) const {
        constexpr float kLast = kBins - 1;
        const Float4 bin = (doubled_centre - low) * bins_per_unit;
        return __builtin_convertvector(smaller(Float4{kLast, kLast, kLast, 0}, bin), Int4);
    }
};

std::array<Bins, 3> filled_bins(std::span<const BvhItem> items, const Binning& binning) {
    std::array<Bins, 3> axes;
    for (const BvhItem& item : items) {
        const Box4 box = box_of(item);
        const Int4 bins = binning.bins(box.low + box.high);
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = axes[static_cast<std::size_t>(axis)][static_cast<std::size_t>(bins[axis])];
            extend(bin.box, box);
            ++bin.items;
        }
    }
    return axes;
}

std::array<Bins, 3> filled_bins(const Chunks& chunks, const Binning& binning) {
    if (chunks.count == 1) return filled_bins(chunks.items, binning);
    std::vector<std::array<Bins, 3>> of_chunks(chunks.count);
    chunks.for_each([&](std::size_t chunk) { of_chunks[chunk] = filled_bins(chunks.of(chunk), binning); });
    for (std::size_t chunk = 1; chunk < chunks.count; ++chunk)
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t b = 0; b < kBins; ++b) of_chunks[0][axis][b].add(of_chunks[chunk][axis][b]);
    return of_chunks[0];
}

// A split plane perpendicular to `axis`, below the bin `first_above`.
struct Split {
    float cost = kInfinity;
    std::size_t axis = 0, first_above = 0;
};

// Replaces `best` by the cheapest split along `axis` if that split is cheaper than `best`.
void improve_split(Split& best, std::size_t axis, const Bins& bins) {
    const auto cost_of = [](const Bin& sum) { return half_area(sum.box) * leaf_count(sum.items); };
    std::array<float, kBins> cost_from;  // cost_from[b]: cost of bin b and all bins above it
    Bin sum;
    for (std::size_t b = kBins; b-- > 0;) {
        if (bins[b].items == 0) continue;
        sum.add(bins[b]);
        cost_from[b] = cost_of(sum);
    }
    sum = {};
    for (std::size_t b = 0; b < kBins; ++b) {
        if (bins[b].items == 0) continue;
        const float cost = sum.items > 0 ? cost_of(sum) + cost_from[b] : kInfinity;
        if (cost < best.cost) best = {cost, axis, b};
        sum.add(bins[b]);
    }
}

using Parts = std::array<Part, 2>;

// Splits a part after its first `items` items.
Parts split_after(const Part& part, std::size_t items, unsigned threads) {
    return {part_of(part.items.first(items), threads), part_of(part.items.subspan(items), threads)};
}

// Splits the items into two equal halves by object number.
Parts split_by_number(const Part& part, unsigned threads) {
    const std::size_t half = part.items.size() / 2;
    std::nth_element(part.items.begin(), part.items.begin() + static_cast<std::ptrdiff_t>(half), part.items.end(),
                     [](const BvhItem& a, const BvhItem& b) { return a.number < b.number; });
    return split_after(part, half, threads);
}

// Splits the items into those of the lowest kind and the others.
Parts split_by_kind(const Part& part) {
    std::uint32_t kind = RAYA_LINK_OBJECT;  // lowest kind
    for (const BvhItem& item : part.items) kind = std::min(kind, item.kind);
    const auto second_part =
        std::partition(part.items.begin(), part.items.end(), [&](const BvhItem& item) { return item.kind == kind; });
    return split_after(part, static_cast<std::size_t>(second_part - part.items.begin()), 1);
}

// The items of a chunk below the split plane, which come first, and those above it.
struct Sides {
    std::size_t below = 0;                                   // number of items below the plane
    std::array<Box4, 2> centres = {kEmptyBox4, kEmptyBox4};  // doubled centres: below, above
};

Sides partition_at(std::span<BvhItem> items, const Split& plane, const Binning& binning) {
    Sides sides;
    for (BvhItem& slot : items) {
        const Item4 item(slot);
        const Box4 box = item.box();
        const Float4 centre = box.low + box.high;
        const bool above = static_cast<std::size_t>(binning.bins(centre)[plane.axis]) >= plane.first_above;
        // Without a branch, which the processor would often mispredict.
        BvhItem& first_above = items[sides.below];
        Item4(first_above).store(slot);
        item.store(first_above);
        sides.below += !above;
        extend(sides.centres[above], {centre, centre});
    }
    return sides;
}

using Run = std::span<BvhItem>;  // consecutive items

// Exchanges the items of two lists of runs, which have the same number of items.
void exchange(std::vector<Run> runs, std::vector<Run> others) {
    for (std::size_t i = 0, j = 0; i < runs.size() && j < others.size();) {
        const std::size_t items = std::min(runs[i].size(), others[j].size());
        std::swap_ranges(others[j].begin(), others[j].begin() + static_cast<std::ptrdiff_t>(items), runs[i].begin());
        runs[i] = runs[i].subspan(items);
        others[j] = others[j].subspan(items);
        i += runs[i].empty();
        j += others[j].empty();
    }
}

// Exchanges items of partitioned chunks so that all items below the plane come first. `below`: their number.
void join_chunks(const Chunks& chunks, const std::vector<Sides>& sides, std::size_t below) {
    std::vector<Run> above_first, below_last;  // items above the plane among the first `below` items; the converse
    for (std::size_t chunk = 0; chunk < chunks.count; ++chunk) {
        const auto [begin, end] = chunks.range(chunk);
        const std::size_t middle = begin + sides[chunk].below;  // first item of the chunk above the plane
        if (middle < below) above_first.push_back(chunks.items.subspan(middle, std::min(end, below) - middle));
        const std::size_t first = std::max(begin, below);
        if (first < middle) below_last.push_back(chunks.items.subspan(first, middle - first));
    }
    exchange(std::move(above_first), std::move(below_last));
}

// Splits the items into those in the bins below Split::first_above and the others. The boxes of the parts are the
// unions of the bins' boxes.
Parts split_at(const Part& part, const Split& plane, const Bins& bins, const Binning& binning, const Chunks& chunks) {
    std::vector<Sides> sides(chunks.count);
    chunks.for_each([&](std::size_t chunk) { sides[chunk] = partition_at(chunks.of(chunk), plane, binning); });
    std::array<Bin, 2> sums;
    for (std::size_t b = 0; b < kBins; ++b) sums[b >= plane.first_above].add(bins[b]);
    if (chunks.count > 1) join_chunks(chunks, sides, sums[0].items);
    std::array<Box4, 2> centres = {kEmptyBox4, kEmptyBox4};
    for (const Sides& of_chunk : sides)
        for (std::size_t side = 0; side < 2; ++side) extend(centres[side], of_chunk.centres[side]);
    return {make_part(part.items.first(sums[0].items), sums[0].box, centres[0]),
            make_part(part.items.subspan(sums[0].items), sums[1].box, centres[1])};
}

}  // namespace

Bounds bounds_of(const Box4& box) {
    return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
}

Part part_of(std::span<BvhItem> items, unsigned threads) {
    const Chunks chunks(items, threads);
    std::vector<std::array<Box4, 2>> of_chunks(chunks.count, {kEmptyBox4, kEmptyBox4});  // boxes; centres
    chunks.for_each([&](std::size_t chunk) {
        std::array<Box4, 2> boxes = of_chunks[chunk];
        for (const BvhItem& item : chunks.of(chunk)) {
            const Box4 box = box_of(item);
            extend(boxes[0], box);
            extend(boxes[1], {box.low + box.high, box.low + box.high});
        }
        of_chunks[chunk] = boxes;
    });
    for (std::size_t chunk = 1; chunk < chunks.count; ++chunk)
        for (std::size_t i = 0; i < 2; ++i) extend(of_chunks[0][i], of_chunks[chunk][i]);
    return make_part(items, of_chunks[0][0], of_chunks[0][1]);
}

std::array<Part, 2> split(const Part& part, std::uint32_t depth, unsigned threads) {
    const auto is_of_first_kind = [&](const BvhItem& item) { return item.kind == part.items[0].kind; };
    if (part.items.size() <= RAYA_BVH_WIDTH && !std::all_of(part.items.begin(), part.items.end(), is_of_first_kind))
        return split_by_kind(part);
    if (depth >= kMedianDepth) return split_by_number(part, threads);
    const Chunks chunks(part.items, threads);
    const Binning binning(part.centres);
    const std::array<Bins, 3> bins = filled_bins(chunks, binning);
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) improve_split(best, axis, bins[axis]);
    if (best.cost == kInfinity) return split_by_number(part, threads);
    return split_at(part, best, bins[best.axis], binning, chunks);
}

}  // namespace raya
