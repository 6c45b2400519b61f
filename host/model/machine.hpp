// Descriptions of the array machines, and of the acceleration structure inside a PE. The acceleration structure
// determines which objects a ray is tested against, but does not change the image.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "kernels/shared/events.h"
#include "kernels/shared/job.h"

namespace raya {

using Divisions = std::array<std::uint32_t, 3>;  // numbers of voxels along x, y, z

enum class AccelKind : std::uint32_t {
    kNone = RAYA_ACCEL_NONE,  // every ray is tested against all objects
    kGrid = RAYA_ACCEL_GRID,  // uniform grid (host/accel/partition.hpp)
    kBvh = RAYA_ACCEL_BVH,    // BVH (host/accel/bvh.hpp)
};

/// The choice of an acceleration structure.
struct Accel {
    AccelKind kind = AccelKind::kNone;
    std::optional<Divisions> divisions{};  // of a grid; empty: accel_partition() chooses them
};

/// Returns the value of the option `--accel` for this choice: "none", "grid", "grid:4x4x4", "bvh".
std::string accel_text(const Accel& accel);

/// Size of an acceleration structure, for reports.
struct AccelSummary {
    AccelKind kind = AccelKind::kNone;
    std::uint64_t words = 0;  // number of 32-bit words of the structure in the job
    Divisions divisions{};    // of a grid
    // Of a grid: number of entries in the voxels' lists minus number of distinct objects in the lists.
    std::uint64_t copies = 0;
    std::uint32_t separate = 0;  // number of separate objects (docs/glossary.md)
    std::uint64_t nodes = 0;     // number of nodes of a BVH
    std::uint64_t leaves = 0;    // number of leaves of a BVH
    std::uint32_t depth = 0;     // number of nodes on the longest path from the root node of a BVH to a leaf
};

/// Thrown if the scene or image does not fit into a PE's memory.
struct DoesNotFit : UserError {
    DoesNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory)
        : UserError(message), needed_bytes(needed), memory_bytes(memory) {}

    std::uint64_t needed_bytes;  // memory that the fullest PE requires
    std::uint64_t memory_bytes;  // memory that a PE has
};

/// The number of events of each kind (RAYA_* of kernels/shared/events.h).
using EventCounts = std::array<std::uint64_t, RAYA_EVENTS>;

/// Names of a count, see RAYA_EVENT_LIST of kernels/shared/events.h.
struct EventNames {
    const char *name, *member;
};
#define RAYA_EVENT_NAMES(enumerator, name, member) EventNames{name, member},
inline constexpr std::array<EventNames, RAYA_EVENTS> kEvents = {{RAYA_EVENT_LIST(RAYA_EVENT_NAMES)}};
#undef RAYA_EVENT_NAMES

/// The kind of a machine: which data it distributes over its PEs.
enum class MachineKind {
    kRing,  // the pixels (host/ring/)
    kTorus  // the scene: the PEs are nodes that store voxels and send rays to each other (host/torus/)
};

/// Rates from which modelled_time() (model/t805.hpp) computes the time of a ring machine. An infinite rate
/// stands for a transfer that takes no time. docs/architecture.md has the origin of the SPA's numbers.
struct MachineClock {
    double cycle_ns = 0;          // time of a cycle of a PE
    double cycle_factor = 1;      // number of the machine's cycles per cycle of the budgets (model/budget.hpp)
    double link_words_per_s = 0;  // rate of a link from a PE to its neighbour, and of the bus between PEs
    double rotation_sync_ms = 0;  // overhead of one rotation, or of one transfer over the bus between PEs
    double setup_ms = 0;          // set-up of the scene's broadcast, of the image's gather, of an exchange of pixels
    double broadcast_words_per_s = 0;  // from the host to the PEs
    double gather_words_per_s = 0;     // from the PEs to the host
    double display_pixels_per_s = 0;   // display of the image

    bool operator==(const MachineClock&) const = default;
};

/// A number of a machine, as text with its unit, and its source.
struct Fact {
    std::string what, value, source;
};

/// Description of an array of PEs.
struct Machine {
    std::string name;
    std::string title;     // for messages: "the SPA"
    std::string topology;  // of the links between PEs: "ring+bus", "torus3d", ...
    MachineKind kind = MachineKind::kRing;
    std::optional<std::uint32_t> pes;              // number of PEs; empty: one per image column
    std::optional<std::uint64_t> pe_memory_bytes;  // memory of a PE; empty: no limit
    std::uint32_t bounces = 8;             // maximum number of reflections and refractions after the primary ray
    NumberFormat format{};                 // number format of the PEs' arithmetic
    MappingRule mapping{};                 // of a ring: mapping of pixels to PEs
    Accel accel{};                         // of a ring: acceleration structure in every PE
    std::optional<DynamicPlan> dynamic{};  // empty: PEs do not request pixels at run time

    MachineClock clock{};       // of a ring
    std::vector<Fact> facts{};  // numbers of the machine and their sources, for `raya machines`
};

/// Returns the machines that the option `--machine` accepts. The first is the default.
const std::vector<Machine>& machines();

/// Returns the machine called `name`. Throws UserError if there is no such machine; the message lists all machines.
const Machine& machine_named(std::string_view name);

/// Returns the modelled cycles of one event of each kind (RAYA_* of kernels/shared/events.h) on a PE of the SPA, from
/// the instruction budgets (model/budget.hpp). t805_cycles() (model/t805.hpp) returns those on a node of a torus.
std::array<std::uint32_t, RAYA_EVENTS> cycles_of_events();

}  // namespace raya
