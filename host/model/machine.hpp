// The array machines as data: each number with its source; and what decides inside a PE which objects a ray is tested
// against, never which one it hits.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "kernels/shared/accel.h"
#include "kernels/shared/events.h"

namespace raya {

using Divisions = std::array<std::uint32_t, 3>;  // voxels along x, y, z

enum class AccelKind : std::uint32_t {
    kNone = RAYA_ACCEL_NONE,  // every ray is tested against all objects
    kGrid = RAYA_ACCEL_GRID,  // voxels (host/accel/partition.hpp)
    kBvh = RAYA_ACCEL_BVH,    // a tree of boxes (host/accel/tree.hpp)
};

/// How rays find their nearest hit.
struct Accel {
    AccelKind kind = AccelKind::kNone;
    std::optional<Divisions> divisions{};  // of a grid over the whole scene's box; empty: see accel_partition
};

/// What `--accel` takes: "none", "grid", "grid:4x4x4", "bvh".
std::string accel_text(const Accel& accel);

/// What was made of it, for reports.
struct AccelSummary {
    AccelKind kind = AccelKind::kNone;
    std::uint64_t words = 0;   // of the job that hold it
    Divisions divisions{};     // of a grid
    std::uint64_t copies = 0;  // entries of a grid's lists beyond each object's first
    std::uint32_t apart = 0;   // finite objects in no list and no leaf, which every ray is tested against
    std::uint64_t nodes = 0;   // of a tree
    std::uint64_t leaves = 0;
    std::uint32_t depth = 0;  // nodes on a tree's longest way down
};

/// The refusal of what a PE's memory cannot hold.
struct DoesNotFit : UserError {
    DoesNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory)
        : UserError(message), needed_bytes(needed), memory_bytes(memory) {}

    std::uint64_t needed_bytes, memory_bytes;  // what a PE, the fullest of them, would have to hold, and what it can
};

/// How many events of each kind (RAYA_* of kernels/shared/events.h) were counted.
using EventCounts = std::array<std::uint64_t, RAYA_EVENTS>;

/// What a machine divides among its PEs.
enum class MachineKind {
    kRing,  // the pixels (host/ring/)
    kTorus  // the scene: its PEs are nodes that hold voxels and send rays to each other (host/torus/)
};

/// An array of PEs as a description. Empty optionals follow the image or have no limit.
struct Machine {
    std::string name;
    std::string title;     // for messages: "the SPA"
    std::string topology;  // how the PEs are joined
    MachineKind kind = MachineKind::kRing;
    std::optional<std::uint32_t> pes;              // empty: as many as the image has columns
    std::optional<std::uint64_t> pe_memory_bytes;  // empty: no limit
    std::uint32_t bounces = 8;
    NumberFormat format{};                 // that its PEs compute in
    MappingRule mapping{};                 // pixels to PEs, of a ring
    Accel accel{};                         // how rays find their hits inside a PE of a ring
    std::optional<DynamicPlan> dynamic{};  // where its PEs take their pixels while it runs

    // Rates of the time model (machine/time_model.hpp); empty where they are not known.
    std::optional<double> cycle_ns;          // of a PE, one multiply-accumulate
    std::optional<double> link_words_per_s;  // of one PE to its neighbour, and over the bus to any
    std::optional<double> rotation_sync_ms;  // what a rotation, or a PE's turn on the bus, takes beside its words
    std::optional<double> host_words_per_s;  // broadcast and gather
};

/// The machines that `--machine` knows, the default first.
const std::vector<Machine>& machines();

/// The machine of that name; UserError lists those there are.
const Machine& machine_named(const std::string& name);

/// Modelled cycles of one event of each kind (RAYA_* of kernels/shared/events.h) on a PE of the SPA: those of its
/// instruction budget (machine/budget.hpp). A torus's nodes have t805_cycles() (machine/t805.hpp).
std::array<std::uint32_t, RAYA_EVENTS> cycles_of_events();

}  // namespace raya
