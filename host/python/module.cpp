// The Python module raya._engine: scenes, renders and models of loads. The package in raya/ imports it. This file has
// the class Scene, and the functions that read, write, generate and change scenes.
#include "host/base/module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/options.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/python/session.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/version.hpp"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

Scene loaded(const std::filesystem::path& file, bool strict) {
    SceneInput input = read_scene(file.string(), strict);
    for (const std::string& text : input.warnings.texts())
        if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
    return std::move(input.scene);
}

using Point = std::array<double, 3>;
Point point_of(const Vec3& v) { return {v.x, v.y, v.z}; }

Scene turned_scene(Scene scene, double degrees) {
    scene.view = turned(scene.view, degrees);
    return scene;
}

Scene without_lights(Scene scene) {
    scene.lights.clear();
    return scene;
}

Scene example(const std::string& name) {
    const auto file = embedded_files().find("scenes/" + name + ".nff");
    if (file == embedded_files().end())
        throw UserError(fmt::format("example '{}': no such scene; name a file of scenes/ without .nff", name));
    Scene scene = parse_nff(file->second, file->first);
    scene.name = name;
    return scene;
}

std::size_t job_words(const Scene& scene) {
    const Machine& spa = machine_named("spa");
    return pack_job(scene, {{1, 1}, Sampling::kCentres, spa.bounces, cycles_of_events(), spa.format}).words().size();
}

void save(const Scene& scene, const std::filesystem::path& path) {
    forget_input(path);  // a loaded scene may replace its file
    write_whole_file(path, write_nff(scene));
}

void add_generators(py::module_& module) {
    py::module_ generators = module.def_submodule("generate", "Functions that generate scenes, as raya generate does.");
    generators.def("balls", generate_balls, py::arg("level") = 4,
                   "SPD's sphereflake: 9^0 + ... + 9^level spheres. level: depth of the recursion, 0..6.");
    generators.def(
        "lattice", generate_lattice, py::arg("size") = 12,
        "SPD's lattice: (size + 1)^3 spheres connected by cylinders. size: number of cells along each edge, 1..64.");
    generators.def("gears", generate_gears, py::arg("size") = 4,
                   "size^3 gear wheels. size: number of wheels along each edge, 1..16.");
    generators.def(
        "uniform", generate_uniform, py::arg("count"), py::arg("voxels"),
        "count spheres (1..20000000) in a cube that is divided into x * y * z voxels. Each voxel contains floor(n) or "
        "ceil(n) spheres, n = count / (x * y * z). voxels: (x, y, z).");
    generators.def("random", generate_random, py::arg("count"), py::arg("seed") = 1,
                   "count spheres (1..20000000) with random centres in the cube [-1, 1]^3.");
    generators.def(
        "cluster", [](std::uint64_t seed) { return generate_cluster(seed); }, py::arg("seed") = 1,
        "Seven random spheres above a floor. Averaged over many seeds, load and imbalance match those that Kohata & "
        "Ito (1993) report.");
}

void add_scenes(py::module_& module) {
    py::class_<Scene> scene(module, "Scene", "An immutable scene: objects, surfaces, lights and a view.");
    scene.def_readonly("name", &Scene::name)
        .def_property_readonly(
            "width", [](const Scene& s) { return s.view.width; }, "Width of the image in pixels.")
        .def_property_readonly(
            "height", [](const Scene& s) { return s.view.height; }, "Height of the image in pixels.")
        .def_property_readonly("objects", &Scene::object_count, "Number of spheres, planes, polygons and cones.")
        .def_property_readonly(
            "lights", [](const Scene& s) { return s.lights.size(); }, "Number of lights.")
        .def_property_readonly(
            "eye", [](const Scene& s) { return point_of(s.view.from); }, "[x, y, z]: the eye, scene units.")
        .def_property_readonly(
            "at", [](const Scene& s) { return point_of(s.view.at); },
            "[x, y, z]: the point that the eye looks at, scene units.")
        .def_property_readonly(
            "nff", [](const Scene& s) { return write_nff(s); }, "str: the scene as NFF.")
        .def("save", save, py::arg("path"), "Writes an NFF file atomically. Raises ValueError.")
        .def(
            "renamed",
            [](Scene s, const std::string& name) {
                s.name = name;
                return s;
            },
            py::arg("name"), "Returns the scene with another name.")
        .def(
            "random_view", random_view, py::arg("seed"),
            "Returns the scene seen from a random eye, at the same distance from the point `at`, 5 to 75 degrees above "
            "it.")
        .def("turned", turned_scene, py::arg("degrees"), "Returns the scene with the eye turned around the point `at`.")
        .def("without_lights", without_lights,
             "Returns the scene without lights, for which the kernels trace no shadow rays.")
        .def("scattered", scattered, py::arg("seed"),
             "Returns the scene with a random centre for each sphere. Every sphere lies in the cube [-1, 1]^3.")
        .def("moved_into_voxels", moved_into_voxels,
             "Returns the scene with each sphere moved so that it lies inside the voxel that contains its centre. The "
             "cube [-1, 1]^3 has 4 x 4 x 4 voxels; radii must be less than half a voxel's side.")
        .def("touching_walls", touching_walls,
             "Returns the scene with six spheres moved: for each face of the cube [-1, 1]^3, the sphere nearest to the "
             "face moves until it touches the face.")
        .def(
            "__eq__", [](const Scene& a, const Scene& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Scene& s) {
                 return fmt::format("<raya.Scene {}: {} objects, {}x{}>", s.name, s.object_count(), s.view.width,
                                    s.view.height);
             })
        .def("__reduce__", [](const Scene& s) {
            return py::make_tuple(py::module_::import("raya").attr("_unpickled"), py::make_tuple(write_nff(s), s.name));
        });
    forbid_new(scene, "raya.load() and raya.parse() make scenes");
    module.def(
        "load", loaded, py::arg("path"), py::arg("strict") = false,
        "Reads an NFF file or a mesh. Skips unknown content with a warning unless strict. Raises ValueError with file, "
        "place and reason.");
    module.def(
        "example", example, py::arg("name"),
        "Returns one of the embedded scenes. name: 'centre', 'spheres', 'mirrors', 'glass', 'polygons', 'cones' or "
        "'planes'. Raises ValueError.");
    module.def("job_words", job_words, py::arg("scene"),
               "Number of 32-bit words that the scene takes in each PE of the SPA.");
    module.def(
        "parse", [](const std::string& text, const std::string& name) { return parse_nff(text, name); },
        py::arg("text"), py::arg("name") = "scene", "Parses NFF text. Raises ValueError.");
    add_generators(module);
}

// Returns the path of this shared object. raya searches for its shared libraries in the folder of this file, not in the
// folder of the Python interpreter.
std::filesystem::path this_module_file() {
    Dl_info info{};
    ::dladdr(reinterpret_cast<void*>(&this_module_file), &info);
    return std::filesystem::canonical(info.dli_fname);
}

}  // namespace
}  // namespace raya

PYBIND11_MODULE(_engine, module) {
    using namespace raya;
    set_program_file(this_module_file());
    set_verbosity(kErrorsOnly);  // warnings become Python warnings instead
    auto& input_error = pybind11::register_exception<UserError>(module, "InputError", PyExc_ValueError);
    input_error.doc() = "Invalid input or options.";
    pybind11::register_exception<DoesNotFit>(module, "DoesNotFit", input_error).doc() =
        "A part of the scene does not fit into the memory of a PE or node.";
    pybind11::register_exception<DeviceError>(module, "DeviceError", PyExc_RuntimeError).doc() =
        "The OpenCL device was not found or failed.";
    // Number of 32-bit words that each torus node sends to the host in each superstep.
    module.attr("STATUS_WORDS") = std::uint32_t{RAYA_STATUS_WORDS};
    module.attr("__version__") = raya_version();
    add_scenes(module);
    add_renders(module);
    add_loads(module);
}
