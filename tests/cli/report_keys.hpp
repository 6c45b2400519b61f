// Lists the keys of a report and the types of their values, for comparison with the expected keys.
#pragma once
#include <set>
#include <string>

#include "tests/document.hpp"

namespace raya {

/// Adds "PATH TYPE" to `keys` for every value in `json`. TYPE is "count" for an unsigned integer, else the name
/// of the JSON type. All elements of an array have the same path.
inline void list_keys(const Document& json, const std::string& path, std::set<std::string>& keys) {
    if (!json.is_structured()) {
        const bool is_count = json.is_number_unsigned();
        keys.insert(path + (is_count ? " count" : std::string(" ") + json.type_name()));
        return;
    }
    for (const auto& [key, value] : json.items())
        list_keys(value, json.is_array() ? path + "[]" : path.empty() ? key : path + "." + key, keys);
}

inline std::set<std::string> keys_of(const Document& report) {
    std::set<std::string> keys;
    list_keys(report, "", keys);
    return keys;
}

/// Returns the expected keys of a load object. `path`: prefix of the keys.
inline std::set<std::string> load_keys(const std::string& path) {
    std::set<std::string> keys;
    for (const char* key : {"unit string", "mean number", "max count", "min count", "imbalance number",
                            "speedup number", "efficiency number", "per_pe[] count"})
        keys.insert(path + key);
    return keys;
}

/// Returns the keys of the report of a render on the SPA with default options, in the form of list_keys().
inline std::set<std::string> default_report_keys() {
    std::set<std::string> keys = {"kind string",
                                  "raya string",
                                  "scene string",
                                  "image.width count",
                                  "image.height count",
                                  "image.file string",
                                  "image.hash string",
                                  "image.exposure null",
                                  "view.from[] number",
                                  "view.at[] number",
                                  "view.up[] number",
                                  "view.angle_degrees number",
                                  "view.background[] number",
                                  "view.lights[].position[] number",
                                  "view.lights[].colour[] number",
                                  "image.preview.width count",
                                  "image.preview.height count",
                                  "image.preview.png string",
                                  "machine.name string",
                                  "machine.topology string",
                                  "machine.pes count",
                                  "machine.mapping string",
                                  "machine.offset count",
                                  "machine.fold string",
                                  "machine.format string",
                                  "machine.bounces count",
                                  "machine.length_exponent count",
                                  "machine.pe_memory_bytes count",
                                  "machine.pe_memory_used_bytes count",
                                  "device.name string",
                                  "device.platform string",
                                  "device.version string",
                                  "device.driver string",
                                  "device.lanes count",
                                  "device.group_size count",
                                  "device.tuned string",
                                  "device.build_options string",
                                  "rays.primary count",
                                  "rays.primary_hits count",
                                  "rays.reflected count",
                                  "rays.refracted count",
                                  "rays.shadow count",
                                  "rays.shadow_hits count",
                                  "tests.sphere count",
                                  "tests.plane count",
                                  "tests.polygon count",
                                  "tests.cone count",
                                  "walks count",
                                  "steps count",
                                  "shading.hits count",
                                  "shading.lit count",
                                  "shading.highlights count",
                                  "accel.kind string",
                                  "antialias.method string",
                                  "communication.broadcasts count",
                                  "communication.broadcast_words count",
                                  "communication.rotations count",
                                  "communication.rotation_words count",
                                  "communication.transfers count",
                                  "communication.transfer_words count",
                                  "communication.pe_broadcasts count",
                                  "communication.pe_broadcast_words count",
                                  "communication.gathers count",
                                  "communication.gather_words count",
                                  "budget.multiply_accumulates count",
                                  "budget.divisions count",
                                  "budget.roots count",
                                  "budget.moves count",
                                  "budget.branches count",
                                  "modelled_ms.objects number",
                                  "modelled_ms.compute number",
                                  "modelled_ms.filter number",
                                  "modelled_ms.compare number",
                                  "modelled_ms.communication number",
                                  "modelled_ms.image number",
                                  "modelled_ms.display number",
                                  "modelled_ms.total number",
                                  "modelled_ms.factor number",
                                  "measured.build_s number",
                                  "measured.render_s number",
                                  "measured.commands[].label string",
                                  "measured.commands[].kind string",
                                  "measured.commands[].launches count",
                                  "measured.commands[].total_ns count",
                                  "measured.commands[].min_ns count",
                                  "measured.commands[].mean_ns number",
                                  "measured.commands[].max_ns count"};
    keys.insert("load.simulated boolean");
    keys.merge(load_keys("load."));
    keys.merge(load_keys("load.trace."));
    return keys;
}

}  // namespace raya
