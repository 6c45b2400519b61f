#include "host/tune/store.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
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

/// Returns the index in `names` of the text. Throws UserError if `names` does not contain the text.
std::uint32_t choice_of(const std::string& text, const char* member, const std::vector<std::string>& names) {
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) throw UserError(fmt::format("unknown {} \"{:.40}\"", member, text));
    return static_cast<std::uint32_t>(found - names.begin());
}

/// Reads the stored file; without entries if it does not exist. Throws UserError if it is unusable or other users may
/// write it.
TunedFile read_stored(const fs::path& path, const DeviceInfo& device) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return {device};
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

void members_of(Members& m, TunedEntry& entry) {
    const std::vector<std::string> machines = {"ring", "torus"}, formats = {"fp32", "reduced"};
    const std::vector<std::string> accels = {"none", "grid", "bvh"};  // index: RAYA_ACCEL_*
    std::string machine = machines.at(entry.key.torus), accel = accels.at(entry.key.accel),
                format = formats.at(!entry.key.fp32);
    m("machine", machine, "Machine whose kernels were tuned: `ring` or `torus`.");
    m("accel", accel, "Acceleration structure of a ring.");
    m("format", format, "Class of number format: `fp32`, or `reduced` for any `eXmY`.");
    entry.key = {.torus = choice_of(machine, "machine", machines) == 1,
                 .accel = choice_of(accel, "accel", accels),
                 .fp32 = choice_of(format, "format", formats) == 0};
    m("values", entry.values, "Values of the tuned parameters.");
    m("speedup", entry.speedup, "Measured speed-up over the defaults; 1 if the defaults were best.");
    m("scene", entry.scene, "Scene with which the speed-up was measured.");
}

void members_of(Members& m, TunedFile& file) {
    constexpr std::uint64_t kFileFormatVersion = 2;
    m("kind", "raya tune", "Identifies the file: `raya tune`.");
    m("version", kFileFormatVersion, "Version of the file format.");
    m("raya", raya_version(), kVersionMeaning);
    m("date", file.date, "Date of the latest search, UTC.");
    m("device", "OpenCL device.", [&](Members& device) { device_members(device, file.device); });
    m("tuned", file.entries, "One entry for each machine, accelerator and class of format.");
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

TunedFile read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device) {
    return read_json(text, {name}, [&](const Json& json) {
        const Json expected = to_json(TunedFile{device});
        for (const char* member : {"kind", "version", "raya", "device"})
            if (json.at(member) != expected.at(member))
                throw UserError(fmt::format("written for another {}: {}, not {}", member, json_dump(json.at(member)),
                                            json_dump(expected.at(member))));
        const auto file = from_json<TunedFile>(json);
        for (const TunedEntry& entry : file.entries) {
            const KernelChoice kernels = with_values({}, entry.values);
            check_kernel_options(
                {.lanes = kernels.lanes, .group_size = kernels.group_size, .sphere_batch = kernels.sphere_batch},
                device);
        }
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
    TunedFile file{device};
    try {
        file = read_stored(path, device);
    } catch (const UserError&) {  // an unusable file is overwritten
    }
    std::erase_if(file.entries, [&](const TunedEntry& old) { return old.key == entry.key; });
    file.entries.push_back(entry);
    file.date = utc_text("%Y-%m-%d");
    write_whole_file(path, json_dump(to_json(file), 2) + "\n");
}

TunedSource stored_choices(std::function<void(const std::string&)> warn) {
    const std::string setting = environment_value("RAYA_TUNED");
    if (!setting.empty() && setting != "off")
        throw UserError(fmt::format("RAYA_TUNED={}: must be off, or not set", setting));
    const auto folder = tuned_folder();
    if (!folder || setting == "off") return {};
    return [folder = *folder, warn = std::move(warn), files = std::map<std::string, TunedFile>()](
               const DeviceInfo& device, const TuningKey& key) mutable -> std::optional<TunedChoice> {
        const fs::path path = folder / tuned_file_name(device);
        const auto [file, is_new] = files.try_emplace(path.string());
        try {
            if (is_new) file->second = read_stored(path, device);
        } catch (const UserError& error) {
            warn(fmt::format("{}; the file is ignored; remedy: run raya tune to write a new one", error.what()));
        }
        for (const TunedEntry& entry : file->second.entries)
            if (entry.key == key)
                return TunedChoice{entry.values, fmt::format("{}, {}", path.string(), file->second.date)};
        return {};
    };
}

}  // namespace raya
