// The Python classes Session and Result, and the functions of the Python module that render.
#include <fmt/core.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>

#include "host/cl/device.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/model/t805.hpp"
#include "host/python/session.hpp"
#include "host/torus/async_machine.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_plan.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

const TorusResult& torus_of(const Render& r, const char* property) {
    if (!r.torus) throw py::value_error(fmt::format("{}: only for a torus; this render used a ring machine", property));
    return *r.torus;
}

struct PacketRow {
    std::uint32_t superstep, source, destination, kind, words, pixel;
};

py::array packets_of(const Result& r) {
    torus_of(*r, "packets");
    std::vector<PacketRow> rows;
    for (const PacketRecord& p : r->packets)
        rows.push_back({p.superstep, p.source, p.destination, raya_state_kind(p.head.state), p.words, p.head.pixel});
    return copy_of(rows);
}

py::array links_of(const py::object& self, std::vector<std::uint64_t> TorusResult::*counts) {
    const std::vector<std::uint64_t>& links = torus_of(*self.cast<Result>(), "links").*counts;
    return view_of<std::uint64_t>(links, {static_cast<py::ssize_t>(links.size() / RAYA_LINKS), RAYA_LINKS}, self);
}

py::dict supersteps_of(const Result& r) {
    const std::vector<Superstep>& steps = torus_of(*r, "supersteps").supersteps;
    py::dict arrays;
    const auto add = [&](const char* name, std::uint64_t Superstep::*figure) {
        std::vector<std::uint64_t> values;
        for (const Superstep& step : steps) values.push_back(step.*figure);
        arrays[name] = copy_of(values);
    };
    add("cycles", &Superstep::max_node_cycles);
    add("link_words", &Superstep::max_link_words);
    add("live", &Superstep::live);
    return arrays;
}

// Returns modelled times of the root node: the time of its processor, which computes and handles all messages over the
// root's links, and the time of the root's busiest link.
py::dict root_times(const Result& r) {
    const TorusResult& result = torus_of(*r, "root");
    const raya_torus& torus = r->torus_settings->torus;
    std::uint64_t cycles = result.load.per_pe[RAYA_ROOT];
    double link_ms = 0;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        const std::uint32_t end = raya_link_end(torus, RAYA_ROOT, link);
        const std::size_t sent = std::size_t{RAYA_ROOT} * RAYA_LINKS + link;
        const std::size_t received = std::size_t{end} * RAYA_LINKS + (link ^ 1u);
        cycles += t805_message_cycles(result.link_packets[sent], result.link_words[sent]) +
                  t805_message_cycles(result.link_packets[received], result.link_words[received]);
        link_ms = std::max(link_ms, t805_link_ms(result.link_words[sent], result.link_words[received]));
    }
    py::dict times;
    times["processor_ms"] = t805_ms(cycles);
    times["link_ms"] = link_ms;
    return times;
}

double work_ms(const Result& r) { return t805_ms(sum_of(torus_of(*r, "work_ms").load.per_pe)); }

py::dict node_memory(const Result& r) {
    const TorusResult& result = torus_of(*r, "node_memory");
    const std::uint32_t links = links_of_node(r->torus_settings->torus);
    const std::uint64_t scene = result.node_bytes - node_bytes(0, result.buffers, links);
    const std::uint32_t min_queue = raya_min_queue(r->lights, r->torus_settings->bounces);
    py::dict bytes;
    bytes["scene"] = scene;
    bytes["shortest"] = scene + node_bytes(0, buffers_for(min_queue), links);
    bytes["used"] = result.node_bytes;
    return bytes;
}

const History& history_of(const Render& r) {
    if (!r.history) throw py::value_error("simulate: the render has no history; render with async_=True");
    return *r.history;
}

// Returns the default machine with the given parameters changed: cycle_ns, primary_factor, message_cycles, word_cycles,
// one_way, both_ways, buffer (see AsyncMachine).
AsyncMachine async_machine(const py::kwargs& changes) {
    AsyncMachine machine;
    for (const auto& change : changes) {
        const std::string name = py::str(change.first);
        const auto sets = [&](const char* parameter, auto& member) {
            if (name == parameter) member = change.second.cast<std::remove_reference_t<decltype(member)>>();
            return name == parameter;
        };
        if (!sets("cycle_ns", machine.cycle_ns) && !sets("primary_factor", machine.primary_factor) &&
            !sets("message_cycles", machine.message_cycles) && !sets("word_cycles", machine.word_cycles) &&
            !sets("one_way", machine.one_way) && !sets("both_ways", machine.both_ways) &&
            !sets("buffer", machine.buffer))
            throw py::type_error(fmt::format("unknown parameter of the machine: {}", name));
    }
    return machine;
}

double simulated_ms(const Result& r, const py::kwargs& changes) {
    const AsyncMachine machine = async_machine(changes);
    const py::gil_scoped_release no_gil;
    return simulate(r->torus_settings->torus, history_of(*r), machine).finish_ms;
}

py::array steps_array(const py::object& self, std::vector<std::uint64_t> Render::*member, std::size_t values_per_node) {
    const Result r = self.cast<Result>();
    const auto nodes = static_cast<py::ssize_t>(torus_of(*r, "supersteps").load.per_pe.size());
    const std::vector<std::uint64_t>& values = (*r).*member;
    const auto steps = static_cast<py::ssize_t>(values.size() / values_per_node) / nodes;
    std::vector<py::ssize_t> shape = {steps, nodes};
    if (values_per_node > 1) shape.push_back(static_cast<py::ssize_t>(values_per_node));
    return view_of<std::uint64_t>(values, shape, self);
}

void add_torus_results(py::module_& module, ResultClass& result) {
    PYBIND11_NUMPY_DTYPE(PacketRow, superstep, source, destination, kind, words, pixel);
    module.attr("PACKET_KINDS") = py::make_tuple("", "primary", "reflected", "refracted", "shadow", "return");
    result
        .def_property_readonly(
            "root", root_times,
            "dict: modelled ms of the torus's root: 'processor_ms' of its processor, 'link_ms' of its "
            "busiest link.")
        .def_property_readonly("work_ms", work_ms, "Modelled ms of computation, summed over all nodes of the torus.")
        .def_property_readonly(
            "node_memory", node_memory,
            "dict: bytes of memory of the node whose part of the scene is largest: 'scene' for this part alone, "
            "'shortest' with the shortest possible buffers, 'used' with the buffers of this render.")
        .def_property_readonly("packets", packets_of,
                               "Structured array of the packets between nodes: superstep, source, destination, kind "
                               "(index of PACKET_KINDS), words, pixel. Empty unless rendered with packets=True.")
        .def_property_readonly(
            "link_words", [](const py::object& self) { return links_of(self, &TorusResult::link_words); },
            "uint64 [nodes, 6]: number of 32-bit words that each node sends over each of its links +x, -x, +y, -y, +z, "
            "-z.")
        .def_property_readonly(
            "copied_words", [](const Result& r) { return torus_of(*r, "copied_words").copied_words; },
            "Number of 32-bit words that all nodes together copy to local memory in each kernel launch; 0 if the "
            "kernels read the scene in global memory.")
        .def_property_readonly("supersteps", supersteps_of,
                               "dict of arrays uint64 [S], one number per superstep: 'cycles' of the busiest node, "
                               "'link_words' sent over the busiest link, 'live': packets in flight at its end.")
        .def_property_readonly(
            "step_cycles", [](const py::object& self) { return steps_array(self, &Render::cycles, 1); },
            "uint64 [S, nodes]: cycles of each node in each superstep. Empty unless rendered with packets=True.")
        .def_property_readonly(
            "step_link_words",
            [](const py::object& self) { return steps_array(self, &Render::link_words, RAYA_LINKS); },
            "uint64 [S, nodes, 6]: number of words that each node sends over each link in each superstep. Empty unless "
            "rendered with packets=True.")
        .def("simulate", simulated_ms,
             "Modelled ms that the torus takes without supersteps. Keyword arguments change the machine: cycle_ns (of "
             "the processor), primary_factor (of the cycles for making primary rays), message_cycles and word_cycles "
             "(processor cycles per message and per word), one_way and "
             "both_ways (rate of a link in bytes/s if one direction or both directions transfer; 0: transfers take no "
             "time), buffer (number of rays, and of returns, that an output thread holds). Raises ValueError unless "
             "rendered with async_=True.");
}

const RingResult& ring_of(const Render& r, const char* property) {
    if (!r.ring) throw py::value_error(fmt::format("{}: only for ring machines; this render used a torus", property));
    return *r.ring;
}

py::array image_of(const py::object& self) {
    const Image& image = self.cast<Result>()->image();
    return view_of<float>(image.rgb, {image.height, image.width, 3}, self);
}

py::object mask_of(const py::object& self) {
    const Image& mask = ring_of(*self.cast<Result>(), "mask").mask;
    if (mask.rgb.empty()) return py::none();
    const py::array rgb = view_of<float>(mask.rgb, {mask.height, mask.width, 3}, self);
    return rgb[py::make_tuple(py::ellipsis(), 0)].attr("astype")("bool");
}

py::array cost_array(const CostImage& cost, const py::object& owner) {
    return view_of<std::uint64_t>(cost.cycles, {cost.height, cost.width}, owner);
}

void require_cost(const Phase& phase) {
    if (!phase.recorded_cost) throw py::value_error("cost: not stored; render with cost=True");
}

py::array cost_of(const py::object& self) {
    const RingResult& ring = ring_of(*self.cast<Result>(), "cost");
    require_cost(ring.phases.front());
    return cost_array(ring.cost(), self);
}

// Returns a dict of figure(phase) by the phase's name. `property`: name of the Result's property, for messages.
template <class Figure>
py::dict by_phase(const py::object& self, const char* property, Figure figure) {
    py::dict figures;
    for (const Phase& phase : ring_of(*self.cast<Result>(), property).phases)
        figures[phase.name.c_str()] = figure(phase);
    return figures;
}

py::dict costs_of(const py::object& self) {
    return by_phase(self, "costs", [&](const Phase& phase) {
        require_cost(phase);
        return cost_array(*phase.recorded_cost, self);
    });
}

py::dict events_of(const Result& r) {
    py::dict counts;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) counts[kEvents[event].name] = r->report.events[event];
    return counts;
}

double events_ms(const std::map<std::string, std::uint64_t>& events) {
    const auto cycles = t805_cycles();
    std::uint64_t sum = 0;
    for (const auto& [name, count] : events) {
        const auto found = std::ranges::find(kEvents, name, &EventNames::name);
        if (found == kEvents.end()) throw py::value_error(fmt::format("t805_ms: unknown event {}", name));
        sum += count * cycles[static_cast<std::size_t>(found - kEvents.begin())];
    }
    return static_cast<double>(sum) * kT805CycleNs * 1e-6;
}

py::object report_of(const py::object& self) {
    const Result r = self.cast<Result>();
    if (r->report.image.preview.png.empty()) add_preview(r->report, {}, r->image());
    return python_of(to_json(r->report));
}

std::string repr_text(const Result& r) {
    return fmt::format("<raya.Result of {} on {}: {}x{}, {}, imbalance {:.4f}>", r->report.scene,
                       r->report.machine.name, r->image().width, r->image().height, r->report.image.hash.substr(0, 8),
                       r->report.load.imbalance);
}

double device_seconds(const Result& r) { return r->ring ? trace_seconds(*r->ring) : r->torus->render_s; }

void add_result(py::module_& module) {
    ResultClass result(module, "Result", "The image of a render, its counts and its measurements.");
    forbid_new(result, "raya.render() makes results");
    result.def_property_readonly("image", image_of, "float32 [H, W, 3]: linear red, green, blue; row 0 is the top.")
        .def_property_readonly(
            "png", [](const Result& r) { return py::bytes(plain_png(r->image())); }, "bytes: an 8-bit PNG, sRGB.")
        .def_property_readonly(
            "hash", [](const Result& r) { return r->report.image.hash; }, "str: hash of the pixels' bits.")
        .def_property_readonly("mask", mask_of, "bool [H, W]: True if supersampled; None without supersampling.")
        .def_property_readonly(
            "cost", cost_of,
            "uint64 [H, W]: modelled cycles of each pixel, summed over all phases. Raises ValueError "
            "if not rendered with cost=True.")
        .def_property_readonly("costs", costs_of,
                               "dict: modelled cycles of each pixel in each phase: {'trace': uint64 [H, W], "
                               "'supersample': ...}. Raises ValueError if not rendered with cost=True.")
        .def_property_readonly(
            "loads",
            [](const py::object& self) {
                const std::vector<std::uint64_t>& loads = self.cast<Result>()->report.load.per_pe;
                return view_of<std::uint64_t>(loads, {static_cast<py::ssize_t>(loads.size())}, self);
            },
            "uint64 [P]: modelled cycles of each PE (of a ring) or node (of a torus).")
        .def_property_readonly(
            "imbalance", [](const Result& r) { return r->report.load.imbalance; },
            "Imbalance u = (max - mean) / mean of the loads (Kohata & Ito 1993, Fig. 8).")
        .def_property_readonly(
            "speedup", [](const Result& r) { return r->report.load.speedup; }, "Sum / max of the loads.")
        .def_property_readonly(
            "efficiency", [](const Result& r) { return r->report.load.efficiency; }, "Speed-up / P.")
        .def_property_readonly("report", report_of, "dict: the JSON of raya render --report.")
        .def_property_readonly(
            "job_words", [](const Result& r) { return ring_of(*r, "job_words").pe_memory.job_words; },
            "Number of 32-bit words that the scene takes in each PE.")
        .def_property_readonly(
            "accel_s", [](const Result& r) { return ring_of(*r, "accel_s").accel_s; },
            "Measured seconds that building the grid or BVH took.")
        .def_property_readonly(
            "render_s", [](const Result& r) { return r->report.measured.render_s; },
            "Measured seconds that rendering the packed scene took, without building kernels, grid or BVH.")
        .def_property_readonly(
            "device_s", device_seconds,
            "Measured seconds that tracing on the device took; for a torus, seconds of the whole render.")
        .def_property_readonly("events", events_of, "dict: the count of each event (kernels/README.md).")
        .def("__repr__", repr_text);
    add_torus_results(module, result);
}

Result render_in(PythonSession& session, const Scene& scene, const py::object& progress, const py::kwargs& options) {
    Result result = session.render(scene, options, progress);
    for (const std::string& text : result->report.warnings)
        if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 2) != 0) throw py::error_already_set();
    return result;
}

Result render_shared(const Scene& scene, const py::object& progress, py::kwargs options) {
    std::string device;
    if (options.contains("device")) device = py::str(options.attr("pop")("device"));
    return render_in(PythonSession::shared(device), scene, progress, options);
}

}  // namespace

void add_renders(py::module_& module) {
    add_result(module);
    py::class_<PythonSession>(module, "Session",
                              "An open device with the OpenCL programs built for it.\n\n"
                              "device: as in raya render --device; default: a GPU, else a CPU. Raises DeviceError.")
        .def(py::init<const std::string&>(), py::arg("device") = "")
        .def_property_readonly(
            "device",
            [](const PythonSession& s) {
                Members members(Members::Mode::kWrite);
                device_members(members, s.info());
                return python_of(members.json());
            },
            "dict: name, platform, version and driver of the device, as reported by OpenCL.")
        .def("render", render_in, py::arg("scene"), py::arg("progress") = py::none(),
             "Renders a scene on this device; see raya.render().");
    module.def("t805_ms", events_ms, py::arg("events"),
               "Modelled ms that one T805 takes for the given events. events: {name: count}, as Result.events. Raises "
               "ValueError for an unknown name.");
    module.def("render", render_shared, py::arg("scene"), py::arg("progress") = py::none());
}

}  // namespace raya
