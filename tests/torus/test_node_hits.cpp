// Kernels find the same hits in a node's memory as in the job's words: object, distance, normals and colour.
#include <catch2/catch.hpp>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/kernels/kernel_runner.hpp"
#include "tests/kernels/probe.hpp"
#include "tests/torus/random_nodes.hpp"

using namespace raya;

namespace {

constexpr std::size_t kRays = 640;

struct VoxelHits {
    std::vector<std::uint32_t> objects;  // object numbers in the voxel
    std::vector<float> distances;        // distances of the hits
    std::vector<float> places;           // [ray][9]: geometric normal, normal, colour
};

VoxelHits voxel_hits(KernelRunner& runner, const NodeMemories& memories, std::uint32_t node, std::uint32_t voxel,
                     const std::vector<float>& rays) {
    const std::size_t count = rays.size() / 7;
    const auto words = runner.filled("memories", memories.words);
    const auto ray_buffer = runner.filled("rays", rays);
    auto objects = runner.constant<std::uint32_t>("objects", count, 0);
    auto distances = runner.constant<float>("distances", count, 0);
    auto places = runner.constant<float>("places", count * 9, 0);
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, cl_uint, cl_uint, Buffer<std::uint32_t>&,
                    Buffer<float>&, Buffer<float>&>("voxel_hits", count, words, ray_buffer, memories.starts[node],
                                                    voxel, objects, distances, places);
    return {runner.read(objects), runner.read(distances), runner.read(places)};
}

// Returns the scene with all patches reduced to three corners. The packer does not split such patches, so the job's
// objects match the scene's objects one to one.
Scene with_triangles(Scene scene) {
    for (Polygon& polygon : scene.polygons)
        if (!polygon.normals.empty()) {
            polygon.vertices.resize(3);
            polygon.normals.resize(3);
        }
    return scene;
}

// Returns the scene with only the listed objects and all planes.
Scene only_listed(const Scene& scene, const std::set<std::uint32_t>& list) {
    Scene reduced = scene;
    std::uint32_t number = 0;
    const auto keep = [&](auto& objects, bool all) {
        auto kept = objects;
        kept.clear();
        for (const auto& object : objects)
            if (all | list.contains(number++)) kept.push_back(object);
        objects = kept;
    };
    keep(reduced.spheres, false);
    keep(reduced.planes, true);
    keep(reduced.polygons, false);
    keep(reduced.cones, false);
    return reduced;
}

// Returns the scene-wide numbers of a voxel's objects, indexed by the objects' numbers in the voxel.
std::vector<std::uint32_t> scene_numbers(NodeReader& node, const raya_voxel_memory& voxel) {
    const raya_objects& o = voxel.objects;
    std::vector<std::uint32_t> numbers = node.section(voxel.numbers_at, o.spheres + o.polygons + o.cones);
    std::vector<std::uint32_t> planes(o.planes);
    std::iota(planes.begin(), planes.end(), voxel.first_plane);
    numbers.insert(numbers.begin() + o.spheres, planes.begin(), planes.end());
    return numbers;
}

// Returns the number of rays whose hits differ.
std::size_t differences(const VoxelHits& found_hits, const VoxelHits& expected_hits) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < found_hits.objects.size(); ++i) {
        const bool hit = found_hits.objects[i] != kNoObject;
        const auto place = [&](const VoxelHits& hits) {
            return std::vector<float>(hits.places.begin() + 9 * i, hits.places.begin() + 9 * i + 9);
        };
        count += found_hits.objects[i] != expected_hits.objects[i] ||
                 found_hits.distances[i] != expected_hits.distances[i] ||
                 (hit && bits(place(found_hits)) != bits(place(expected_hits)));
    }
    return count;
}

// Returns the hits in the job's words, in the same form as voxel_hits().
VoxelHits job_hits(KernelRunner& runner, const PackedJob& job, const std::vector<float>& rays) {
    const ProbedHits hits = closest_hits(runner, job.words(), rays);
    const ProbedPlaces probed = find_places(runner, job.words(), rays);
    std::vector<float> places;
    for (std::size_t i = 0; i < hits.objects.size(); ++i)
        for (const auto vector : {ProbedPlaces::kGeometric, ProbedPlaces::kNormal, ProbedPlaces::kColour})
            for (int axis = 0; axis < 3; ++axis) places.push_back(static_cast<float>(probed.vector(i, vector)[axis]));
    return {hits.objects, hits.distances, places};
}

}  // namespace

TEST_CASE("rays have the same hits in a node's voxel as in a job of the voxel's objects", "[torus]") {
    std::size_t struck = 0, copies = 0;
    for (const std::uint32_t lanes : {1u, 16u}) {
        KernelRunner job_runner("tests/kernels/probe.cl", {lanes, true}),
            node_runner("tests/torus/probe.cl", {lanes, true});
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            SplitMix random(100 * lanes + seed);
            const Scene scene = with_triangles(random_objects(random, 4));
            const PackedJob job = pack(scene);
            const raya_torus torus = random_torus(random, 3);
            const Partition partition = random_partition(random, job, random_sides(random, 3), 6);
            const NodeMemories memories = pack_all(job, partition, torus);
            const std::vector<float> rays = ray_words(random_rays(seed, kRays));
            const std::uint32_t voxel = random_below(random, raya_voxels(partition.grid));
            const std::uint32_t number = raya_node_of_voxel(torus, partition.grid, voxel);
            const std::uint32_t local = raya_local_voxel(torus, partition.grid, voxel);
            NodeReader node(memories, number);
            const std::vector<std::uint32_t> numbers = scene_numbers(node, node.voxel(local));
            CAPTURE(lanes, seed, torus_text(torus), voxel, number, local);
            REQUIRE(std::is_sorted(numbers.begin(), numbers.end()));
            const std::set<std::uint32_t> list(numbers.begin(), numbers.end());
            const VoxelHits expected = job_hits(job_runner, pack(only_listed(scene, list)), rays);
            CHECK(differences(voxel_hits(node_runner, memories, number, local, rays), expected) == 0);
            const VoxelHits planes = job_hits(job_runner, pack(only_listed(scene, {})), rays);
            CHECK(differences(voxel_hits(node_runner, memories, number, node.header().voxels, rays), planes) == 0);
            struck += kRays - std::count(expected.objects.begin(), expected.objects.end(), kNoObject);
            copies += partition.copies();
        }
    }
    CHECK(struck > 2 * 12 * kRays / 10);
    CHECK(copies > 50);
}

TEST_CASE("rays have the same hits in a voxel that lists all objects as in the job", "[torus]") {
    KernelRunner job_runner("tests/kernels/probe.cl", {16, true}), node_runner("tests/torus/probe.cl", {16, true});
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        SplitMix random(seed);
        const PackedJob job = pack(random_objects(random, 4));  // some patches are split into triangles
        const std::vector<std::uint32_t> finite = finite_objects(job);
        const std::vector<std::set<std::uint32_t>> lists(12, {finite.begin(), finite.end()});
        const raya_torus torus = make_torus({2, 1, 2}, Links::kTorus2d);
        const NodeMemories memories = pack_all(job, partition_of({2, 2, 3}, lists), torus);
        const std::vector<float> rays = ray_words(random_rays(50 + seed, kRays));
        const VoxelHits expected = job_hits(job_runner, job, rays);
        for (std::uint32_t number = 0; number < 4; ++number) {
            NodeReader node(memories, number);
            for (std::uint32_t local = 0; local < node.header().voxels; ++local) {
                CAPTURE(seed, number, local);
                VoxelHits found_hits = voxel_hits(node_runner, memories, number, local, rays);
                const std::vector<std::uint32_t> numbers = scene_numbers(node, node.voxel(local));
                for (std::uint32_t& object : found_hits.objects)
                    if (object != kNoObject) object = numbers.at(object);
                CHECK(differences(found_hits, expected) == 0);
            }
        }
    }
}
