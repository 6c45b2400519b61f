#include "host/tune/store.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <map>
#include <regex>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/report/render_report.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAccelNames[] = {"none", "grid", "bvh"};  // index: RAYA_ACCEL_*

Json key_json(const TuningKey& key) {
    return {{"machine", key.torus ? "torus" : "ring"},
            {"accel", kAccelNames[key.accel]},
            {"format", key.fp32 ? "fp32" : "reduced"}};
}

bool has_key(const Json& entry, const TuningKey& key) {
    const Json members = key_json(key);
    for (const auto& [name, value] : members.items())
        if (!entry.contains(name) || entry.at(name) != value) return false;
    return true;
}

/// Returns a file without entries.
Json empty_file(const DeviceInfo& device) {
    return {{"kind", "raya tune"},
            {"version", 2},
            {"raya", raya_version()},
            {"device",
             {{"name", device.name},
              {"platform", device.platform},
              {"version", device.version},
              {"driver", device.driver}}},
            {"date", ""},
            {"tuned", Json::array()}};
}

/// Reads the stored file. Throws UserError if it is unusable or other users may write it.
Json read_stored(const fs::path& path, const DeviceInfo& device) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return empty_file(device);
    if (const std::string why = unsafe_path_reason(fs::canonical(path, ignored), {::geteuid()}, Sticky::kRefused, path);
        !why.empty())
        throw UserError(why);
    return read_tuned(json_file_text(path, {path}), path, device);
}

/// Returns the folder that an environment variable contains. Ignores relative paths, as the XDG Base Directory
/// Specification requires.
std::optional<fs::path> folder_of_variable(const char* variable) {
    const fs::path folder = environment_value(variable);
    return folder.is_absolute() ? std::optional(folder) : std::nullopt;
}

}  // namespace

void members_of(Members& m, TunedValues& values) {
    m("lanes", values.lanes, kLanesMeaning);
    m("group", values.group, kGroupMeaning);
    m("local_words", values.local_words, "1 if PEs copy the scene's words into local memory.");
    m("batch", values.batch, "Number of spheres tested before their hits are processed; 0: default.");
}

TunedValues values_of(const Json& json) {
    TunedValues values;
    for (const auto& [name, value] : kTunedNames) json.at(name).get_to(values.*value);
    return values;
}

std::optional<fs::path> tuned_folder() {
    if (const auto cache = folder_of_variable("XDG_CACHE_HOME")) return *cache / "raya";
    if (const auto home = folder_of_variable("HOME")) return *home / ".cache" / "raya";
    return {};
}

std::string tuned_file_name(const DeviceInfo& device) {
    constexpr std::size_t kMaxLength = 240;
    const std::string names = fmt::format("tuned-{}-{}-{}", device.platform, device.name, device.driver);
    return std::regex_replace(names, std::regex("[^A-Za-z0-9.+]+"), "-").substr(0, kMaxLength) + ".json";
}

Json read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device) {
    return read_json(text, {name}, [&](const Json& file) {
        const Json expected = empty_file(device);
        for (const char* key : {"kind", "version", "raya", "device"})
            if (file.at(key) != expected.at(key))
                throw UserError(fmt::format("written for another {}: {}, not {}", key, json_dump(file.at(key)),
                                            json_dump(expected.at(key))));
        for (const Json& entry : file.at("tuned")) {
            const KernelChoice kernels = with_values({}, values_of(entry.at("values")));
            check_kernel_options(
                {.lanes = kernels.lanes, .group_size = kernels.group_size, .sphere_batch = kernels.sphere_batch},
                device);
        }
        file.at("date").get<std::string>();
        return file;
    });
}

fs::path tuned_path(const DeviceInfo& device) {
    const auto folder = tuned_folder();
    if (!folder) throw UserError("no folder for tuned values: set XDG_CACHE_HOME or HOME to an absolute path");
    std::error_code error;
    fs::create_directories(*folder, error);
    if (error)
        throw UserError(fmt::format("{}: cannot create directory: {}; set XDG_CACHE_HOME to another folder",
                                    folder->string(), error.message()));
    fs::path path = *folder / tuned_file_name(device);
    check_writable(path);
    return path;
}

void save_tuned(const DeviceInfo& device, const TunedEntry& entry) {
    const fs::path path = tuned_path(device);
    Json file = empty_file(device);
    try {
        file = read_stored(path, device);
    } catch (const UserError&) {  // an unusable file is overwritten
    }
    Json added = key_json(entry.key), entries = Json::array();
    added["values"] = to_json(entry.values);
    added["speedup"] = entry.speedup;
    added["scene"] = entry.scene;
    entries.push_back(added);
    for (const Json& old : file.at("tuned"))
        if (!has_key(old, entry.key)) entries.push_back(old);
    file["tuned"] = entries;
    file["date"] = utc_text("%Y-%m-%d");
    write_whole_file(path, json_dump(file, 2) + "\n");
}

TunedSource stored_choices(std::function<void(const std::string&)> warn) {
    const std::string setting = environment_value("RAYA_TUNED");
    if (!setting.empty() && setting != "off")
        throw UserError(fmt::format("RAYA_TUNED={}: must be off, or not set", setting));
    const auto folder = tuned_folder();
    if (!folder || setting == "off") return {};
    return [folder = *folder, warn = std::move(warn), files = std::map<std::string, Json>()](
               const DeviceInfo& device, const TuningKey& key) mutable -> std::optional<TunedChoice> {
        const std::string path = folder / tuned_file_name(device);
        const auto [file, is_new] = files.try_emplace(path, empty_file(device));
        try {
            if (is_new) file->second = read_stored(path, device);
        } catch (const UserError& error) {
            warn(fmt::format("{}; the file is ignored; remedy: run raya tune to write a new one", error.what()));
        }
        for (const Json& entry : file->second.at("tuned"))
            if (has_key(entry, key))
                return TunedChoice{values_of(entry.at("values")),
                                   fmt::format("{}, {}", path, file->second.at("date").get<std::string>())};
        return {};
    };
}

}  // namespace raya
