// The words of a grid, read as the kernels read them, contain the object lists of the partition.
#include <catch2/catch.hpp>
#include <cstring>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "tests/accel/partition_lists.hpp"

namespace raya {
namespace {

raya_grid_words grid_of(const PackedJob& job) { return record_at<raya_grid_words>(job.words(), job.header().accel_at); }

std::vector<std::uint32_t> words_at(const PackedJob& job, std::uint32_t at, std::size_t count) {
    const auto first = job.words().begin() + at;
    return {first, first + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

TEST_CASE("a grid's words hold the lists of the partition; appending them to the job changes only accel_at") {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        SplitMix random(seed);
        const NumberFormat format = parse_format(kFormats[seed % kFormats.size()]);
        PackedJob job = job_in(mixed_scene(seed), format);
        const std::vector<std::uint32_t> before = job.words();
        const Divisions divisions = random_divisions(random);
        const std::vector<std::uint32_t> finite = finite_numbers(job);
        std::vector<std::uint32_t> separate;
        for (const std::uint32_t number : finite)
            if (below(random, 5) == 0) separate.push_back(number);
        const Partition p = partition(job, format, divisions, separate);
        const AccelSummary summary = append_grid(job, p);
        CAPTURE(seed, divisions, separate);
        const raya_grid_words grid = grid_of(job);
        CHECK(words_at(job, grid.starts_at, p.starts.size()) == p.starts);
        CHECK(words_at(job, grid.lists_at, p.objects.size()) == p.objects);
        CHECK(words_at(job, grid.separate_at, grid.separate) == separate);
        CHECK(std::memcmp(&grid.grid, &p.grid, sizeof p.grid) == 0);
        CHECK(summary.copies == p.copies());
        CHECK(summary.separate == separate.size());
        CHECK(summary.divisions == divisions);
        CHECK(job.words().size() - before.size() == summary.words);
        raya_job header_without_grid = job.header();
        header_without_grid.accel_at = 0;
        job.set_header(header_without_grid);
        CHECK(std::equal(before.begin(), before.end(), job.words().begin()));
    }
}

}  // namespace raya
