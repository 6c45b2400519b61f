// Compares the memories of torus nodes with the job word by word, for random scenes and object lists.
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

#include "tests/torus/random_nodes.hpp"

using namespace raya;
using Catch::Contains;

namespace {

using Words = std::vector<std::uint32_t>;

// Compares a node with the job: every word of each object, and the surfaces and corners to which the object refers.
class NodeCheck {
  public:
    NodeCheck(const PackedJob& job, NodeReader& node) : job_(job), header_(job.header()), node_(node) {}

    Words job_section(std::size_t at, std::size_t count) const {
        const auto first = job_.words().begin() + static_cast<std::ptrdiff_t>(at);
        return {first, first + static_cast<std::ptrdiff_t>(count)};
    }

    // Compares the node's objects of `words` words each, from word `at` of the node on, with the job's objects
    // `numbers`. The job's object `first` starts at word `job_at` of the job.
    void check_objects(std::uint32_t at, std::uint32_t words, const Words& numbers, std::uint32_t first,
                       std::uint32_t job_at) {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const std::size_t node_words_at = at + i * words, job_words_at = job_at + (numbers[i] - first) * words;
            Words node_words = node_.section(node_words_at, words), job_words = job_section(job_words_at, words);
            check_surface(node_words[RAYA_OBJECT_SURFACE_AT], job_words[RAYA_OBJECT_SURFACE_AT]);
            node_words[RAYA_OBJECT_SURFACE_AT] = job_words[RAYA_OBJECT_SURFACE_AT];
            if (words == RAYA_POLYGON_WORDS) check_outline(node_words, job_words);
            if (node_words != job_words) FAIL("the words of object " << numbers[i] << " differ from the job's");
        }
    }

    // Compares the rows of the spheres, which start at a multiple of four words, and the surface offsets that follow
    // the rows.
    void check_spheres(const raya_objects& node_objects, const Words& numbers) {
        const raya_objects& all = header_.objects;
        const std::uint32_t node_surfaces_at = raya_sphere_surfaces_at(node_objects.spheres_at, node_objects.spheres);
        const std::uint32_t job_surfaces_at = raya_sphere_surfaces_at(all.spheres_at, all.spheres);
        CHECK(node_objects.spheres_at % 4 == 0);
        for (std::uint32_t i = 0; i < numbers.size(); ++i) {
            const Words row = node_.section(node_objects.spheres_at + i * RAYA_SPHERE_WORDS, RAYA_SPHERE_WORDS);
            if (row != job_section(all.spheres_at + numbers[i] * RAYA_SPHERE_WORDS, RAYA_SPHERE_WORDS))
                FAIL("the words of sphere " << numbers[i] << " differ from the job's");
            check_surface(node_.section(node_surfaces_at + i, 1)[0], job_section(job_surfaces_at + numbers[i], 1)[0]);
        }
    }

    void check_surface(std::uint32_t node_at, std::uint32_t job_at) {
        const auto [entry, is_new] = surfaces_.try_emplace(job_at, node_at);
        if (entry->second != node_at)
            FAIL("the node has two copies of the surface at word " << job_at << " of the job");
        if (is_new && node_.section(node_at, RAYA_SURFACE_WORDS) != job_section(job_at, RAYA_SURFACE_WORDS))
            FAIL("the words of the surface at word " << job_at << " of the job differ from the job's");
    }

    // Checks that the surfaces follow the header without gaps, in the job's order.
    void check_surfaces() const {
        std::uint32_t at = sizeof(raya_node) / 4;
        for (const auto& [job_at, node_at] : surfaces_) {
            CHECK(node_at == at);
            at += RAYA_SURFACE_WORDS;
        }
    }

    const raya_job& header() const { return header_; }

  private:
    // Compares corners and normals. Then overwrites the polygon's offsets of corners and normals with those of the job.
    void check_outline(Words& node_words, const Words& job_words) {
        const std::size_t corners = job_words[RAYA_POLYGON_CORNERS] * RAYA_CORNER_WORDS;
        if (node_.section(node_words[RAYA_POLYGON_CORNERS_AT], corners) !=
            job_section(job_words[RAYA_POLYGON_CORNERS_AT], corners))
            FAIL("the corners of a polygon differ from the job's");
        if ((node_words[RAYA_POLYGON_NORMALS_AT] == 0) != (job_words[RAYA_POLYGON_NORMALS_AT] == 0))
            FAIL("a polygon is a patch in only one of node and job");
        if (job_words[RAYA_POLYGON_NORMALS_AT] != 0 &&
            node_.section(node_words[RAYA_POLYGON_NORMALS_AT], RAYA_PATCH_WORDS) !=
                job_section(job_words[RAYA_POLYGON_NORMALS_AT], RAYA_PATCH_WORDS))
            FAIL("the normals of a patch differ from the job's");
        node_words[RAYA_POLYGON_CORNERS_AT] = job_words[RAYA_POLYGON_CORNERS_AT];
        node_words[RAYA_POLYGON_NORMALS_AT] = job_words[RAYA_POLYGON_NORMALS_AT];
    }

    const PackedJob& job_;
    const raya_job header_;
    NodeReader& node_;
    std::map<std::uint32_t, std::uint32_t> surfaces_;  // word offset in the job -> in the node
};

// Compares all header words except the offsets, which are the members named *_at.
void check_header(const raya_node& node, const raya_job& job, const Partition& partition, const raya_torus& torus) {
    raya_job expected = job;
    expected.lights_at = node.job.lights_at;
    expected.objects = {};
    expected.objects.planes = job.objects.planes;
    expected.objects.planes_at = node.job.objects.planes_at;
    CHECK(std::memcmp(&node.job, &expected, sizeof expected) == 0);
    CHECK(std::memcmp(&node.torus, &torus, sizeof torus) == 0);
    CHECK(std::memcmp(&node.grid, &partition.grid, sizeof node.grid) == 0);
    CHECK(node.voxels == raya_node_voxels(torus, partition.grid, node.number));
}

// Returns the numbers of a voxel's list that lie in [first, last).
Words numbers_between(const Words& list, std::uint32_t first, std::uint32_t last) {
    Words numbers;
    std::copy_if(list.begin(), list.end(), std::back_inserter(numbers), [&](auto n) { return first <= n && n < last; });
    return numbers;
}

void check_voxel(NodeCheck& check, NodeReader& node, const raya_voxel_memory& voxel, const Words& list) {
    const raya_objects &node_objects = voxel.objects, all = check.header().objects;
    const std::uint32_t polygon = all.spheres + all.planes, cone = polygon + all.polygons;
    const Words spheres = numbers_between(list, 0, all.spheres), polygons = numbers_between(list, polygon, cone);
    const Words cones = numbers_between(list, cone, cone + all.cones);
    CHECK(node_objects.spheres == spheres.size());
    CHECK(node_objects.polygons == polygons.size());
    CHECK(node_objects.cones == cones.size());
    CHECK((node_objects.planes == all.planes && node_objects.planes_at == node.header().job.objects.planes_at));
    CHECK(voxel.first_plane == all.spheres);
    CHECK(node.section(voxel.numbers_at, list.size()) == list);
    check.check_spheres(node_objects, spheres);
    check.check_objects(node_objects.polygons_at, RAYA_POLYGON_WORDS, polygons, polygon, all.polygons_at);
    check.check_objects(node_objects.cones_at, RAYA_CONE_WORDS, cones, cone, all.cones_at);
}

void check_node(const PackedJob& job, const Partition& partition, const raya_torus& torus, NodeReader& node) {
    NodeCheck check(job, node);
    const raya_job& all = check.header();
    check_header(node.header(), all, partition, torus);
    const std::size_t lights = all.lights * RAYA_LIGHT_WORDS;
    CHECK(node.section(node.header().job.lights_at, lights) == check.job_section(all.lights_at, lights));
    Words planes(all.objects.planes);
    for (std::uint32_t i = 0; i < planes.size(); ++i) planes[i] = i;
    check.check_objects(node.header().job.objects.planes_at, RAYA_PLANE_WORDS, planes, 0, all.objects.planes_at);
    for (std::uint32_t local = 0; local < node.header().voxels; ++local) {
        const std::uint32_t voxel = raya_voxel_of_node(torus, partition.grid, node.header().number, local);
        const auto first = partition.objects.begin() + partition.starts[voxel];
        check_voxel(check, node, node.voxel(local), {first, partition.objects.begin() + partition.starts[voxel + 1]});
    }
    check.check_surfaces();
    // Only the padding before sphere rows was not read, and no word was read twice.
    CHECK(node.words_read(1) + node.words_read(0) == node.size());
    CHECK(node.words_read(0) <= 3 * (node.header().voxels + 1));
}

// Returns the number of objects of each node, counted from the lists.
std::vector<std::uint64_t> objects_of_nodes(const PackedJob& job, const Partition& p, const raya_torus& torus) {
    std::vector<std::uint64_t> objects(raya_nodes(torus), job.header().objects.planes);
    for (std::uint32_t voxel = 0; voxel < raya_voxels(p.grid); ++voxel)
        objects[raya_node_of_voxel(torus, p.grid, voxel)] += p.starts[voxel + 1] - p.starts[voxel];
    return objects;
}

}  // namespace

TEST_CASE("nodes hold copies of the job's objects in their voxels, and nothing else", "[torus]") {
    std::size_t objects = 0, empty_nodes = 0, multi_voxel_nodes = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        SplitMix random(seed);
        const PackedJob job = pack(random_objects(random, 4));
        const raya_torus torus = random_torus(random, 4);
        const Divisions divisions = random_sides(random, 6);
        const Partition partition = random_partition(random, job, divisions, 8);
        const NodeMemories memories = pack_all(job, partition, torus);
        CAPTURE(seed, torus_text(torus), sides_text(divisions));
        REQUIRE(memories.starts.size() == raya_nodes(torus) + 1);
        REQUIRE(memories.starts.back() == memories.words.size());
        std::vector<std::uint64_t> words;
        for (std::uint32_t number = 0; number < raya_nodes(torus); ++number) {
            CAPTURE(number);
            NodeReader node(memories, number);
            REQUIRE(node.header().number == number);
            check_node(job, partition, torus, node);
            words.push_back(node.size());
            empty_nodes += node.header().voxels == 0;
            multi_voxel_nodes += node.header().voxels > 1;
        }
        const NodeSizes sizes = node_sizes(job, partition, torus);
        CHECK(sizes.words == words);
        CHECK(sizes.words[sizes.fullest()] == *std::max_element(words.begin(), words.end()));
        CHECK(sizes.copies == partition.objects.size() - finite_objects(job).size());
        CHECK(sizes.objects == objects_of_nodes(job, partition, torus));
        objects += partition.objects.size();
    }
    CHECK(objects > 5000);
    CHECK(empty_nodes > 100);        // number of nodes without a voxel
    CHECK(multi_voxel_nodes > 100);  // number of nodes with several voxels
}

TEST_CASE("a node holds only the surfaces of its own objects and of the planes", "[torus]") {
    Scene scene = empty_scene();
    scene.lights.clear();
    scene.surfaces.assign(5, {});
    for (int i = 0; i < 4; ++i) scene.spheres.push_back({{0, 0, 0}, 1, i});
    const auto words_of = [](const Scene& s) {
        const PackedJob job = pack(s);
        const NodeMemories memories =
            pack_all(job, partition_of({2, 1, 1}, {{0, 1, 2}, {3}}), make_torus({2, 1, 1}, Links::kTorus3d));
        return std::vector<std::size_t>{memories.starts[1], memories.words.size() - memories.starts[1]};
    };
    const auto whole_rows = [](std::size_t words) { return (words + 3) / 4 * 4; };
    const auto node_words = [&](std::size_t spheres, std::size_t surfaces, std::size_t planes) {
        const std::size_t words_before_spheres = (sizeof(raya_node) + sizeof(raya_voxel_memory)) / 4 +
                                                 surfaces * RAYA_SURFACE_WORDS + planes * RAYA_PLANE_WORDS;
        return whole_rows(whole_rows(words_before_spheres) +
                          spheres * (RAYA_SPHERE_WORDS + 2));  // + 2: words for the sphere's surface and number
    };
    CHECK(words_of(scene) == std::vector<std::size_t>{node_words(3, 3, 0), node_words(1, 1, 0)});
    scene.spheres[2].surface = 0;
    CHECK(words_of(scene) == std::vector<std::size_t>{node_words(3, 2, 0), node_words(1, 1, 0)});
    scene.planes = {{{0, 0, 1}, 0, 4}, {{0, 1, 0}, 0, 3}};
    CHECK(words_of(scene) == std::vector<std::size_t>{node_words(3, 4, 2), node_words(1, 2, 2)});
}

TEST_CASE("nodes hold the same words on a 2-D torus as on a 3-D torus", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        SplitMix random(seed);
        const PackedJob job = pack(random_objects(random, 3));
        const auto nodes = random_sides(random, 4);
        const Partition partition = random_partition(random, job, random_sides(random, 6), 4);
        const raya_torus flat = make_torus(nodes, Links::kTorus2d), deep = make_torus(nodes, Links::kTorus3d);
        const NodeMemories flat_memories = pack_all(job, partition, flat),
                           deep_memories = pack_all(job, partition, deep);
        CAPTURE(seed, torus_text(flat));
        for (std::uint32_t number = 0; number < raya_nodes(flat); ++number) {
            const raya_place place = raya_node_place(flat, number);
            NodeReader a(flat_memories, number),
                b(deep_memories, raya_node_of(deep, place.at[0], place.at[1], place.at[2]));
            REQUIRE(a.size() == b.size());
            const std::size_t header = sizeof(raya_node) / 4, rest = a.size() - header;
            CHECK(a.section(header, rest) == b.section(header, rest));
        }
    }
}

TEST_CASE("nodes with more than 2^30 words in total are refused before they are packed", "[torus]") {
    Scene scene = empty_scene();
    Polygon disc;  // 100,000 corners, 400,000 words, in each of 4,096 voxels
    for (int i = 0; i < 100'000; ++i) disc.vertices.emplace_back(std::cos(i * 6.28e-5), std::sin(i * 6.28e-5), 0);
    scene.polygons.push_back(disc);
    const PackedJob job = pack(scene);
    const Partition everywhere = partition_of({16, 16, 16}, std::vector<std::set<std::uint32_t>>(4096, {0}));
    const raya_torus torus = make_torus({4, 4, 4}, Links::kTorus3d);
    const NodeSizes sizes = node_sizes(job, everywhere, torus);
    CHECK(sizes.words[sizes.fullest()] > 64 * 400'000);
    std::vector<std::uint32_t> nodes(64);
    std::iota(nodes.begin(), nodes.end(), 0);
    CHECK_THAT(user_error_message([&] { check_words(sizes, nodes); }),
               Contains("64 nodes, 4096 voxels") && Contains("of 64 nodes") && Contains("fewer"));
    CHECK_NOTHROW(check_words(sizes, std::span(nodes).first(32)));  // a rank's part
}

TEST_CASE("a partition whose number of voxels differs from its grid's is an error", "[torus]") {
    const PackedJob job = pack(empty_scene());
    Partition partition = empty_partition({2, 2, 2});
    partition.starts.pop_back();
    CHECK_THROWS_AS(pack_all(job, partition, make_torus({2, 2, 2}, Links::kTorus3d)), std::logic_error);
}
