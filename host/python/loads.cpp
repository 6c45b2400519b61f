// Functions of the Python module that need no device: mappings, loads and schedules from given pixel costs, machines,
// and the reference image.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include <numeric>

#include "host/cli/parse.hpp"
#include "host/cli/parse_mapping.hpp"
#include "host/cli/render_options.hpp"
#include "host/error.hpp"
#include "host/model/budget.hpp"
#include "host/model/machine.hpp"
#include "host/python/session.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/route.hpp"
#include "host/ring/schedule.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/topology.hpp"
#include "tests/reference/reference.hpp"

namespace raya {
namespace {

using Number = std::optional<std::uint32_t>;

// Makes the mapping with the checks and error messages of the options of `raya render`.
raya_mapping mapping_of(const ImageSize& size, const std::string& mapping, Number offset, const std::string& fold,
                        Number pes) {
    if (is_dynamic(mapping))
        throw UserError(fmt::format("--mapping {}: not a static mapping; use schedule()", mapping));
    RenderOptions options;
    options.machine = "grande";
    options.size = fmt::format("{}x{}", size.width, size.height);
    options.mapping = mapping;
    options.fold = fold;
    options.offset = offset;
    options.pes = pes;
    return ring_settings(options, {}).mapping;
}

ImageSize size_of(const CostImage& cost) { return {cost.width, cost.height}; }

py::array owners(std::uint32_t width, std::uint32_t height, const std::string& mapping, Number offset,
                 const std::string& fold, Number pes) {
    const raya_mapping m = mapping_of({width, height}, mapping, offset, fold, pes);
    py::array_t<std::uint32_t> array({height, width});
    auto owner = array.mutable_unchecked<2>();
    for (std::uint32_t row = 0; row < height; ++row)
        for (std::uint32_t column = 0; column < width; ++column) owner(row, column) = raya_owner(m, row, column);
    return array;
}

py::array loads(const py::array& costs, const std::string& mapping, Number offset, const std::string& fold,
                Number pes) {
    const CostImage cost = cost_image_of(costs);
    return copy_of(static_load(cost, mapping_of(size_of(cost), mapping, offset, fold, pes)).per_pe);
}

py::array imbalances(const py::array& costs, std::uint32_t pes, const std::vector<std::uint32_t>& offsets,
                     const std::string& fold) {
    const CostImage cost = cost_image_of(costs);
    std::vector<double> u;
    {
        const py::gil_scoped_release free;
        u = imbalance_of_offsets(cost, pes, parse_fold(fold) == Fold::kBlock ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC,
                                 offsets);
    }
    return copy_of(u);
}

// For efficiency: if there are at most as many PEs as slots (image columns), every PE owns whole slots. The loads of
// the slots are then computed once per offset, as an image of one row whose columns are mapped to the PEs.
py::array speedups(const py::array& costs, const std::vector<std::uint32_t>& pes,
                   const std::vector<std::uint32_t>& offsets, const std::string& fold) {
    const CostImage cost = cost_image_of(costs);
    if (offsets.size() != pes.size() && offsets.size() != 1)
        throw py::value_error("offsets: must have one element, or as many as pes");
    const Fold how = parse_fold(fold);
    std::vector<double> all;
    CostImage slots{cost.width, 1, {}};
    Number of_slots;
    for (std::size_t i = 0; i < pes.size(); ++i) {
        const std::uint32_t offset = offsets[offsets.size() == 1 ? 0 : i];
        const auto mapping = [&](const ImageSize& size, std::uint32_t count, std::uint32_t p) {
            return make_mapping(cyclic_mapping(p, how), size, count);
        };
        if (pes[i] > cost.width) {
            all.push_back(static_load(cost, mapping(size_of(cost), pes[i], offset)).speedup);
            continue;
        }
        if (of_slots != offset) slots.cycles = static_load(cost, mapping(size_of(cost), cost.width, offset)).per_pe;
        of_slots = offset;
        all.push_back(static_load(slots, mapping({cost.width, 1}, pes[i], 0)).speedup);
    }
    return copy_of(all);
}

py::dict schedule(const py::array& costs, const std::string& plan, const std::string& mapping, Number offset,
                  const std::string& fold, Number pes) {
    const CostImage cost = cost_image_of(costs);
    const Schedule run =
        dynamic_schedule(cost, mapping_of(size_of(cost), mapping, offset, fold, pes), parse_dynamic(plan));
    py::dict all;
    all["loads"] = copy_of(run.load.per_pe);
    all["requests"] = run.requests;
    all["makespan"] = makespan(run);
    all["speedup"] = speedup(run, cost);
    return all;
}

// The number of rotations that bring each PE the neighbours of its pixels once from each of the four sides, if PEs pass
// on all their pixels in a rotation. If no two PEs share a slot, a pixel's owner depends only on its slot, so only the
// pairs of slots of neighbouring pixels matter, and an image of two rows has the same pairs as one of more rows. The
// only horizontal pair that a row lacks is the one across the image's left border: for an offset p > 0 the two rows
// lack different pairs, for p = 0 all rows lack the same one.
std::uint64_t neighbour_rotations(raya_mapping mapping) {
    if (raya_has_slots(mapping) && mapping.pes <= mapping.width) mapping.height = std::min(mapping.height, 2u);
    std::uint64_t rotations = 0;
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side)
        for (const Leg& leg : shortest_route(mapping.pes, neighbour_distances(mapping, side)))
            rotations += leg.rotations();
    return rotations;
}

std::uint64_t rotations(std::uint32_t width, std::uint32_t height, const std::string& mapping, Number offset,
                        const std::string& fold, Number pes) {
    return neighbour_rotations(mapping_of({width, height}, mapping, offset, fold, pes));
}

std::uint64_t exchange_rotations(std::uint32_t width, std::uint32_t height, const std::string& mapping, Number offset,
                                 const std::string& fold, Number pes) {
    return sum_of(
        exchange_moves(mapping_of({width, height}, mapping, offset, fold, pes), ExchangeMethod::kRing, false));
}

std::uint32_t share(std::uint32_t width, std::uint32_t height, const std::string& mapping, Number offset,
                    const std::string& fold, Number pes) {
    return largest_share(mapping_of({width, height}, mapping, offset, fold, pes));
}

// Modelled times of the SPA for every offset of the cyclic mapping, from the pixels' costs in cycles: times of the
// busiest PE in each pass, of filtering and comparing neighbouring pixels, and of the rotations that bring these.
// Broadcast and gather are not included. `trace`, `supersample`: costs of the two passes, [H, W].
py::dict offset_times(const py::array& trace, std::uint32_t pes, const std::string& antialias,
                      const std::optional<py::array>& supersample) {
    const CostImage first = cost_image_of(trace);
    const AntialiasMethod method = parse_antialias(antialias);
    const Machine& spa = machine_named("spa");
    std::vector<std::uint32_t> offsets(first.width);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const std::vector<double> u = imbalance_of_offsets(first, pes, RAYA_FOLD_CYCLIC, offsets);
    const auto busiest_ms = [&](const CostImage& cost, const std::vector<double>& imbalance) {
        const double mean = static_cast<double>(total_cycles(cost)) / pes;
        std::vector<double> ms;
        for (const double one : imbalance) ms.push_back(mean * (1 + one) * *spa.cycle_ns * 1e-6);
        return ms;
    };
    std::vector<double> again(first.width), smooth(first.width), ring(first.width);
    std::vector<std::uint64_t> rotations(first.width);
    if (method == AntialiasMethod::kSupersample) {
        if (!supersample) throw py::value_error("supersample: the costs of supersampling are required");
        const CostImage cost = cost_image_of(*supersample);
        again = busiest_ms(cost, imbalance_of_offsets(cost, pes, RAYA_FOLD_CYCLIC, offsets));
    }
    if (method != AntialiasMethod::kNone)
        for (const std::uint32_t p : offsets) {
            const raya_mapping mapping = make_mapping(cyclic_mapping(p), size_of(first), pes);
            const std::uint32_t share = largest_share(mapping);
            const SmoothingCycles cycles = smoothing_cycles(method, share);
            smooth[p] = static_cast<double>(cycles.filter + cycles.compare) * *spa.cycle_ns * 1e-6;
            rotations[p] = neighbour_rotations(mapping);
            const double words_ms = 1e3 * 3.0 * share / *spa.link_words_per_s;
            ring[p] = static_cast<double>(rotations[p]) * (*spa.rotation_sync_ms + words_ms);
        }
    py::dict all;
    all["offset"] = copy_of(offsets);
    all["imbalance"] = copy_of(u);
    all["trace_ms"] = copy_of(busiest_ms(first, u));
    all["smooth_ms"] = copy_of(smooth);
    all["supersample_ms"] = copy_of(again);
    all["ring_ms"] = copy_of(ring);
    all["rotations"] = copy_of(rotations);
    return all;
}

py::array reference_image(const Scene& scene, std::uint32_t size, int bounces, int threads) {
    const auto side = static_cast<int>(size);
    reference::Image image;
    {
        const py::gil_scoped_release free;
        image = reference::render(scene, {.width = side, .height = side, .bounces = bounces, .threads = threads});
    }
    py::array_t<double> array({side, side, 3});
    double* out = array.mutable_data();
    for (const Colour& colour : image.pixels)
        for (int channel = 0; channel < 3; ++channel) *out++ = colour[channel];
    return array;
}

py::array ranks_of_pes(std::uint32_t pes, std::uint32_t ranks) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t pe = 0; pe < pes; ++pe) all.push_back(rank_of_pe(pes, ranks, pe));
    return copy_of(all);
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
    py::list all;
    for (const Machine& m : machines()) {
        py::dict one;
        one["name"] = m.name;
        one["topology"] = m.topology;
        one["pes"] = m.pes;
        one["pe_memory_bytes"] = m.pe_memory_bytes;
        one["bounces"] = m.bounces;
        one["format"] = format_name(m.format);
        one["cycle_ns"] = m.cycle_ns;
        one["link_words_per_s"] = m.link_words_per_s;
        one["rotation_sync_ms"] = m.rotation_sync_ms;
        one["host_words_per_s"] = m.host_words_per_s;
        all.append(one);
    }
    return all;
}

}  // namespace

void add_loads(py::module_& module) {
    const auto of_mapping = [&](const char* name, auto function, const char* help) {
        module.def(name, function, py::arg("width"), py::arg("height"), py::arg("mapping") = "",
                   py::arg("offset") = py::none(), py::arg("fold") = "", py::arg("pes") = py::none(), help);
    };
    of_mapping("owners", owners,
               "uint32 [height, width]: the PE that owns each pixel. mapping, offset, fold and pes: as in raya render "
               "--machine grande. Raises ValueError.");
    of_mapping("rotations", rotations,
               "Rotations of the ring that bring each PE its neighbours' pixels from all four sides.");
    of_mapping("exchange_rotations", exchange_rotations, "Rotations of the filter's exchange, if whole shares move.");
    of_mapping("largest_share", share, "The number of pixels of the PE with the largest share.");
    module.def("loads", loads, py::arg("cost"), py::arg("mapping") = "", py::arg("offset") = py::none(),
               py::arg("fold") = "", py::arg("pes") = py::none(),
               "uint64 [P]: the load of each PE, the sum of its pixels' costs. cost: integers [H, W].");
    module.def("imbalances", imbalances, py::arg("cost"), py::arg("pes"), py::arg("offsets"),
               py::arg("fold") = "cyclic",
               "float64 [n]: u = (max - mean) / mean of the loads with the cyclic mapping, for each offset.");
    module.def("speedups", speedups, py::arg("cost"), py::arg("pes"), py::arg("offsets"), py::arg("fold") = "cyclic",
               "float64 [n]: sum / max of the loads with the cyclic mapping, for each number of PEs pes[i] with offset "
               "offsets[i], or offsets[0] for all.");
    module.def("schedule", schedule, py::arg("cost"), py::arg("plan"), py::arg("mapping") = "",
               py::arg("offset") = py::none(), py::arg("fold") = "", py::arg("pes") = py::none(),
               "Simulates a dynamic or hybrid distribution. plan: 'dynamic:CHUNK[,OVERHEAD]' or "
               "'hybrid:CHUNK[,OVERHEAD[,SHARE]]'; mapping: the static part of a hybrid. Returns a dict: loads (uint64 "
               "[P], finishing times in cycles), requests, makespan (cycles), speedup (work / makespan).");
    module.def(
        "lower_bound", [](const py::array& costs, std::uint32_t pes) { return lower_bound(cost_image_of(costs), pes); },
        py::arg("cost"), py::arg("pes"), "Lower bound in cycles of any distribution of whole pixels over P PEs.");
    module.def("filter_cycles", filter_cycles, py::arg("pixels"), "Modelled cycles of the 3 x 3 filter on one PE.");
    module.def("compare_cycles", compare_cycles, py::arg("pixels"),
               "Modelled cycles of the comparison of pixels with their neighbours on one PE.");
    module.def(
        "offset_times", offset_times, py::arg("cost"), py::arg("pes"), py::arg("antialias") = "none",
        py::arg("supersample") = py::none(),
        "Modelled ms of the SPA for each offset of the cyclic mapping, without the set-up of exchanges. Returns a "
        "dict of arrays [W]: offset, imbalance (of the first pass), trace_ms, smooth_ms, supersample_ms, ring_ms, "
        "rotations.");
    module.def("ranks_of_pes", ranks_of_pes, py::arg("pes"), py::arg("ranks"),
               "uint32 [P]: the MPI rank of each PE of a ring.");
    module.def("ranks_of_nodes", ranks_of_torus, py::arg("nodes"), py::arg("ranks"),
               "uint32 [nodes]: the MPI rank of each node of a 3-D torus of nodes = (I, J, K).");
    module.def("link_ends", link_ends, py::arg("nodes"),
               "uint32 [nodes, 6]: the node at the end of each link of a 3-D torus: +x, -x, +y, -y, +z, -z.");
    module.def("machines", all_machines, "All machines, as a list of dicts. None: no limit, or unknown.");
    module.def("reference", reference_image, py::arg("scene"), py::arg("size"), py::arg("bounces") = 8,
               py::arg("threads") = 2, "float64 [size, size, 3]: the image of the double-precision reference.");
}

}  // namespace raya
