// What the studies of the torus machine share: renders, and the figures that they take from them.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/scenes.hpp"
#include "host/torus/history.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/torus/torus_time.hpp"

namespace raya {

/// A torus machine and its share of an image. Format, bounces and rates are those of the machine `torus`: fp32 on
/// T805s.
struct TorusPlan {
    std::array<std::uint32_t, 3> nodes{1, 1, 1};
    Divisions voxels{1, 1, 1};
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    PacketCharge packets = {};
    PixelSubset pixels = {};
    std::uint32_t queue = 0;                    // packets; 0: the renderer's default
    std::optional<std::uint32_t> bounces = {};  // empty: the machine's
    bool asynchronous = false;                  // simulated without supersteps too
};

/// Who makes primary rays, and what packets are charged for.
struct Protocol {
    const char* name;
    Injection inject;
    PacketCharge packets;
};

/// As Yoshitani & Yamazaki have it: the root sends all rays, each brings home one return, and a ray packet has the 22
/// words of their Table 1, to which data for the search and of the object come, of sizes that they do not name.
inline constexpr Protocol kProtocolOfPaper = {"Yoshitani & Yamazaki", Injection::kRoot, {paper::kRayWords, true}};
/// As raya's machine has it by default.
inline constexpr Protocol kProtocolOfRaya = {"raya", Injection::kAll, {}};

/// Figures of one render.
struct TorusRun {
    TorusPlan plan;
    raya_torus torus{};
    TorusResult result;  // without its image
    TorusTime time;
    /// Modelled, of the root: its processor, and the busiest of its links.
    double root_processor_ms = 0, root_link_ms = 0;

    std::uint32_t nodes() const { return raya_nodes(torus); }
    std::uint64_t rays() const;     // of all kinds, shadow rays among them
    std::uint64_t tests() const;    // of rays against objects of all kinds
    std::uint64_t packets() const;  // made, of all kinds
    std::uint64_t returns() const { return result.returns; }
    std::uint64_t discarded() const { return result.events[RAYA_DISCARDED]; }
    double work_ms() const;  // modelled: what all nodes compute together
    double overlapped_ms() const { return time.overlapped_ms; }
    double stepwise_ms() const { return time.stepwise_ms; }
    double asynchronous_ms() const { return time.asynchronous.value().finish_ms; }  // where the plan asked for it
    double compute_ms() const { return time.compute_ms; }
    double copies() const { return static_cast<double>(result.copies); }
    double steps() const { return static_cast<double>(result.events[RAYA_STEPS]); }
    std::size_t supersteps() const { return result.supersteps.size(); }
    double imbalance() const { return result.load.imbalance; }
    double tests_per_ray() const { return per_ray(tests()); }
    double steps_per_ray() const { return per_ray(result.events[RAYA_STEPS]); }
    double hops_per_packet() const;
    std::uint64_t busiest_link_bytes() const;  // one way
    double root_ms() const;                    // modelled: the root alone, overlapped
    std::uint64_t bytes_without_buffers() const;
    double measured_ms() const { return 1e3 * result.render_s; }

  private:
    double per_ray(std::uint64_t count) const;
};

/// `size` x `size` pixels, without a limit of memory. Where the plan's queue is too short for the machine to come to an
/// end, one of twice the length is tried, and so on up to the default; the run's plan says which it was. Not so where
/// it is simulated without supersteps, which takes one render: Standstill then. Throws
/// UserError, DeviceError as TorusRenderer does. `sink` as in TorusRenderer::render(); of a machine that stood still it
/// has been told too. `history`, where there is one: what is simulated without supersteps, if the plan asks for that.
TorusRun run_on_torus(Session& session, const LabelledScene& scene, std::uint32_t size, const TorusPlan& plan,
                      const PacketSink& sink = {}, History* history = nullptr);

/// The same machine `groups` times over, group g with the pixels p of p mod `groups` = g; the plan's own pixels are not
/// looked at. Pixels are numbered row by row.
std::vector<TorusRun> run_groups(Session& session, const LabelledScene& scene, std::uint32_t size, TorusPlan plan,
                                 std::uint32_t groups);

/// The sides of 2^n nodes or voxels that are most alike, the longer ones first: 1x1x1, 2x1x1, 2x2x1, 2x2x2, ...
/// std::invalid_argument for what is no power of two.
std::array<std::uint32_t, 3> near_cube(std::uint32_t count);

/// Scenes of the project's generators: `count` spheres spread evenly over 4 x 4 x 4 voxels, and SPD's balls.
LabelledScene even_scene(int count);
LabelledScene balls_scene(int level);

}  // namespace raya
