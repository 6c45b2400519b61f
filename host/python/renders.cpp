// The Python classes Session and Result, and the functions of the Python module that render.
#include <fmt/core.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>

#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/error.hpp"
#include "host/image/plain_png.hpp"
#include "host/model/t805.hpp"
#include "host/python/session.hpp"
#include "host/torus/async_machine.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_settings.hpp"
#include "host/torus/torus_trace.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

using Result = std::shared_ptr<Render>;

const Load& load_of(const Render& r) { return r.report.load; }

const RingResult& ring_of(const Render& r, const char* what) {
    if (!r.ring) throw py::value_error(fmt::format("{}: only for ring machines; this render used a torus", what));
    return *r.ring;
}

const TorusResult& torus_of(const Render& r, const char* what) {
    if (!r.torus) throw py::value_error(fmt::format("{}: only for a torus; this render used a ring machine", what));
    return *r.torus;
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

void check_kept(const Phase& phase) {
    if (!phase.kept_cost) throw py::value_error("cost: not stored; render with cost=True");
}

py::array cost_of(const py::object& self) {
    const RingResult& ring = ring_of(*self.cast<Result>(), "cost");
    const Phase& phase = ring.phases.size() == 1 ? ring.phases.front() : ring.all;
    check_kept(phase);
    return cost_array(*phase.kept_cost, self);
}

// Returns a dict {name of the phase: figure(phase)}.
template <class Figure>
py::dict by_phase(const py::object& self, const char* what, Figure figure) {
    py::dict all;
    for (const Phase& phase : ring_of(*self.cast<Result>(), what).phases) all[phase.name.c_str()] = figure(phase);
    return all;
}

py::dict costs_of(const py::object& self) {
    return by_phase(self, "costs", [&](const Phase& phase) {
        check_kept(phase);
        return cost_array(*phase.kept_cost, self);
    });
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
    py::dict all;
    const auto add = [&](const char* name, std::uint64_t Superstep::*figure) {
        std::vector<std::uint64_t> values;
        for (const Superstep& step : steps) values.push_back(step.*figure);
        all[name] = copy_of(values);
    };
    add("cycles", &Superstep::max_node_cycles);
    add("link_words", &Superstep::max_link_words);
    add("live", &Superstep::live);
    return all;
}

// Names of the events, in the order of kernels/shared/events.h.
constexpr const char* kEvents[RAYA_EVENTS] = {"primary",       "primary_hits", "reflected",    "refracted",
                                              "shadow",        "shadow_hits",  "sphere_tests", "plane_tests",
                                              "polygon_tests", "cone_tests",   "shaded",       "lit",
                                              "highlights",    "walks",        "steps",        "discarded"};

py::dict events_of(const Result& r) {
    py::dict all;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) all[kEvents[event]] = r->report.events[event];
    return all;
}

double events_ms(const std::map<std::string, std::uint64_t>& events) {
    const auto cycles = t805_cycles();
    std::uint64_t sum = 0;
    for (const auto& [name, count] : events) {
        const auto found = std::find(std::begin(kEvents), std::end(kEvents), name);
        if (found == std::end(kEvents)) throw py::value_error(fmt::format("t805_ms: unknown event {}", name));
        sum += count * cycles[static_cast<std::size_t>(found - std::begin(kEvents))];
    }
    return static_cast<double>(sum) * kT805CycleNs * 1e-6;
}

// The times of the root node, as in torus_time(): its processor time, for computation and for all messages that it
// sends or receives over its links, and the time of its busiest link.
py::dict root_of(const Result& r) {
    const TorusResult& result = torus_of(*r, "root");
    const raya_torus& torus = r->torus_settings->torus;
    std::uint64_t cycles = result.load.per_pe[RAYA_ROOT];
    double link_ms = 0;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        const std::uint32_t end = raya_link_end(torus, RAYA_ROOT, link);
        const std::size_t out = std::size_t{RAYA_ROOT} * RAYA_LINKS + link;
        const std::size_t in = std::size_t{end} * RAYA_LINKS + (link ^ 1u);
        cycles += t805_message_cycles(result.link_packets[out], result.link_words[out]) +
                  t805_message_cycles(result.link_packets[in], result.link_words[in]);
        link_ms = std::max(link_ms, t805_link_ms(result.link_words[out], result.link_words[in]));
    }
    py::dict all;
    all["processor_ms"] = t805_ms(cycles);
    all["link_ms"] = link_ms;
    return all;
}

double work_ms(const Result& r) {
    std::uint64_t sum = 0;
    for (const std::uint64_t load : torus_of(*r, "work_ms").load.per_pe) sum += load;
    return t805_ms(sum);
}

py::dict node_memory(const Result& r) {
    const TorusResult& result = torus_of(*r, "node_memory");
    const std::uint32_t links = links_of_node(r->torus_settings->torus);
    const std::uint64_t scene = result.node_bytes - node_bytes(0, result.buffers, links);
    const std::uint32_t shortest = raya_min_queue(r->lights, r->torus_settings->bounces);
    py::dict all;
    all["scene"] = scene;
    all["shortest"] = scene + node_bytes(0, buffers_for(shortest), links);
    all["used"] = result.node_bytes;
    return all;
}

const History& history_of(const Render& r) {
    if (!r.history) throw py::value_error("simulate: the render has no history; render with async_=True");
    return *r.history;
}

// The default machine with the given parameters changed: message_cycles, word_cycles, one_way, both_ways (bytes/s),
// buffer (messages).
AsyncMachine async_machine(const py::kwargs& changes) {
    AsyncMachine m;
    for (const auto& [key, value] : changes) {
        const std::string name = py::str(key);
        if (name == "message_cycles")
            m.message_cycles = value.cast<std::uint32_t>();
        else if (name == "word_cycles")
            m.word_cycles = value.cast<std::uint32_t>();
        else if (name == "one_way")
            m.one_way = value.cast<double>();
        else if (name == "both_ways")
            m.both_ways = value.cast<double>();
        else if (name == "buffer")
            m.buffer = value.cast<std::uint32_t>();
        else
            throw py::type_error(fmt::format("unknown parameter of the machine: {}", name));
    }
    return m;
}

double simulated_ms(const Result& r, const py::kwargs& changes) {
    const AsyncMachine machine = async_machine(changes);
    const py::gil_scoped_release free;
    return simulate(r->torus_settings->torus, history_of(*r), machine).finish_ms;
}

std::size_t write_replay(const Result& r, const std::string& platform, const std::string& replay,
                         const py::kwargs& changes) {
    const AsyncMachine machine = async_machine(changes);
    const raya_torus& torus = r->torus_settings->torus;
    write_whole_file(platform, simgrid_platform(torus, machine));
    write_whole_file(replay, simgrid_replay(torus, history_of(*r), machine));
    return history_of(*r).messages.size();
}

py::array steps_array(const py::object& self, std::vector<std::uint64_t> Render::*member, std::size_t links) {
    const Result r = self.cast<Result>();
    const auto nodes = static_cast<py::ssize_t>(torus_of(*r, "supersteps").load.per_pe.size());
    const std::vector<std::uint64_t>& values = (*r).*member;
    const auto steps = static_cast<py::ssize_t>(values.size() / links) / nodes;
    std::vector<py::ssize_t> shape = {steps, nodes};
    if (links > 1) shape.push_back(static_cast<py::ssize_t>(links));
    return view_of<std::uint64_t>(values, shape, self);
}

py::object report_of(const py::object& self) {
    const Result r = self.cast<Result>();
    if (r->report.image.preview.png.empty()) add_preview(r->report, {}, r->image());
    return python_of(to_json(r->report));
}

std::string line_of(const Result& r) {
    return fmt::format("<raya.Result of {} on {}: {}x{}, {}, imbalance {:.4f}>", r->report.scene,
                       r->report.machine.name, r->image().width, r->image().height, r->report.image.hash.substr(0, 8),
                       load_of(*r).imbalance);
}

double device_seconds(const Result& r) { return r->ring ? trace_seconds(*r->ring) : r->torus->render_s; }

void add_result(py::module_& module) {
    py::class_<Render, Result>(module, "Result", "The image, counts and measurements of one render.")
        .def_property_readonly("image", image_of, "float32 [H, W, 3]: linear red, green, blue; row 0 is the top.")
        .def_property_readonly(
            "png", [](const Result& r) { return py::bytes(plain_png(r->image())); }, "bytes: an 8-bit PNG, sRGB.")
        .def_property_readonly(
            "hash", [](const Result& r) { return r->report.image.hash; }, "str: hash of the pixels' bits.")
        .def_property_readonly("mask", mask_of, "bool [H, W]: the supersampled pixels; None without supersampling.")
        .def_property_readonly("cost", cost_of,
                               "uint64 [H, W]: modelled cycles of each pixel in all phases. ValueError unless rendered "
                               "with cost=True.")
        .def_property_readonly("costs", costs_of,
                               "The cost in each phase: {'trace': uint64 [H, W], 'supersample': ...}.")
        .def_property_readonly(
            "loads",
            [](const py::object& self) {
                const std::vector<std::uint64_t>& loads = load_of(*self.cast<Result>()).per_pe;
                return view_of<std::uint64_t>(loads, {static_cast<py::ssize_t>(loads.size())}, self);
            },
            "uint64 [P]: modelled cycles of each PE or node.")
        .def_property_readonly(
            "imbalance", [](const Result& r) { return load_of(*r).imbalance; },
            "u = (max - mean) / mean of the loads (Kohata & Ito 1993, Fig. 8).")
        .def_property_readonly(
            "speedup", [](const Result& r) { return load_of(*r).speedup; }, "Sum / max of the loads.")
        .def_property_readonly(
            "efficiency", [](const Result& r) { return load_of(*r).efficiency; }, "Speed-up / P.")
        .def_property_readonly("report", report_of, "dict: the JSON of raya render --report (docs/report.md).")
        .def_property_readonly(
            "job_words", [](const Result& r) { return ring_of(*r, "job_words").pe_memory.job_words; },
            "32-bit words of the scene in each PE.")
        .def_property_readonly(
            "accel_s", [](const Result& r) { return ring_of(*r, "accel_s").accel_s; },
            "Measured seconds to build the grid or BVH.")
        .def_property_readonly(
            "render_s", [](const Result& r) { return r->report.measured.render_s; },
            "Measured seconds from packed scene to image, without building kernels, grid or BVH.")
        .def_property_readonly("device_s", device_seconds,
                               "Measured seconds of tracing on the device; for a torus, of the whole render.")
        .def_property_readonly("events", events_of, "dict: the count of each event (kernels/README.md).")
        .def_property_readonly("root", root_of,
                               "{'processor_ms', 'link_ms'}: modelled ms of the torus's root, and of its busiest link.")
        .def_property_readonly("work_ms", work_ms, "Modelled ms: total computation of all nodes of the torus.")
        .def_property_readonly(
            "node_memory", node_memory,
            "Bytes of the fullest node: {'scene': its part of the scene, 'shortest': with the shortest buffers that "
            "work, 'used': with the buffers of this render}.")
        .def_property_readonly("packets", packets_of,
                               "Structured array of the packets between nodes: superstep, source, destination, kind "
                               "(index of PACKET_KINDS), words, pixel. Empty unless rendered with packets=True.")
        .def_property_readonly(
            "link_words", [](const py::object& self) { return links_of(self, &TorusResult::link_words); },
            "uint64 [nodes, 6]: words over each link: +x, -x, +y, -y, +z, -z.")
        .def_property_readonly(
            "link_packets", [](const py::object& self) { return links_of(self, &TorusResult::link_packets); },
            "uint64 [nodes, 6]: messages over each link.")
        .def_property_readonly(
            "copied_words", [](const Result& r) { return torus_of(*r, "copied_words").copied_words; },
            "Total words of the scene in all nodes of the torus.")
        .def_property_readonly("supersteps", supersteps_of,
                               "{'cycles', 'link_words', 'live': uint64 [S]} of each superstep: cycles of the busiest "
                               "node, words over the busiest link, and packets in flight at the end.")
        .def_property_readonly(
            "step_cycles", [](const py::object& self) { return steps_array(self, &Render::cycles, 1); },
            "uint64 [S, nodes]: cycles of each node in each superstep; with packets=True.")
        .def_property_readonly(
            "step_link_words",
            [](const py::object& self) { return steps_array(self, &Render::link_words, RAYA_LINKS); },
            "uint64 [S, nodes, 6]: words over each link in each superstep; with packets=True.")
        .def("simulate", simulated_ms,
             "Modelled ms of the torus without supersteps, with changed message_cycles, word_cycles, one_way, "
             "both_ways (bytes/s, 0: no time) or buffer (messages); requires async_=True.")
        .def("write_replay", write_replay, py::arg("platform"), py::arg("replay"),
             "Writes the machine and the history for SimGrid (docs/packets.md); returns the number of messages.")
        .def("__repr__", line_of);
}

void warn_of(const Render& r) {
    for (const std::string& text : r.report.warnings)
        if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 2) != 0) throw py::error_already_set();
}

Result render_in(PythonSession& session, const Scene& scene, const py::object& progress, const py::kwargs& options) {
    Result result = session.render(scene, options, progress);
    warn_of(*result);
    return result;
}

Result render_shared(const Scene& scene, const py::object& progress, py::kwargs options) {
    std::string device;
    if (options.contains("device")) device = py::str(options.attr("pop")("device"));
    return render_in(PythonSession::shared(device), scene, progress, options);
}

py::dict info_of(const DeviceInfo& info) {
    py::dict all;
    all["name"] = info.name;
    all["platform"] = info.platform;
    all["version"] = info.version;
    all["driver"] = info.driver;
    return all;
}

}  // namespace

void add_renders(py::module_& module) {
    PYBIND11_NUMPY_DTYPE(PacketRow, superstep, source, destination, kind, words, pixel);
    module.attr("PACKET_KINDS") = py::make_tuple("", "primary", "reflected", "refracted", "shadow", "return");
    add_result(module);
    py::class_<PythonSession>(module, "Session",
                              "An open device with the programs built for it.\n\n"
                              "device: as in raya render --device; default: a GPU, else a CPU. Raises DeviceError.")
        .def(py::init<const std::string&>(), py::arg("device") = "")
        .def_property_readonly(
            "device", [](const PythonSession& s) { return info_of(s.info()); },
            "dict: name, platform, version, driver, as reported by OpenCL.")
        .def("render", render_in, py::arg("scene"), py::arg("progress") = py::none(), "raya.render() on this device.");
    module.def("t805_ms", events_ms, py::arg("events"), "Modelled ms of one T805 for events = {name: count}.");
    module.def("render", render_shared, py::arg("scene"), py::arg("progress") = py::none());
}

}  // namespace raya
