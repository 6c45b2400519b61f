#include "grid/accel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "error.hpp"
#include "grid/hit_regions.hpp"

namespace raya {
namespace {

// Measured on SPD's balls and on 8,320 even spheres (fp32, 16 lanes): see the table in kernels/README.md.
constexpr double kVoxelsPerObject = 4;

constexpr double kLeastReach = 2;       // of rays, in extents of the scene: sizes of objects hardly depend on it
constexpr double kLargeShare = 0.75;    // of the whole box's longest side
constexpr std::size_t kMostLarge = 16;  // more of them are no exception: they belong into the lists

// The largest job that 32-bit word numbers reach with room to spare: 4 GB.
constexpr std::size_t kMostWords = std::size_t{1} << 30;

double longest_side(const Box& box) {
    const Vec3 sides = box.max - box.min;
    return std::max({sides.x, sides.y, sides.z});
}

std::uint32_t word_number(std::size_t at) { return static_cast<std::uint32_t>(at); }

}  // namespace

std::string accel_text(const Accel& accel) {
    if (!accel.grid) return "none";
    if (!accel.divisions) return "grid";
    const Divisions& d = *accel.divisions;
    return fmt::format("grid:{}x{}x{}", d[0], d[1], d[2]);
}

std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format) {
    std::vector<std::uint32_t> large;
    for (;;) {
        const HitRegions regions(job, format, kLeastReach, large);
        if (!regions.known()) return {};
        std::vector<double> lengths;
        Box whole;
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const Box box = regions.region(i).box;
            lengths.push_back(longest_side(box));
            whole.extendBy(box);
        }
        std::vector<std::uint32_t> found;
        for (std::size_t i = 0; i < regions.size(); ++i)
            if (lengths[i] > kLargeShare * longest_side(whole)) found.push_back(regions.number(i));
        if (found.empty() || large.size() + found.size() > kMostLarge) return large;
        large.insert(large.end(), found.begin(), found.end());
        std::sort(large.begin(), large.end());
    }
}

Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel) {
    if (accel.divisions) return partition(job, format, *accel.divisions);
    const std::vector<std::uint32_t> apart = large_objects(job, format);
    const HitRegions rest(job, format, kLeastReach, apart);
    // Where every object is in every list, more voxels are of no use.
    const double voxels = rest.known() ? std::max(1.0, kVoxelsPerObject * static_cast<double>(rest.size())) : 1;
    return partition(job, format, divisions_for(job, format, static_cast<std::uint64_t>(voxels), apart), apart);
}

AccelSummary append_grid(PackedJob& job, const Partition& p) {
    constexpr std::size_t kHeaderWords = sizeof(raya_grid_words) / sizeof(std::uint32_t);
    std::vector<std::uint32_t>& words = job.words;
    const std::size_t at = words.size(), voxels = p.starts.size() - 1, apart_at = at + kHeaderWords;
    const std::size_t voxels_at = apart_at + p.apart.size(), lists_at = voxels_at + voxels;
    if (lists_at + p.objects.size() > kMostWords)
        throw UserError(
            fmt::format("--accel grid packs to {} words, more than 32-bit word numbers reach; take fewer voxels",
                        lists_at + p.objects.size()));
    raya_grid_words header{};
    header.grid = p.grid;
    header.apart = word_number(p.apart.size());
    header.apart_at = word_number(apart_at);
    header.voxels_at = word_number(voxels_at);
    words.resize(apart_at);
    std::memcpy(&words[at], &header, sizeof header);
    words.insert(words.end(), p.apart.begin(), p.apart.end());
    for (std::size_t v = 0; v < voxels; ++v)
        words.push_back(p.starts[v] == p.starts[v + 1] ? 0 : word_number(lists_at + p.starts[v]));
    words.insert(words.end(), p.objects.begin(), p.objects.end());
    for (std::size_t v = 0; v < voxels; ++v)
        if (p.starts[v] != p.starts[v + 1]) words[lists_at + p.starts[v + 1] - 1] |= RAYA_LAST_OBJECT;
    raya_job job_header;
    std::memcpy(&job_header, words.data(), sizeof job_header);
    job_header.grid_at = word_number(at);
    std::memcpy(words.data(), &job_header, sizeof job_header);
    return {
        {p.grid.divisions[0], p.grid.divisions[1], p.grid.divisions[2]}, p.copies(), words.size() - at, header.apart};
}

}  // namespace raya
