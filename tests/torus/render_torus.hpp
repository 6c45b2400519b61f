// Functions that render on the torus machine in one call. Tests that use them fail without an OpenCL device; they are
// not skipped.
#pragma once
#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_renderer.hpp"
#include "kernels/shared/traffic.h"
#include "tests/kernels/random_scene.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/scene/random_below.hpp"
#include "tests/thorough.hpp"

namespace raya {

/// Settings of a render on the torus.
struct TorusCase {
    std::uint32_t width = 20, height = 16;
    std::array<std::uint32_t, 3> nodes = {2, 2, 2};
    Divisions voxels{};  // all 0: one voxel per node
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    PacketCharge packets{};
    std::uint32_t queue = 0;                     // capacity in packets; 0: the default
    std::uint32_t lanes = default_test_lanes();  // 0: the device's default
    std::uint32_t group = 0;                     // work-items in a work-group; 0: the device's default
    std::uint32_t bounces = kTestBounces;
    std::string format = "fp32";
    PixelSubset pixels{};
    KernelSources sources{};
};

inline PacketCharge random_charge(SplitMix& random) {
    return {RAYA_PACKET_WORDS + random_below(random, 20), random.next() % 2 == 0};
}

inline TorusSettings settings_of(const TorusCase& c) {
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = c.width;
    s.height = c.height;
    s.torus = make_torus(c.nodes, c.links);
    s.links = c.links;
    s.voxels = c.voxels[0] ? c.voxels : Divisions{c.nodes[0], c.nodes[1], c.nodes[2]};
    s.inject = c.inject;
    s.packets = c.packets;
    s.queue = c.queue;
    s.pixels = c.pixels;
    s.bounces = c.bounces;
    s.format = parse_format(c.format);
    s.kernels.lanes = c.lanes;
    s.kernels.group_size = c.group;
    s.kernels.sources = c.sources;
    return s;
}

/// Returns the settings of a case in one line, for failure messages.
inline std::string case_text(const TorusCase& c) {
    return fmt::format(
        "{}x{} nodes {} voxels {} {} {} {} words a ray, a return a {}, queue {} lanes {} group {} bounces {} {} pixels "
        "{}+{}",
        c.width, c.height, sides_text(c.nodes), sides_text(c.voxels), links_name(c.links),
        c.inject == Injection::kRoot ? "root" : "all", c.packets.ray_words,
        c.packets.one_return_per_ray ? "ray" : "term", c.queue, c.lanes, c.group, c.bounces, c.format, c.pixels.first,
        c.pixels.stride);
}

inline TorusResult render_torus(Session& session, const Scene& scene, const TorusCase& c, const PacketSink& sink = {}) {
    return TorusRenderer(session, scene, settings_of(c)).render({}, {.packets = sink});
}

inline TorusResult render_torus(const Scene& scene, const TorusCase& c, const PacketSink& sink = {}) {
    Session session(choose_device(""));
    return render_torus(session, scene, c, sink);
}

/// Returns the results that must be equal on all machines, as text: image hash and ray counts. Numbers of intersection
/// tests and grid steps are omitted because they depend on the voxels. Numbers of highlights are omitted because a node
/// computes a highlight before the shadow ray to the light is traced.
inline std::string image_and_counts(const Image& image, const EventCounts& e) {
    return fmt::format("{} primary {} hits {} reflected {} refracted {} shadow {} shadow hits {} lit {} shaded {}",
                       pixel_hash(image), e[RAYA_PRIMARY], e[RAYA_PRIMARY_HITS], e[RAYA_REFLECTED], e[RAYA_REFRACTED],
                       e[RAYA_SHADOW], e[RAYA_SHADOW_HITS], e[RAYA_LIT], e[RAYA_SHADED]);
}

inline std::string image_and_counts(const TorusResult& r) { return image_and_counts(r.image, r.events); }

/// Returns image_and_counts() of a render on the ring, with the size, format and bounces of `c`. The ring tests every
/// ray against every object.
inline std::string ring_image_and_counts(const Scene& scene, const TorusCase& c) {
    const RingCase ring{.width = c.width,
                        .height = c.height,
                        .pes = 1,
                        .offset = 0,
                        .lanes = 4,
                        .group = 1,
                        .bounces = c.bounces,
                        .format = c.format};
    const RingResult r = render_scene(scene, ring);
    return image_and_counts(r.image, r.events);
}

/// Adds the packet's number of words to words[node][link] for each link of the packet's route. The routing rules define
/// this route. Returns its number of links.
inline std::uint64_t add_route(std::vector<std::uint64_t>& words, const raya_torus& torus, const PacketRecord& p) {
    std::uint64_t links = 0;
    for (std::uint32_t node = p.source; node != p.destination; ++links) {
        const bool is_return = raya_state_kind(p.head.state) == RAYA_KIND_RETURN;
        const std::uint32_t link =
            is_return ? raya_return_link(torus, node) : raya_next_link(torus, node, p.destination);
        words.at(std::size_t{node} * RAYA_LINKS + link) += p.words;
        node = raya_link_end(torus, node, link);
    }
    return links;
}

inline std::uint32_t lights_of(const Scene& scene) { return static_cast<std::uint32_t>(scene.lights.size()); }

/// Returns a scene with objects of every kind and 1 to 4 lights. The eye is among the objects, near them or far from
/// them.
inline Scene random_view_scene(std::uint64_t seed) {
    Scene scene = mixed_scene(seed);
    SplitMix random(seed ^ 0x5eed);
    const double distances[] = {0.5, 2.5, 6, 25};
    const double distance = distances[random_below(random, 4)];
    scene.view.from = distance * random_direction(random);
    scene.view.at = random_point(random, 1);
    scene.view.up = random_direction(random);
    scene.view.angle_degrees = distance > 20 ? 25 : random.uniform(30, 110);
    // A plane hides everything behind it, so the scene keeps only a random number of its planes.
    scene.planes.resize(random_below(random, scene.planes.size() + 1));
    scene.lights.resize(1 + random_below(random, 4), {random_point(random, 8), {}});
    return scene;
}

/// Seeds with which random_view_scene() has many rays of every kind and some lit points.
inline constexpr std::array<std::uint64_t, 11> kSceneSeeds = {27, 41, 53, 63, 14, 19, 35, 8, 21, 29, 69};

/// Returns a scene with objects of every kind, seen in a distant mirror. The mirror is so far away that the rays that
/// it reflects are wide (is_wide(), kernels/grid/traversal.clh).
inline Scene far_mirror_scene(std::uint64_t seed, const std::string& format) {
    Scene scene = mixed_scene(seed);
    SplitMix random(seed ^ 0xfa5);
    // In fp32, rays are wide if their origin is 1024 scene sizes away; in formats of fewer bits, if it is a few scene
    // sizes away.
    const double distance = (format == "fp32" ? 20'000 : 500) * (1 + random_below(random, 3));
    scene.surfaces.push_back({.colour = {0.9, 1, 0.9}, .diffuse = 0.5, .specular = 0.5, .shine = 5});
    scene.planes = {{{-1, 0, 0}, -distance, static_cast<int>(scene.surfaces.size()) - 1}};
    scene.view.from = {kSceneReach + 1, random.uniform(-1, 1), random.uniform(-1, 1)};
    scene.view.at = scene.view.from + Vec3{1, 0, 0};
    scene.view.angle_degrees = 200 / distance;  // the mirror image is twice as far away as the mirror
    return scene;
}

}  // namespace raya
