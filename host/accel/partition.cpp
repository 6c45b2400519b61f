#include "host/accel/partition.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/accel/hit_regions.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"

namespace raya {
namespace {

// With default divisions, lists have on average at most this many entries per object or per voxel.
constexpr double kMaxMeanEntries = 16;
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 30;  // maximum number of entries of all lists together: 4 GB

// Upper bound of the distance between a point of a ray and the voxel to which the traversal assigns the point, due to
// rounding errors. The distance t to a plane has a relative error of 3 2^-24, so the point on the plane has an error of
// 3 2^-24 |plane - O|; the first voxel is computed by five operations on numbers of that magnitude.
double traversal_error(const Box& box, double reach) {
    return 16 * 0x1p-24 * (reach + std::max(largest_coordinate(box.min), largest_coordinate(box.max)));
}

// Returns the box of the partition: the bounding box of all regions, with a margin for the traversal's rounding errors,
// so that the traversal finds points on the border of a region inside the box.
Box box_around(const HitRegions& regions) {
    Box box;
    if (regions.size() == 0) return {Vec3(-0.5), Vec3(0.5)};
    if (!regions.all_bounded()) return {Vec3(-4 * regions.far()), Vec3(4 * regions.far())};
    for (std::size_t i = 0; i < regions.size(); ++i) box.extend(regions.region(i).box);
    const Vec3 margin(2 * traversal_error(box, regions.reach()));
    return {box.min - margin, box.max + margin};
}

// Returns a grid whose outer planes enclose the box although the kernels round the positions of the planes.
raya_grid grid_over(const Box& box, const Divisions& divisions, double reach) {
    constexpr float kUp = std::numeric_limits<float>::infinity();
    raya_grid grid{};
    grid.reach = static_cast<float>(reach);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const int a = static_cast<int>(axis);
        grid.divisions[axis] = divisions[axis];
        grid.low[axis] = static_cast<float>(box.min[a]);
        if (grid.low[axis] > box.min[a]) grid.low[axis] = std::nextafter(grid.low[axis], -kUp);
        grid.cell[axis] = static_cast<float>((box.max[a] - grid.low[axis]) / divisions[axis]);
        while (raya_voxel_plane(grid, axis, divisions[axis]) < box.max[a])
            grid.cell[axis] = std::nextafter(grid.cell[axis], kUp);
    }
    return grid;
}

// Finds the voxels that a region overlaps, from the planes between voxels.
class Voxels {
  public:
    Voxels(const raya_grid& grid, double slack) : grid_(grid), slack_(slack) {
        for (std::uint32_t axis = 0; axis < 3; ++axis)
            for (std::uint32_t k = 0; k <= grid.divisions[axis]; ++k)
                planes_[axis].push_back(raya_voxel_plane(grid, axis, k));
    }

    /// Calls visit(voxel) for each voxel that, enlarged by the slack on all sides, touches the region.
    template <class Visit>
    void visit(const HitRegion& region, const Visit& visit) const {
        const auto [x, last_x] = range(region.box, 0);
        const auto [y, last_y] = range(region.box, 1);
        const auto [z, last_z] = range(region.box, 2);
        for (std::uint32_t k = z; k <= last_z; ++k)
            for (std::uint32_t j = y; j <= last_y; ++j)
                for (std::uint32_t i = x; i <= last_x; ++i)
                    if (region.touches(enlarged_voxel(i, j, k))) visit(raya_voxel(grid_, i, j, k));
    }

  private:
    // Returns the first and the last voxel along an axis that a box may touch.
    std::array<std::uint32_t, 2> range(const Box& box, int axis) const {
        const std::vector<float>& planes = planes_[static_cast<std::size_t>(axis)];
        const auto first_plane = std::lower_bound(planes.begin() + 1, planes.end() - 1, box.min[axis] - slack_);
        const auto last_plane = std::upper_bound(first_plane, planes.end() - 1, box.max[axis] + slack_);
        return {static_cast<std::uint32_t>(first_plane - planes.begin() - 1),
                static_cast<std::uint32_t>(last_plane - planes.begin() - 1)};
    }
    Box enlarged_voxel(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return {Vec3(planes_[0][i] - slack_, planes_[1][j] - slack_, planes_[2][k] - slack_),
                Vec3(planes_[0][i + 1] + slack_, planes_[1][j + 1] + slack_, planes_[2][k + 1] + slack_)};
    }

    raya_grid grid_;
    double slack_;
    std::array<std::vector<float>, 3> planes_;  // [divisions + 1] each
};

[[noreturn]] void refuse_entries(const Divisions& d) {
    throw UserError(fmt::format("the lists of {}x{}x{} voxels have more than {} entries; use fewer voxels", d[0], d[1],
                                d[2], kMaxEntries));
}

// Counts the objects of each voxel, then fills the lists (counting sort).
void fill_lists(Partition& p, const HitRegions& regions, const Voxels& voxels, const Divisions& divisions) {
    std::uint64_t entries = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        voxels.visit(regions.region(i), [&](std::uint32_t voxel) {
            ++p.starts[voxel + 1];
            ++entries;
        });
        if (entries > kMaxEntries) refuse_entries(divisions);
    }
    for (std::size_t v = 1; v < p.starts.size(); ++v) p.starts[v] += p.starts[v - 1];
    p.objects.resize(entries);
    std::vector<std::uint32_t> next_entries(p.starts.begin(), p.starts.end() - 1);  // index of each voxel's next entry
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const std::uint32_t number = regions.number(i);
        voxels.visit(regions.region(i), [&](std::uint32_t voxel) { p.objects[next_entries[voxel]++] = number; });
    }
}

// Adds every object to the list of every voxel.
void list_all_objects(Partition& p, const HitRegions& regions, const Divisions& divisions) {
    const std::size_t voxels = p.starts.size() - 1;
    if (voxels * regions.size() > kMaxEntries) refuse_entries(divisions);
    for (std::size_t v = 0; v < voxels; ++v) {
        for (std::size_t i = 0; i < regions.size(); ++i) p.objects.push_back(regions.number(i));
        p.starts[v + 1] = static_cast<std::uint32_t>(p.objects.size());
    }
}

void check_divisions(const Divisions& d) {
    for (const std::uint64_t division : d)
        if (division == 0 || division > kMaxPartitionVoxels || std::uint64_t{d[0]} * d[1] > kMaxPartitionVoxels ||
            std::uint64_t{d[0]} * d[1] * d[2] > kMaxPartitionVoxels)
            throw UserError(fmt::format("{}x{}x{} voxels: each number must be at least 1, their product at most {}",
                                        d[0], d[1], d[2], kMaxPartitionVoxels));
}

// Regions may grow by this fraction of a voxel's shortest side. A ray from beyond the reach is tested against all
// objects.
double max_voxel_slack(const HitRegions& regions, const Divisions& divisions) {
    constexpr double kFractionOfVoxel = 1.0 / 16;
    const Box box = box_around(regions);
    double side = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        side = std::min(side, (box.max[axis] - box.min[axis]) / divisions[static_cast<std::size_t>(axis)]);
    return kFractionOfVoxel * side;
}

// Returns an estimate of the total number of list entries: a box with sides e overlaps about
//   (e_x / c_x + 1) (e_y / c_y + 1) (e_z / c_z + 1)
// voxels with sides c. `sizes`: e of all regions.
double estimated_entries(const std::vector<Vec3>& sizes, const Vec3& voxel) {
    double sum = 0;
    for (const Vec3& e : sizes) sum += (e.x / voxel.x + 1) * (e.y / voxel.y + 1) * (e.z / voxel.z + 1);
    return sum;
}

// Divides a box with the given sides into about `voxels` voxels that are nearly cubes. Starts with the shortest side:
// if this side is shorter than that of an ideal voxel, it is not divided, and the other two sides get all divisions.
Divisions cubic_divisions(const Vec3& sides, double voxels) {
    std::array<int, 3> axes = {0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&](int a, int b) { return sides[a] < sides[b]; });
    double volume = sides.x * sides.y * sides.z;
    Divisions divisions{};
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const double ideal_side = std::pow(volume / voxels, 1.0 / static_cast<double>(axes.size() - i));
        const double axis_voxels = std::max(1.0, i == 2 ? std::floor(voxels) : std::round(sides[axes[i]] / ideal_side));
        divisions[static_cast<std::size_t>(axes[i])] = static_cast<std::uint32_t>(axis_voxels);
        volume /= sides[axes[i]];
        voxels /= axis_voxels;
    }
    return divisions;
}

}  // namespace

Partition partition(const PackedJob& job, const NumberFormat& format, const Divisions& divisions,
                    const std::vector<std::uint32_t>& separate) {
    check_divisions(divisions);
    const double reach = reach_for(
        job, format, [&](const HitRegions& regions) { return max_voxel_slack(regions, divisions); }, separate);
    const HitRegions regions(job, format, reach, separate);
    const Box box = box_around(regions);
    Partition p;
    p.grid = grid_over(box, divisions, regions.reach());
    p.starts.assign(std::size_t{raya_voxels(p.grid)} + 1, 0);
    p.separate = separate;
    p.listed_objects = regions.size();
    if (regions.all_bounded())
        fill_lists(p, regions, Voxels(p.grid, traversal_error(box, regions.reach())), divisions);
    else
        list_all_objects(p, regions, divisions);
    return p;
}

Divisions divisions_for(const PackedJob& job, const NumberFormat& format, std::uint64_t voxels,
                        const std::vector<std::uint32_t>& separate) {
    const HitRegions regions(job, format, 2, separate);
    if (!regions.all_bounded()) return {1, 1, 1};
    const Box box = box_around(regions);
    std::vector<Vec3> sizes;
    for (std::size_t i = 0; i < regions.size(); ++i) sizes.push_back(regions.region(i).box.size());
    auto wanted_voxels = static_cast<double>(std::clamp<std::uint64_t>(voxels, 1, kMaxPartitionVoxels));
    for (;; wanted_voxels /= 2) {
        const Divisions d = cubic_divisions(box.size(), wanted_voxels);
        const double limit = kMaxMeanEntries * std::max(wanted_voxels, static_cast<double>(sizes.size()));
        if (wanted_voxels <= 1 || estimated_entries(sizes, box.size() / Vec3(d[0], d[1], d[2])) <= limit) return d;
    }
}

namespace {

// Measured on SPD's balls, lattice and tetra and on 8,320 uniform spheres (fp32, 16 lanes): grids of 2, 4 and 8 voxels
// per object are about equally fast. A grid of 1 voxel per object takes up to 1.5 times as long; a grid of 16 takes up
// to 1.4 times as long and twice the memory.
constexpr std::uint64_t kVoxelsPerObject = 4;

// Reach for which large objects and divisions are chosen, in multiples of the scene's extent.
constexpr double kMinReach = 2;
// An object is large if its longest side exceeds this fraction of the whole box's longest side.
constexpr double kLargeSide = 0.75;
constexpr std::size_t kMaxLarge = 16;  // maximum number of large objects; see large_objects()

std::uint32_t as_word(std::size_t number) { return static_cast<std::uint32_t>(number); }

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
            longest_sides.push_back(largest_coordinate(box.size()));
            whole.extend(box);
        }
        std::vector<std::uint32_t> new_large;
        for (std::size_t i = 0; i < regions.size(); ++i)
            if (longest_sides[i] > kLargeSide * largest_coordinate(whole.size()))
                new_large.push_back(regions.number(i));
        if (new_large.empty() || large.size() + new_large.size() > kMaxLarge) return large;
        large.insert(large.end(), new_large.begin(), new_large.end());
        std::sort(large.begin(), large.end());
    }
}

Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel) {
    if (accel.divisions) return partition(job, format, *accel.divisions);
    const std::vector<std::uint32_t> separate = large_objects(job, format);
    const raya_objects& objects = job.header().objects;
    const std::uint64_t listed = raya_first_object(objects, RAYA_OBJECT_KINDS) - objects.planes - separate.size();
    return partition(job, format, divisions_for(job, format, kVoxelsPerObject * listed, separate), separate);
}

AccelSummary append_grid(PackedJob& job, const Partition& p) {
    const std::size_t end = job.words().size(), grid_at = padded_to_rows(end);
    const std::size_t separate_at = grid_at + kWordsOf<raya_grid_words>, starts_at = separate_at + p.separate.size();
    const std::size_t lists_at = starts_at + p.starts.size(), new_end = lists_at + p.objects.size();
    if (new_end > kMaxWords)
        throw UserError("--accel grid: 32-bit indices cannot address all words of the grid; use fewer voxels");
    raya_grid_words header{};
    header.grid = p.grid;
    header.separate = as_word(p.separate.size());
    header.separate_at = as_word(separate_at);
    header.starts_at = as_word(starts_at);
    header.lists_at = as_word(lists_at);
    const std::span<std::uint32_t> words = job.append_zeros(new_end - end);
    put_record(words, grid_at - end, header);
    auto next = words.begin() + static_cast<std::ptrdiff_t>(separate_at - end);
    for (const auto* list : {&p.separate, &p.starts, &p.objects}) next = std::copy(list->begin(), list->end(), next);
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
