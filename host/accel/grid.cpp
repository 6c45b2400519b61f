#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <utility>

#include "host/accel/hit_regions.hpp"
#include "host/accel/partition.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"

namespace raya {
namespace {

// Measured on SPD's balls, lattice and tetra and on 8,320 uniform spheres (fp32, 16 lanes): grids of 2, 4 and 8 voxels
// per object are about equally fast. A grid of 1 voxel per object takes up to 1.5 times as long; a grid of 16 takes up
// to 1.4 times as long and twice the memory.
constexpr double kVoxelsPerObject = 4;

// Reach for which large objects and divisions are chosen, in multiples of the scene's extent.
constexpr double kMinReach = 2;
// An object is large if its longest side exceeds this fraction of the whole box's longest side.
constexpr double kLargeSide = 0.75;
constexpr std::size_t kMaxLarge = 16;  // maximum number of large objects; see large_objects()

double longest_side(const Box& box) {
    const Vec3 sides = box.max - box.min;
    return std::max({sides.x, sides.y, sides.z});
}

std::uint32_t as_word(std::size_t number) { return static_cast<std::uint32_t>(number); }

// The sections of a grid's words after its header.
struct GridLists {
    std::vector<std::uint32_t> voxels, rows, numbers;
};

void put_sphere(GridLists& lists, const std::vector<std::uint32_t>& words, const raya_objects& objects,
                std::uint32_t number) {
    const auto first = words.begin() + objects.spheres_at + static_cast<std::ptrdiff_t>(number) * RAYA_SPHERE_WORDS;
    lists.rows.insert(lists.rows.end(), first, first + RAYA_ROW_WORDS);
    lists.numbers.push_back(number);
}

// Appends a link row (kernels/shared/grid.h). `next`: voxel word of the remaining list; `number`: object number.
void put_link(GridLists& lists, std::uint32_t next, std::uint32_t number) {
    lists.rows.insert(lists.rows.end(), {next, 0, 0, 0});
    lists.numbers.push_back(number);
}

// Returns the voxel word of a list that starts at `row`: `spheres` rows of spheres, followed by a link row if `linked`.
std::uint32_t voxel_word(std::size_t row, std::size_t spheres, bool linked) {
    return as_word(row) | as_word(spheres) * RAYA_ONE_ROW | (linked ? RAYA_LINKED : 0);
}

// Appends a non-empty list and returns its voxel word. Spheres come first because their numbers are the lowest.
std::uint32_t put_list(GridLists& lists, const std::vector<std::uint32_t>& words, const raya_objects& objects,
                       std::span<const std::uint32_t> list) {
    const auto end_of_spheres = std::lower_bound(list.begin(), list.end(), objects.spheres);
    const auto spheres = static_cast<std::size_t>(end_of_spheres - list.begin());
    const auto spheres_in_word = [&](std::size_t i) { return std::min<std::size_t>(spheres - i, RAYA_MAX_ROWS); };
    const auto word_at = [&](std::size_t i, std::size_t row) {  // voxel word of the part of `list` from object i on
        return voxel_word(row, spheres_in_word(i), i + spheres_in_word(i) < list.size());
    };
    const std::uint32_t word = word_at(0, lists.numbers.size());
    for (std::size_t i = 0; i < spheres; ++i) {
        if (i > 0 && i % RAYA_MAX_ROWS == 0) put_link(lists, word_at(i, lists.numbers.size() + 1), RAYA_NO_OBJECT_HERE);
        put_sphere(lists, words, objects, list[i]);
    }
    for (std::size_t i = spheres; i < list.size(); ++i)
        put_link(lists, i + 1 < list.size() ? voxel_word(lists.numbers.size() + 1, 0, true) : 0, list[i]);
    return word;
}

GridLists grid_lists(const std::vector<std::uint32_t>& words, const raya_objects& objects, const Partition& p) {
    GridLists lists;
    put_link(lists, 0, RAYA_NO_OBJECT_HERE);  // row 0 belongs to no list: a voxel word of 0 means an empty list
    for (std::size_t v = 0; v + 1 < p.starts.size(); ++v) {
        const std::span list(p.objects.data() + p.starts[v], p.starts[v + 1] - p.starts[v]);
        lists.voxels.push_back(list.empty() ? 0 : put_list(lists, words, objects, list));
    }
    return lists;
}

}  // namespace

std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format) {
    std::vector<std::uint32_t> large;
    for (;;) {
        const HitRegions regions(job, format, kMinReach, large);
        if (!regions.all_bounded()) return {};
        std::vector<double> longest_sides;
        Box whole;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const Box box = regions.region(i).box;
            longest_sides.push_back(longest_side(box));
            whole.extendBy(box);
        }
        std::vector<std::uint32_t> new_large;
        for (std::size_t i = 0; i < regions.size(); ++i)
            if (longest_sides[i] > kLargeSide * longest_side(whole)) new_large.push_back(regions.number(i));
        if (new_large.empty() || large.size() + new_large.size() > kMaxLarge) return large;
        large.insert(large.end(), new_large.begin(), new_large.end());
        std::sort(large.begin(), large.end());
    }
}

Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel) {
    if (accel.divisions) return partition(job, format, *accel.divisions);
    const std::vector<std::uint32_t> separate = large_objects(job, format);
    const HitRegions regions(job, format, kMinReach, separate);
    // If the hit regions are unbounded, every list has all objects, so one voxel is enough.
    const double voxels =
        regions.all_bounded() ? std::max(1.0, kVoxelsPerObject * static_cast<double>(regions.size())) : 1;
    return partition(job, format, divisions_for(job, format, static_cast<std::uint64_t>(voxels), separate), separate);
}

AccelSummary append_grid(PackedJob& job, const Partition& p) {
    const GridLists lists = grid_lists(job.words(), job.header().objects, p);
    const std::size_t end = job.words().size(), grid_at = padded_to_rows(end);
    raya_grid_words header{};
    std::size_t next = grid_at + kWordsOf<raya_grid_words>;
    const auto reserve_words = [&](std::size_t count) { return as_word(std::exchange(next, next + count)); };
    header.grid = p.grid;
    header.separate = as_word(p.separate.size());
    header.separate_at = reserve_words(p.separate.size());
    header.voxels_at = reserve_words(lists.voxels.size());
    next = padded_to_rows(next);  // a row of four words is one aligned memory access
    header.rows_at = reserve_words(lists.rows.size());
    header.numbers_at = reserve_words(lists.numbers.size());
    if (next > kMaxWords || lists.numbers.size() > RAYA_ROW_NUMBER)
        throw UserError(fmt::format(
            "--accel grid: the grid needs {} words, more than 32-bit indices can address; use fewer voxels", next));
    std::vector<std::uint32_t> words(next - end);
    put_record(words, grid_at - end, header);
    const auto put = [&](const std::vector<std::uint32_t>& list, std::uint32_t list_at) {
        std::copy(list.begin(), list.end(), words.begin() + static_cast<std::ptrdiff_t>(list_at - end));
    };
    put(p.separate, header.separate_at);
    put(lists.voxels, header.voxels_at);
    put(lists.rows, header.rows_at);
    put(lists.numbers, header.numbers_at);
    job.append(words);
    raya_job new_header = job.header();
    new_header.accel_at = as_word(grid_at);
    job.set_header(new_header);
    return {.kind = AccelKind::kGrid,
            .words = words.size(),
            .divisions = {p.grid.divisions[0], p.grid.divisions[1], p.grid.divisions[2]},
            .copies = p.copies(),
            .separate = header.separate};
}

}  // namespace raya
