// The Python classes Session and Result, and the functions of the Python module that render. torus_results.cpp has the
// members of Result for the torus.
#include <fmt/core.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>

#include "host/cl/device.hpp"
#include "host/error.hpp"
#include "host/image/plain_png.hpp"
#include "host/model/t805.hpp"
#include "host/python/session.hpp"

namespace raya {
namespace {

const Load& load_of(const Render& r) { return r.report.load; }

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
        const auto found = std::ranges::find_if(kEvents, [&](const EventNames& names) { return names.name == name; });
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
                       load_of(*r).imbalance);
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
                const std::vector<std::uint64_t>& loads = load_of(*self.cast<Result>()).per_pe;
                return view_of<std::uint64_t>(loads, {static_cast<py::ssize_t>(loads.size())}, self);
            },
            "uint64 [P]: modelled cycles of each PE (of a ring) or node (of a torus).")
        .def_property_readonly(
            "imbalance", [](const Result& r) { return load_of(*r).imbalance; },
            "Imbalance u = (max - mean) / mean of the loads (Kohata & Ito 1993, Fig. 8).")
        .def_property_readonly(
            "speedup", [](const Result& r) { return load_of(*r).speedup; }, "Sum / max of the loads.")
        .def_property_readonly(
            "efficiency", [](const Result& r) { return load_of(*r).efficiency; }, "Speed-up / P.")
        .def_property_readonly("report", report_of, "dict: the JSON of raya render --report (docs/report.md).")
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

void raise_warnings(const Render& r) {
    for (const std::string& text : r.report.warnings)
        if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 2) != 0) throw py::error_already_set();
}

Result render_in(PythonSession& session, const Scene& scene, const py::object& progress, const py::kwargs& options) {
    Result result = session.render(scene, options, progress);
    raise_warnings(*result);
    return result;
}

Result render_shared(const Scene& scene, const py::object& progress, py::kwargs options) {
    std::string device;
    if (options.contains("device")) device = py::str(options.attr("pop")("device"));
    return render_in(PythonSession::shared(device), scene, progress, options);
}

py::dict device_dict(const DeviceInfo& info) {
    py::dict fields;
    fields["name"] = info.name;
    fields["platform"] = info.platform;
    fields["version"] = info.version;
    fields["driver"] = info.driver;
    return fields;
}

}  // namespace

void add_renders(py::module_& module) {
    add_result(module);
    py::class_<PythonSession>(module, "Session",
                              "An open device with the OpenCL programs built for it.\n\n"
                              "device: as in raya render --device; default: a GPU, else a CPU. Raises DeviceError.")
        .def(py::init<const std::string&>(), py::arg("device") = "")
        .def_property_readonly(
            "device", [](const PythonSession& s) { return device_dict(s.info()); },
            "dict: name, platform, version and driver of the device, as reported by OpenCL.")
        .def("render", render_in, py::arg("scene"), py::arg("progress") = py::none(),
             "Renders a scene on this device; see raya.render().");
    module.def("t805_ms", events_ms, py::arg("events"),
               "Modelled ms that one T805 takes for the given events. events: {name: count}, as Result.events. Raises "
               "ValueError for an unknown name.");
    module.def("render", render_shared, py::arg("scene"), py::arg("progress") = py::none());
}

}  // namespace raya
