#include "host/model/machine.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "host/error.hpp"
#include "host/model/budget.hpp"
#include "host/model/t805.hpp"

namespace raya {
namespace {

// Kohata & Ito 1993. Marks: [P] printed there, [D] derived from printed figures, [?] assumed here. The paper gives no
// time of a transfer between PEs over the bus: the model uses the rate of a link and the overhead of a rotation [?].
Machine spa() {
    return {
        .name = "spa",
        .title = "the SPA",
        .topology = "ring+bus",                          // [P]
        .pes = 256,                                      // [P] DSPs
        .pe_memory_bytes = 32 * 1024,                    // [P]
        .bounces = 8,                                    // [P] at most 8 reflections and refractions
        .format = {6, 15, false},                        // [P] 22 bits; [?] their division into exponent and fraction
        .mapping = cyclic_mapping(16),                   // [P] the offset with the smallest imbalance
        .cycle_ns = 100,                                 // [P] 20 MFLOPS
        .link_words_per_s = 6e6,                         // [P] DMA
        .rotation_sync_ms = 10. / 32 - 1e3 * 768 / 6e6,  // [D] Tables 3, 4: 32 more rotations of 768 words take 10 ms
        .host_words_per_s = 196'608 / 0.140};            // [D] Table 2: 256 x 256 pixels of 3 words in 140 ms
}

// Returns an array with a mapping that the paper compares with the SPA's. The array's PEs are those of the SPA without
// a memory limit, so that loads can be compared. The array has no modelled times, because the rates of the real PEs and
// links are unknown.
Machine array_of_spa_pes(const std::string& name, const std::string& title, const std::string& topology,
                         const MappingRule& mapping, std::uint32_t pes) {
    Machine machine;
    machine.name = name;
    machine.title = title;
    machine.topology = topology;
    machine.pes = pes;
    machine.format = spa().format;
    machine.mapping = mapping;
    return machine;
}

// [P] When a PE has finished a pixel, it requests the next one from a root PE. [?] The array has as many PEs as the
// SPA.
Machine links() {
    Machine machine =
        array_of_spa_pes("links", "an array as LINKS-1's, on PEs of the SPA", "root and nodes", cyclic_mapping(0), 256);
    machine.dynamic = DynamicPlan{.chunk = 1};
    return machine;
}

// [?] The SPA without a memory limit, with one PE per image column, fp32 and a BVH: for scenes that do not fit the SPA.
Machine grande() {
    Machine machine = spa();
    machine.name = machine.title = "grande";
    machine.pes = {};
    machine.pe_memory_bytes = {};
    machine.format = {};
    machine.accel = {AccelKind::kBvh};
    return machine;
}

// [P] The machine with one DSP in the paper's Table 2; its host is that of the SPA.
Machine spa1() {
    Machine machine = spa();
    machine.name = "spa1";
    machine.title = "the SPA with one DSP";
    machine.pes = 1;
    machine.mapping = cyclic_mapping(0);  // no effect with one PE
    return machine;
}

// Yoshitani & Yamazaki, about 1995. Marks: [P] printed there, [T] data sheet of the T805, [?] assumed here. The cycles
// of nodes and links are in model/t805.hpp. link_words_per_s is the rate of one link in one direction.
Machine torus() {
    Machine machine;
    machine.name = "torus";
    machine.title = "the torus of transputers";
    machine.kind = MachineKind::kTorus;                   // [P]
    machine.topology = "torus3d";                         // [P] a torus; [?] six links, the T805 has four
    machine.pes = 64;                                     // [P] T805s, one voxel each: 4 x 4 x 4
    machine.pe_memory_bytes = 4 * 1024 * 1024;            // [?] a T805 board
    machine.bounces = 8;                                  // [?] as on the SPA; the paper traces shadow rays only
    machine.format = {};                                  // [T] IEEE, single precision
    machine.cycle_ns = kT805CycleNs;                      // [T] 25 MHz
    machine.link_words_per_s = kT805OneWayBytesPerS / 4;  // [T]
    return machine;
}

}  // namespace

std::string accel_text(const Accel& accel) {
    if (accel.kind == AccelKind::kNone) return "none";
    if (accel.kind == AccelKind::kBvh) return "bvh";
    if (!accel.divisions) return "grid";
    const Divisions& d = *accel.divisions;
    return fmt::format("grid:{}x{}x{}", d[0], d[1], d[2]);
}

const std::vector<Machine>& machines() {
    static const std::vector<Machine> all = {
        spa(),
        grande(),
        spa1(),
        // [P] 256 cells; each has every 16th pixel in both directions [D: n = 16 if P = n x n]
        array_of_spa_pes("cap", "the array of the CAP, on PEs of the SPA", "2-D array", grid_mapping(16, 16), 256),
        // [P] 64 nodes; each has every 8th pixel of every 8th line [D]
        array_of_spa_pes("pixel-machine", "the array of the Pixel Machine, on PEs of the SPA", "2-D array",
                         grid_mapping(8, 8), 64),
        links(),
        torus(),
    };
    return all;
}

const Machine& machine_named(const std::string& name) {
    const auto& all = machines();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Machine& m) { return m.name == name; });
    if (found != all.end()) return *found;
    std::vector<std::string> names;
    for (const Machine& m : all) names.push_back(m.name);
    throw UserError(fmt::format("--machine {}: no such machine; available: {}", name, fmt::join(names, ", ")));
}

std::array<std::uint32_t, RAYA_EVENTS> cycles_of_events() {
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};
    for (std::size_t event = 0; event < cycles.size(); ++event) cycles[event] = cycles_of(budgets()[event]);
    return cycles;
}

}  // namespace raya
