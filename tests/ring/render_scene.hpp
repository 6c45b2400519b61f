// Functions that render on the ring machine in one call. Without an OpenCL device, tests that call these functions fail
// and are not skipped.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/nff.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {

struct RingCase {
    std::uint32_t width = 64, height = 48;
    std::uint32_t pes = 64, offset = 8;
    Fold fold = Fold::kCyclic;
    std::string machine = "grande";
    std::optional<MappingRule> mapping{};  // empty: cyclic with `offset` and `fold`
    std::uint32_t lanes = default_test_lanes(), group = 0, bounces = kTestBounces;  // lanes, group 0: the device's
    Sampling sampling = Sampling::kCentres;
    std::string format = "fp32";
    bool filter = true;
    std::vector<std::string> more_options{};
    Antialias antialias{};
    bool record_costs = false;
    std::uint32_t split = 0;
};

inline RingSettings settings_of(const RingCase& c) {
    RingSettings settings;
    settings.machine = machine_named(c.machine);
    settings.mapping = make_mapping(c.mapping.value_or(cyclic_mapping(c.offset, c.fold)), {c.width, c.height}, c.pes);
    settings.bounces = c.bounces;
    settings.sampling = c.sampling;
    settings.antialias = c.antialias;
    settings.record_costs = c.record_costs;
    settings.split = c.split;
    settings.format = parse_format(c.format);
    settings.kernels.filter = c.filter;
    settings.kernels.lanes = c.lanes;
    settings.kernels.group_size = c.group;
    settings.kernels.sources.more_options = c.more_options;
    return settings;
}

inline RingResult render_scene(const Scene& scene, const RingCase& c) {
    Session session(choose_device(""));
    return RingRenderer(session, scene, settings_of(c)).render();
}

inline Scene project_scene(const std::string& name) { return read_nff(RAYA_SOURCE_DIR "/scenes/" + name + ".nff"); }

/// Returns the first `few` of the scenes in scenes/, or all if thorough(). They contain every kind of object and
/// surface; the kernels of the first four differ.
inline std::vector<std::string> project_scenes(std::size_t few) {
    return quick<std::string>(few, {"planes", "glass", "cones", "polygons", "centre", "spheres", "mirrors"});
}

}  // namespace raya
