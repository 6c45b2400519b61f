// Functions of the Python module that need no device: mappings, loads and schedules computed from given pixel costs,
// the list of machines, and the reference image.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include <numeric>

#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/error.hpp"
#include "host/model/budget.hpp"
#include "host/model/machine.hpp"
#include "host/python/session.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "host/torus/topology.hpp"
#include "tests/reference/reference.hpp"

namespace raya {
namespace {

// Returns the mapping that the keyword arguments, options of `raya render`, select. Throws UserError.
raya_mapping mapping_of(const ImageSize& size, const py::kwargs& keywords) {
    RenderOptions options;
    CLI::App app;
    add_render_options(app, options);
    options.machine = "grande";
    parse_keywords(app, keywords);
    if (is_dynamic(options.mapping))
        throw UserError(fmt::format("--mapping {}: not a static mapping; use schedule()", options.mapping));
    options.size = fmt::format("{}x{}", size.width, size.height);
    return ring_settings(options, {}).mapping;
}

ImageSize size_of(const CostImage& cost) { return {cost.width, cost.height}; }

py::array owners(const raya_mapping& mapping) {
    py::array_t<std::uint32_t> array({mapping.height, mapping.width});
    auto owner = array.mutable_unchecked<2>();
    for (std::uint32_t row = 0; row < mapping.height; ++row)
        for (std::uint32_t column = 0; column < mapping.width; ++column)
            owner(row, column) = raya_owner(mapping, row, column);
    return array;
}

py::array loads(const py::array& costs, const py::kwargs& options) {
    const CostImage cost = cost_image_of(costs);
    return copy_of(static_load(cost, mapping_of(size_of(cost), options)).per_pe);
}

py::array imbalances(const py::array& costs, std::uint32_t pes, const std::vector<std::uint32_t>& offsets,
                     const std::string& fold) {
    const CostImage cost = cost_image_of(costs);
    std::vector<double> imbalance_by_offset;
    {
        const py::gil_scoped_release no_gil;
        imbalance_by_offset = imbalance_of_offsets(
            cost, pes, parse_choice("--fold", fold, kFoldChoices) == Fold::kBlock ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC,
            offsets);
    }
    return copy_of(imbalance_by_offset);
}

// If there are at most as many PEs as slots (image columns), every PE owns whole slots. speedups() then saves time: it
// computes the loads of the slots once per offset, as an image of one row, and maps the columns of this row to the PEs.
py::array speedups(const py::array& costs, const std::vector<std::uint32_t>& pes,
                   const std::vector<std::uint32_t>& offsets, const std::string& fold) {
    const CostImage cost = cost_image_of(costs);
    if (offsets.size() != pes.size() && offsets.size() != 1)
        throw py::value_error("offsets: must have one element, or as many as pes");
    const Fold fold_kind = parse_choice("--fold", fold, kFoldChoices);
    std::vector<double> speedup_by_pes;
    CostImage slot_loads{cost.width, 1, {}};
    std::optional<std::uint32_t> slot_offset;  // offset for which slot_loads was computed
    for (std::size_t i = 0; i < pes.size(); ++i) {
        const std::uint32_t offset = offsets[offsets.size() == 1 ? 0 : i];
        const auto mapping = [&](const ImageSize& size, std::uint32_t count, std::uint32_t p) {
            return make_mapping(cyclic_mapping(p, fold_kind), size, count);
        };
        if (pes[i] > cost.width) {
            speedup_by_pes.push_back(static_load(cost, mapping(size_of(cost), pes[i], offset)).speedup);
            continue;
        }
        if (slot_offset != offset)
            slot_loads.cycles = static_load(cost, mapping(size_of(cost), cost.width, offset)).per_pe;
        slot_offset = offset;
        speedup_by_pes.push_back(static_load(slot_loads, mapping({cost.width, 1}, pes[i], 0)).speedup);
    }
    return copy_of(speedup_by_pes);
}

py::dict schedule(const py::array& costs, const std::string& plan, const py::kwargs& options) {
    const CostImage cost = cost_image_of(costs);
    const Schedule run = dynamic_schedule(cost, mapping_of(size_of(cost), options), parse_dynamic(plan));
    py::dict results;
    results["loads"] = copy_of(run.load.per_pe);
    results["requests"] = run.requests;
    results["makespan"] = run.load.max;
    results["speedup"] = run.load.speedup;
    return results;
}

// Returns the number of rotations that bring each PE the neighbours of its pixels on all four sides, if each PE sends
// all its pixels in every rotation. If every slot belongs to one PE, the number depends only on the pairs of slots that
// own neighbouring pixels. Two rows of the image have the same pairs as all rows, so that two rows are enough. Proof
// for horizontal neighbours: a row has all pairs (s, s + 1 mod W) except the pair of its last and first pixel. For an
// offset p > 0, successive rows miss different pairs; for p = 0, all rows miss the same pair.
std::uint64_t neighbour_rotations(raya_mapping mapping) {
    if (raya_has_slots(mapping) && mapping.pes <= mapping.width) mapping.height = std::min(mapping.height, 2u);
    return sum_of(exchange_moves(mapping, ExchangeMethod::kRing, false));
}

// Computes modelled times of the SPA for every offset of the cyclic mapping: the time of the busiest PE in each pass,
// the time to filter and compare neighbouring pixels, and the time of the rotations that bring these pixels. Excludes
// the times of broadcast and gather. `trace`, `supersample`: cycles of each pixel in the two passes, [H, W].
py::dict offset_times(const py::array& trace, std::uint32_t pes, const std::string& antialias,
                      const std::optional<py::array>& supersample) {
    const CostImage trace_cost = cost_image_of(trace);
    const AntialiasMethod method = parse_choice("--antialias", antialias, kAntialiasChoices);
    const MachineClock& clock = machine_named("spa").clock;
    std::vector<std::uint32_t> offsets(trace_cost.width);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const std::vector<double> u = imbalance_of_offsets(trace_cost, pes, RAYA_FOLD_CYCLIC, offsets);
    const auto busiest_ms = [&](const CostImage& cost, const std::vector<double>& imbalance) {
        const double mean = static_cast<double>(sum_of(cost.cycles)) / pes;
        std::vector<double> ms;
        for (const double offset_imbalance : imbalance) ms.push_back(compute_ms(clock, mean * (1 + offset_imbalance)));
        return ms;
    };
    std::vector<double> supersample_ms(trace_cost.width), smooth_ms(trace_cost.width), ring_ms(trace_cost.width);
    std::vector<std::uint64_t> rotations(trace_cost.width);
    if (method == AntialiasMethod::kSupersample) {
        if (!supersample) throw py::value_error("supersample: the costs of supersampling are required");
        const CostImage cost = cost_image_of(*supersample);
        supersample_ms = busiest_ms(cost, imbalance_of_offsets(cost, pes, RAYA_FOLD_CYCLIC, offsets));
    }
    if (method != AntialiasMethod::kNone)
        for (const std::uint32_t p : offsets) {
            const raya_mapping mapping = make_mapping(cyclic_mapping(p), size_of(trace_cost), pes);
            const std::uint32_t pixels = largest_share(mapping);
            const SmoothingCycles cycles = smoothing_cycles(method, pixels);
            smooth_ms[p] = compute_ms(clock, static_cast<double>(cycles.filter + cycles.compare));
            rotations[p] = neighbour_rotations(mapping);
            ring_ms[p] = exchange_ms(clock, rotations[p], 3. * static_cast<double>(rotations[p] * pixels));
        }
    py::dict arrays;
    arrays["offset"] = copy_of(offsets);
    arrays["imbalance"] = copy_of(u);
    arrays["trace_ms"] = copy_of(busiest_ms(trace_cost, u));
    arrays["smooth_ms"] = copy_of(smooth_ms);
    arrays["supersample_ms"] = copy_of(supersample_ms);
    arrays["ring_ms"] = copy_of(ring_ms);
    arrays["rotations"] = copy_of(rotations);
    return arrays;
}

py::array reference_image(const Scene& scene, std::uint32_t size, int bounces, int threads) {
    const auto side = static_cast<int>(size);
    reference::Image image;
    {
        const py::gil_scoped_release no_gil;
        image = reference::render(scene, {.width = side, .height = side, .bounces = bounces, .threads = threads});
    }
    py::array_t<double> array({side, side, 3});
    double* out = array.mutable_data();
    for (const Colour& colour : image.pixels)
        for (int channel = 0; channel < 3; ++channel) *out++ = colour[channel];
    return array;
}

py::array ranks_of_torus(const std::array<std::uint32_t, 3>& nodes, std::uint32_t ranks) {
    return copy_of(ranks_of_nodes(make_torus(nodes, Links::kTorus3d), ranks));
}

py::array link_ends(const std::array<std::uint32_t, 3>& nodes) {
    const raya_torus torus = make_torus(nodes, Links::kTorus3d);
    py::array_t<std::uint32_t> array({static_cast<std::size_t>(raya_nodes(torus)), std::size_t{RAYA_LINKS}});
    auto end = array.mutable_unchecked<2>();
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node)
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) end(node, link) = raya_link_end(torus, node, link);
    return array;
}

py::list all_machines() {
    py::list dicts;
    for (const Machine& machine : machines()) {
        py::dict fields;
        fields["name"] = machine.name;
        fields["topology"] = machine.topology;
        fields["pes"] = machine.pes;
        fields["pe_memory_bytes"] = machine.pe_memory_bytes;
        fields["bounces"] = machine.bounces;
        fields["format"] = format_name(machine.format);
        py::list facts;
        for (const Fact& fact : machine.facts) facts.append(py::make_tuple(fact.what, fact.value, fact.source));
        fields["facts"] = facts;
        if (machine.kind == MachineKind::kRing) {
            const MachineClock& clock = machine.clock;
            fields["cycle_ns"] = clock.cycle_ns;
            fields["cycle_factor"] = clock.cycle_factor;
            fields["link_words_per_s"] = clock.link_words_per_s;
            fields["rotation_sync_ms"] = clock.rotation_sync_ms;
            fields["setup_ms"] = clock.setup_ms;
            fields["broadcast_words_per_s"] = clock.broadcast_words_per_s;
            fields["gather_words_per_s"] = clock.gather_words_per_s;
            fields["display_pixels_per_s"] = clock.display_pixels_per_s;
            fields["root_cycles"] = machine.dynamic ? machine.dynamic->root_cycles : 0;
        }
        dicts.append(fields);
    }
    return dicts;
}

}  // namespace

void add_loads(py::module_& module) {
    const auto add_mapping_function = [&](const char* name, auto function, const char* help) {
        module.def(
            name,
            [function](std::uint32_t width, std::uint32_t height, const py::kwargs& options) {
                return function(mapping_of({width, height}, options));
            },
            py::arg("width"), py::arg("height"), help);
    };
    add_mapping_function(
        "owners", owners,
        "uint32 [height, width]: the PE that owns each pixel. Keyword arguments of this and the other functions of "
        "mappings: the options of raya render --machine grande, such as mapping, offset, fold and pes. Raises "
        "ValueError.");
    add_mapping_function("rotations", neighbour_rotations,
                         "Number of rotations of the ring that bring each PE the neighbours of its pixels from all "
                         "four sides, if every PE sends all its pixels in each rotation.");
    add_mapping_function("largest_share", largest_share, "Number of pixels of the PE that owns the most pixels.");
    module.def("loads", loads, py::arg("cost"),
               "uint64 [P]: the load of each PE in modelled cycles, the sum of its pixels' costs. cost: integers "
               "[H, W], the cost of each pixel.");
    module.def("imbalances", imbalances, py::arg("cost"), py::arg("pes"), py::arg("offsets"),
               py::arg("fold") = "cyclic",
               "float64 [n]: u = (max - mean) / mean of the loads with the cyclic mapping, for each of the n offsets.");
    module.def(
        "speedups", speedups, py::arg("cost"), py::arg("pes"), py::arg("offsets"), py::arg("fold") = "cyclic",
        "float64 [n]: sum / max of the loads with the cyclic mapping, for each number of PEs pes[i] with the offset "
        "offsets[i]. If offsets has one element, it is the offset for all numbers of PEs.");
    module.def(
        "schedule", schedule, py::arg("cost"), py::arg("plan"),
        "Simulates a dynamic or hybrid distribution of pixels. plan: 'dynamic:CHUNK[,OVERHEAD[,ROOT]]' or "
        "'hybrid:CHUNK[,OVERHEAD[,SHARE[,ROOT]]]' with CHUNK in pixels per request, OVERHEAD in cycles of the PE per "
        "request, SHARE as the fraction of each PE's pixels that is assigned statically, and ROOT in cycles of the "
        "root, which answers one request at a time. Keyword arguments: the mapping of the static part. Returns a "
        "dict: loads (uint64 [P]: finishing time of each PE in cycles), requests (number of requests to the root), "
        "makespan (cycles), speedup (total cycles / makespan).");
    module.def(
        "lower_bound", [](const py::array& costs, std::uint32_t pes) { return lower_bound(cost_image_of(costs), pes); },
        py::arg("cost"), py::arg("pes"), "Lower bound in cycles of any distribution of whole pixels over P PEs.");
    module.def(
        "offset_times", offset_times, py::arg("cost"), py::arg("pes"), py::arg("antialias") = "none",
        py::arg("supersample") = py::none(),
        "Modelled ms that the SPA takes with each offset of the cyclic mapping, without broadcast and gather. cost, "
        "supersample: modelled cycles of each pixel in the two passes, [H, W]. Returns a dict of arrays [W]: offset, "
        "imbalance (of the first pass), trace_ms and supersample_ms (of the busiest PE), smooth_ms (filter and "
        "comparison), ring_ms (exchange of neighbours), rotations (number of rotations).");
    module.def(
        "ranks_of_pes", [](std::uint32_t pes, std::uint32_t ranks) { return copy_of(ranks_of_pes(pes, ranks)); },
        py::arg("pes"), py::arg("ranks"), "uint32 [P]: the MPI rank of each PE of a ring.");
    module.def("ranks_of_nodes", ranks_of_torus, py::arg("nodes"), py::arg("ranks"),
               "uint32 [nodes]: the MPI rank of each node of a 3-D torus. nodes: number of nodes (I, J, K).");
    module.def("link_ends", link_ends, py::arg("nodes"),
               "uint32 [nodes, 6]: the node at the other end of each link +x, -x, +y, -y, +z, -z of each node of a 3-D "
               "torus. nodes: number of nodes (I, J, K) along x, y and z.");
    module.def("machines", all_machines,
               "Returns all machines, as a list of dicts. None means: for pes, one PE per image column; for "
               "pe_memory_bytes, no limit; for a rate, unknown.");
    module.def("reference", reference_image, py::arg("scene"), py::arg("size"), py::arg("bounces") = 8,
               py::arg("threads") = 2,
               "float64 [size, size, 3]: linear red, green and blue of the image of the double-precision reference.");
}

}  // namespace raya
