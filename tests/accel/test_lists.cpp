// The words of a grid, read as the kernels read them, contain the object lists of the partition.
#include <catch2/catch.hpp>
#include <cstring>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "tests/accel/partition_lists.hpp"

namespace raya {
namespace {

raya_grid_words grid_of(const PackedJob& job) { return record_at<raya_grid_words>(job.words(), job.header().accel_at); }

/// Returns the object numbers in the list that a voxel word describes. Checks that the row of every sphere holds the
/// sphere's words.
std::vector<std::uint32_t> objects_in_list(const PackedJob& job, std::uint32_t word) {
    const raya_grid_words grid = grid_of(job);
    const raya_objects objects = job.header().objects;
    std::vector<std::uint32_t> numbers;
    while (word != 0) {
        std::uint32_t row = word & RAYA_ROW_NUMBER;
        REQUIRE(row > 0);
        for (std::uint32_t left = word & RAYA_ROWS_LEFT; left > 0; left -= RAYA_ONE_ROW, ++row) {
            const std::uint32_t number = job.words()[grid.numbers_at + row];
            REQUIRE(number < objects.spheres);
            for (std::uint32_t i = 0; i < RAYA_ROW_WORDS; ++i)
                REQUIRE(job.words()[grid.rows_at + RAYA_ROW_WORDS * row + i] ==
                        job.words()[objects.spheres_at + RAYA_SPHERE_WORDS * number + i]);
            numbers.push_back(number);
        }
        if (!(word & RAYA_LINKED)) return numbers;
        const std::uint32_t linked = job.words()[grid.numbers_at + row];
        if (linked != RAYA_NO_OBJECT_HERE) {
            REQUIRE(linked >= objects.spheres + objects.planes);
            numbers.push_back(linked);
        }
        word = job.words()[grid.rows_at + RAYA_ROW_WORDS * row + RAYA_ROW_NEXT];
    }
    return numbers;
}

void check_lists(const PackedJob& job, const Partition& p) {
    const raya_grid_words grid = grid_of(job);
    CHECK(grid.rows_at % 4 == 0);
    for (std::size_t v = 0; v + 1 < p.starts.size(); ++v) {
        const std::vector<std::uint32_t> expected(p.objects.begin() + p.starts[v], p.objects.begin() + p.starts[v + 1]);
        if (objects_in_list(job, job.words()[grid.voxels_at + v]) != expected) {
            CAPTURE(v);
            FAIL("the voxel's list differs from the partition's");
        }
    }
}

/// Returns a scene with spheres and other objects in one place, so that every list contains all of them.
Scene overlapping_objects(std::size_t spheres, std::size_t others) {
    Scene scene = empty_scene();
    SplitMix random(spheres * 1000 + others);
    for (std::size_t i = 0; i < spheres; ++i) add_sphere(scene, random, 1);
    for (std::size_t i = 0; i < others; ++i) i % 3 == 0 ? add_cone(scene, random, 1, 1) : add_polygon(scene, random);
    return scene;
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
        check_lists(job, p);
        const raya_grid_words grid = grid_of(job);
        CHECK(std::vector<std::uint32_t>(job.words().begin() + grid.separate_at,
                                         job.words().begin() + grid.separate_at + grid.separate) == separate);
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

TEST_CASE("lists of every length are complete, even if they take several voxel words and link to other objects") {
    for (const std::size_t spheres : {0u, 1u, 30u, 31u, 32u, 61u, 62u, 63u, 93u, 94u, 200u})
        for (const std::size_t others : {0u, 1u, 2u, 40u}) {
            PackedJob job = job_in(overlapping_objects(spheres, others), {});
            CAPTURE(spheres, others);
            const Partition p = partition(job, {}, {1, 1, 1});
            REQUIRE(p.objects.size() == spheres + others);
            append_grid(job, p);
            check_lists(job, p);
        }
}

}  // namespace raya
