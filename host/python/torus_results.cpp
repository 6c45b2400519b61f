// The members of the Python class Result for renders on a torus.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include <algorithm>

#include "host/base/whole_file.hpp"
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

double work_ms(const Result& r) {
    std::uint64_t sum = 0;
    for (const std::uint64_t load : torus_of(*r, "work_ms").load.per_pe) sum += load;
    return t805_ms(sum);
}

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

// Returns the default machine with the given parameters changed: cycle_ns, message_cycles, word_cycles, one_way,
// both_ways, buffer (see AsyncMachine).
AsyncMachine async_machine(const py::kwargs& changes) {
    AsyncMachine machine;
    for (const auto& [key, value] : changes) {
        const std::string name = py::str(key);
        if (name == "cycle_ns")
            machine.cycle_ns = value.cast<double>();
        else if (name == "message_cycles")
            machine.message_cycles = value.cast<std::uint32_t>();
        else if (name == "word_cycles")
            machine.word_cycles = value.cast<std::uint32_t>();
        else if (name == "one_way")
            machine.one_way = value.cast<double>();
        else if (name == "both_ways")
            machine.both_ways = value.cast<double>();
        else if (name == "buffer")
            machine.buffer = value.cast<std::uint32_t>();
        else
            throw py::type_error(fmt::format("unknown parameter of the machine: {}", name));
    }
    return machine;
}

double simulated_ms(const Result& r, const py::kwargs& changes) {
    const AsyncMachine machine = async_machine(changes);
    const py::gil_scoped_release no_gil;
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

py::array steps_array(const py::object& self, std::vector<std::uint64_t> Render::*member, std::size_t values_per_node) {
    const Result r = self.cast<Result>();
    const auto nodes = static_cast<py::ssize_t>(torus_of(*r, "supersteps").load.per_pe.size());
    const std::vector<std::uint64_t>& values = (*r).*member;
    const auto steps = static_cast<py::ssize_t>(values.size() / values_per_node) / nodes;
    std::vector<py::ssize_t> shape = {steps, nodes};
    if (values_per_node > 1) shape.push_back(static_cast<py::ssize_t>(values_per_node));
    return view_of<std::uint64_t>(values, shape, self);
}

}  // namespace

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
            "link_packets", [](const py::object& self) { return links_of(self, &TorusResult::link_packets); },
            "uint64 [nodes, 6]: number of packets that each node sends over each link.")
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
             "the processor), message_cycles and word_cycles (processor cycles per message and per word), one_way and "
             "both_ways (rate of a link in bytes/s if one direction or both directions transfer; 0: transfers take no "
             "time), buffer (number of rays, and of returns, that an output thread holds). Raises ValueError unless "
             "rendered with async_=True.")
        .def("write_replay", write_replay, py::arg("platform"), py::arg("replay"),
             "Writes the machine to the file `platform` and the history of messages to the file `replay`, for SimGrid "
             "(docs/packets.md). Takes the keyword arguments of simulate(). Returns the number of messages.");
}

}  // namespace raya
