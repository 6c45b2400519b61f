#include "host/model/machine.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "host/model/budget.hpp"
#include "host/model/t805.hpp"

namespace raya {
namespace {

// Marks of sources: [P] printed in the paper that describes the machine, [D] derived from printed figures, [T] data
// sheet, [?] assumed here.

constexpr double kInfiniteRate = std::numeric_limits<double>::infinity();  // rate of a transfer that takes no time

std::string rate_text(double per_s, const char* unit) {
    return per_s == kInfiniteRate ? "takes no time" : fmt::format("{:.4g} M{}/s", 1e-6 * per_s, unit);
}

std::string memory_text(const std::optional<std::uint64_t>& bytes) {
    return bytes ? fmt::format("{} KB", *bytes / 1024) : "no limit";
}

/// Sources of a machine's numbers, by the name of the number.
using Sources = std::map<std::string, std::string>;

Sources spa_sources() {
    return {{"PEs", "[P] 256 DSPs"},
            {"memory of a PE", "[P]"},
            {"reflections and refractions", "[P]"},
            {"number format", "[P] 22 bits; [?] their division into 1 sign, 6 exponent and 15 fraction bits"},
            {"mapping of pixels", "[P] the offset with the smallest imbalance"},
            {"cycle of a PE", "[P] 100 ns, 20 MFLOPS: one multiply-accumulate a cycle"},
            {"cycles per budget cycle",
             "[D] Tables 3 and 4: the filter's arithmetic takes 7 ms (9 - 2 and 19 - 12); its budget is 1.0752 ms"},
            {"link to a neighbour", "[P] DMA; [?] the bus between PEs has the same rate"},
            {"synchronisation of a rotation", "[D] Table 4: 34 rotations of 768 words take 10 ms longer than 2"},
            {"set-up of a transfer",
             "[D] Table 4: 2 ms minus the time of 2 rotations; [?] a broadcast or gather takes the same"},
            {"broadcast by the host", "[?] as the gather"},
            {"gather of the image", "[D] Table 2: 140 ms for 256 x 256 pixels of 3 words"},
            {"display", "[P] Table 2: 1,130 ms for 256 x 256 pixels"}};
}

/// Returns the facts of a ring machine. Numbers that are not in `sources` have the source of the SPA's.
std::vector<Fact> ring_facts(const Machine& m, const std::string& mapping, Sources sources = {}) {
    sources.merge(spa_sources());
    const MachineClock& c = m.clock;
    std::vector<Fact> facts = {{"PEs", m.pes ? fmt::format("{}", *m.pes) : "one per image column", ""},
                               {"memory of a PE", memory_text(m.pe_memory_bytes), ""},
                               {"reflections and refractions", fmt::format("at most {}", m.bounces), ""},
                               {"number format", format_name(m.format), ""},
                               {"mapping of pixels", mapping, ""},
                               {"cycle of a PE", fmt::format("{:g} ns", c.cycle_ns), ""},
                               {"cycles per budget cycle", fmt::format("{:.4g}", c.cycle_factor), ""},
                               {"link to a neighbour", rate_text(c.link_words_per_s, "words"), ""},
                               {"synchronisation of a rotation", fmt::format("{:g} ms", c.rotation_sync_ms), ""},
                               {"set-up of a transfer", fmt::format("{:g} ms", c.setup_ms), ""},
                               {"broadcast by the host", rate_text(c.broadcast_words_per_s, "words"), ""},
                               {"gather of the image", rate_text(c.gather_words_per_s, "words"), ""},
                               {"display", rate_text(c.display_pixels_per_s, "pixels"), ""}};
    for (Fact& fact : facts) fact.source = sources.at(fact.what);
    return facts;
}

// Kohata & Ito 1993. The clock is derived from the printed times in Tables 2 to 4, each rounded to 1 ms;
// docs/architecture.md has the derivation.
MachineClock spa_clock() {
    constexpr double kRotationMs = (12. - 2) / (34 - 2);  // Table 4: exchanges with 34 and 2 rotations
    constexpr double kColumnWords = 256 * 3, kImageWords = 256 * kColumnWords;
    MachineClock clock;
    clock.cycle_ns = 100;
    clock.cycle_factor = 7 / (1e-6 * clock.cycle_ns * static_cast<double>(filter_cycles(256)));
    clock.link_words_per_s = 6e6;
    clock.rotation_sync_ms = kRotationMs - 1e3 * kColumnWords / clock.link_words_per_s;
    clock.setup_ms = 2 - 2 * kRotationMs;
    clock.broadcast_words_per_s = clock.gather_words_per_s = 1e3 * kImageWords / (140 - clock.setup_ms);
    clock.display_pixels_per_s = 1e3 * 256 * 256 / 1130;
    return clock;
}

Machine spa() {
    Machine machine = {.name = "spa",
                       .title = "the SPA",
                       .topology = "ring+bus",  // [P]
                       .pes = 256,
                       .pe_memory_bytes = 32 * 1024,
                       .bounces = 8,
                       .format = {6, 15, false},
                       .mapping = cyclic_mapping(16),
                       .clock = spa_clock()};
    machine.facts = ring_facts(machine, "cyclic, offset 16");
    return machine;
}

// The SPA without a memory limit, with one PE per image column, fp32 and a BVH: for scenes that do not fit the SPA.
Machine grande() {
    Machine machine = spa();
    machine.name = machine.title = "grande";
    machine.pes = {};
    machine.pe_memory_bytes = {};
    machine.format = {};
    machine.accel = {AccelKind::kBvh};
    const std::string source = "[?] no machine of the papers";
    machine.facts = ring_facts(machine, "cyclic, offset 16",
                               {{"PEs", source}, {"memory of a PE", source}, {"number format", source}});
    return machine;
}

// The machine with one DSP in the paper's Table 2; its host is that of the SPA.
Machine spa1() {
    Machine machine = spa();
    machine.name = "spa1";
    machine.title = "the SPA with one DSP";
    machine.pes = 1;
    machine.mapping = cyclic_mapping(0);  // no effect with one PE
    machine.facts = ring_facts(machine, "cyclic, offset 0",
                               {{"PEs", "[P] Table 2"}, {"mapping of pixels", "no effect with one PE"}});
    return machine;
}

// Returns an array with a mapping that the paper compares with the SPA's. Its PEs are those of the SPA without a memory
// limit, so that loads can be compared.
Machine array_of_spa_pes(const std::string& name, const std::string& title, const std::string& topology,
                         const MappingRule& mapping, std::uint32_t pes) {
    Machine machine = spa();
    machine.name = name;
    machine.title = title;
    machine.topology = topology;
    machine.pes = pes;
    machine.pe_memory_bytes = {};
    machine.mapping = mapping;
    return machine;
}

/// Returns the sources of an array_of_spa_pes(): those of `own`, else "as the SPA".
Sources compared_sources(Sources own) {
    own.insert({{"memory of a PE", "[?] no limit, so that loads can be compared"},
                {"gather of the image", "[P] PEs hold the frame buffer"},
                {"display", "[P] PEs hold the frame buffer"}});
    for (const auto& [what, source] : spa_sources()) own.insert({what, "[?] as the SPA"});
    return own;
}

// "Cellular Array Processor CAP and Applications", doi:10.1007/BF00932066, 1989 (abstract): 256 cells; an interface
// chip with two buses for broadcasts, 2 MB/s each, and six serial ports, 15 Mbit/s each; every cell holds and displays
// its part of the image.
Machine cap() {
    Machine machine =
        array_of_spa_pes("cap", "the array of the CAP, on PEs of the SPA", "2-D array", grid_mapping(16, 16), 256);
    constexpr double kWordBytes = 4;
    machine.clock.link_words_per_s = 15e6 / 8 / kWordBytes;
    machine.clock.broadcast_words_per_s = 2e6 / kWordBytes;
    machine.clock.gather_words_per_s = machine.clock.display_pixels_per_s = kInfiniteRate;
    machine.clock.rotation_sync_ms = machine.clock.setup_ms = 0;
    machine.facts = ring_facts(
        machine, "grid:16x16",
        compared_sources(
            {{"PEs", "[P] 256 cells"},
             {"mapping of pixels", "[P] Kohata & Ito 1993, Fig. 5: every 16th pixel in both directions"},
             {"link to a neighbour", "[P] six serial ports of 15 Mbit/s; [?] words of 4 bytes"},
             {"synchronisation of a rotation", "[?] not printed: taken as 0"},
             {"set-up of a transfer", "[?] not printed: taken as 0"},
             {"broadcast by the host", "[P] common bus of 2 MB/s; [?] words of 4 bytes, one of the two buses"},
             {"gather of the image", "[P] every cell displays its own pixels over the video bus"},
             {"display", "[P] every cell displays its own pixels over the video bus"}}));
    return machine;
}

// Potmesil & Hoffert 1989: m x n pixel nodes, each with every m-th pixel of every n-th scan line, behind a pipeline of
// pipe nodes. The scene passes the pipeline on its way to the pixel nodes.
Machine pixel_machine() {
    Machine machine = array_of_spa_pes("pixel-machine", "the array of the Pixel Machine, on PEs of the SPA",
                                       "pipeline and 2-D array", grid_mapping(8, 8), 64);
    machine.clock.cycle_ns = 200;
    machine.clock.gather_words_per_s = machine.clock.display_pixels_per_s = kInfiniteRate;
    machine.facts = ring_facts(
        machine, "grid:8x8",
        compared_sources({{"PEs", "[P] 64 pixel nodes"},
                          {"mapping of pixels", "[P] every m-th pixel on every n-th scan line; [D] m = n = 8"},
                          {"cycle of a PE",
                           "[D] 820 MFLOPS of 82 nodes are two operations in 200 ns; the 18 pipe nodes only pass the "
                           "scene on"}}));
    return machine;
}

// Nishimura et al. 1982 and 1985: a root computer and up to 256 node computers in a star. An idle node requests work
// from the root, which serves one node at a time; nodes write pixels into the frame memory through a FIFO.
Machine links() {
    Machine machine = array_of_spa_pes("links", "an array like LINKS-1's, on PEs of the SPA", "root and nodes",
                                       cyclic_mapping(0), 256);
    machine.clock.gather_words_per_s = machine.clock.display_pixels_per_s = kInfiniteRate;
    const MachineClock& c = machine.clock;
    const double request_ms = 2 * c.rotation_sync_ms + 1e3 * 3 / c.link_words_per_s;
    const double cycle_ms = compute_ms(c, 1);
    machine.dynamic = DynamicPlan{.root_cycles = static_cast<std::uint64_t>(std::lround(request_ms / cycle_ms))};
    machine.facts = ring_facts(
        machine, "dynamic",
        compared_sources({{"PEs", "[P] up to 256 node computers and a root"},
                          {"mapping of pixels", "[P] idle nodes request pixels from the root; [?] one pixel a request"},
                          {"gather of the image", "[P] pixels pass a FIFO to the frame memory without conflicts"},
                          {"display", "[P] pixels pass a FIFO to the frame memory without conflicts"}}));
    machine.facts.push_back(
        {"request to the root",
         fmt::format("{:.3g} ms = {} budget cycles, one at a time", request_ms, machine.dynamic->root_cycles),
         "[?] a transfer of one word and a transfer of two words over the SPA's bus"});
    return machine;
}

// Yoshitani & Yamazaki, about 1995. The cycles of nodes and links are in model/t805.hpp.
Machine torus() {
    Machine machine = {.name = "torus",
                       .title = "the torus of transputers",
                       .topology = "torus3d",
                       .kind = MachineKind::kTorus,
                       .pes = 64,
                       .pe_memory_bytes = 4 * 1024 * 1024};
    machine.facts = {
        {"nodes", "64 = 4 x 4 x 4", "[P] T805s, one voxel each"},
        {"memory of a node", memory_text(machine.pe_memory_bytes), "[?] a T805 board"},
        {"reflections and refractions", fmt::format("at most {}", machine.bounces),
         "[?] as the SPA; the paper traces shadow rays only"},
        {"number format", format_name(machine.format), "[T] IEEE single precision"},
        {"links of a node", "6", "[P] a torus; [?] six links, as a T805 has four (--links torus2d: four)"},
        {"cycle of a node", fmt::format("{:g} ns", kT805CycleNs), "[T] the 25 MHz part"},
        {"addition, multiplication, division, square root",
         fmt::format("{}, {}, {}, {} cycles", kT805AdditionCycles, kT805MultiplicationCycles, kT805DivisionCycles,
                     kT805SquareRootCycles),
         "[T] typical, single precision"},
        {"message of w words, at each end", fmt::format("{} w + {} cycles", kT805MessageWordCycles, kT805MessageCycles),
         "[T]"},
        {"link, one way; both ways",
         fmt::format("{:g}; {:g} MB/s", 1e-6 * kT805OneWayBytesPerS, 1e-6 * kT805BothWaysBytesPerS), "[T] 20 Mbit/s"}};
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
    static const std::vector<Machine> all = {spa(), grande(), spa1(), cap(), pixel_machine(), links(), torus()};
    return all;
}

const Machine& machine_named(std::string_view name) {
    const auto& all = machines();
    const auto found = std::ranges::find(all, name, &Machine::name);
    if (found != all.end()) return *found;
    std::vector<std::string> names;
    for (const Machine& machine : all) names.push_back(machine.name);
    throw UserError(fmt::format("--machine {}: no such machine; available: {}", name, fmt::join(names, ", ")));
}

std::array<std::uint32_t, RAYA_EVENTS> cycles_of_events() {
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};
    std::ranges::transform(budgets(), cycles.begin(), cycles_of);
    return cycles;
}

}  // namespace raya
