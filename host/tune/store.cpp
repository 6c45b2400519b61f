#include "host/tune/store.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/report/render_report.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "raya tune";
constexpr std::uint64_t kFileFormatVersion = 2;

// Returns the index in `names` of the text. Throws UserError if `names` does not contain the text.
std::uint32_t choice_of(const std::string& text, const char* member, const std::vector<std::string>& names) {
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) throw UserError(fmt::format("unknown {} \"{:.40}\"", member, text));
    return static_cast<std::uint32_t>(found - names.begin());
}

// Throws UserError unless raya tune wrote the file for this device and driver, with this version of raya and of the
// file format.
void check_origin(const Json& json, const DeviceInfo& device) {
    if (!find_member(json, "kind") || json_text(json.at("kind")) != kKind)
        throw UserError(fmt::format("not a file of {}", kKind));
    const auto check = [](const std::string& stored, const std::string& required, const char* property) {
        if (stored != required)
            throw UserError(fmt::format("written for another {}: {}, not {}", property, stored, required));
    };
    check(std::to_string(json_integer(json.at("version"))), std::to_string(kFileFormatVersion),
          "version of the file format");
    check(json_text(json.at("raya")), raya_version(), "version of raya");
    const Json& stored = json.at("device");
    check(json_text(stored.at("name")), device.name, "device's name");
    check(json_text(stored.at("platform")), device.platform, "device's platform");
    check(json_text(stored.at("version")), device.version, "device's version");
    check(json_text(stored.at("driver")), device.driver, "device's driver");
}

TunedFile file_of(const Json& json, const DeviceInfo& device) {
    check_origin(json, device);
    const auto stored = from_json<StoredTuning>(json);
    for (const TunedEntry& entry : stored.file.entries) {
        const KernelChoice kernels = with_values({}, entry.values);
        check_kernel_options(
            {.lanes = kernels.lanes, .group_size = kernels.group_size, .sphere_batch = kernels.sphere_batch}, device);
    }
    return stored.file;
}

constexpr std::uint64_t kMaxFileBytes = 1 << 20;

// Reads the stored file. Returns nullopt if it does not exist. Throws UserError if it is unusable or other users may
// write it.
std::optional<TunedFile> read_stored(const fs::path& path, const DeviceInfo& device) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return {};
    if (const std::string why = unsafe_path_reason(fs::canonical(path, ignored), {::geteuid()}, Sticky::kRefused, path);
        !why.empty())
        throw UserError(why);
    return read_tuned(json_file_text(path, {path}, Pipes::kRefused, kMaxFileBytes), path, device);
}

// Replaces every sequence of characters other than letters, digits, '.' and '+' by one '-', and keeps at most 80
// characters.
std::string file_name_part(const std::string& name) {
    std::string text;
    for (const char c : name) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+';
        if (plain || (!text.empty() && text.back() != '-')) text += plain ? c : '-';
    }
    constexpr std::size_t kMaxLength = 80;
    return text.substr(0, kMaxLength);
}

// Returns the folder that an environment variable contains. Ignores relative paths, as the XDG Base Directory
// Specification requires.
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

void members_of(Members& m, StoredTuning& stored) {
    m("kind", kKind, "Identifies the file: `raya tune`.");
    m("version", kFileFormatVersion, "Version of the file format.");
    m("raya", raya_version(), kVersionMeaning);
    m("date", stored.file.date, "Date of the latest search, UTC.");
    m("device", "OpenCL device.", [&](Members& device) { device_members(device, stored.device); });
    m("tuned", stored.file.entries, "One entry for each machine, accelerator and class of format.");
}

std::optional<fs::path> tuned_folder() {
    if (const auto cache = folder_of_variable("XDG_CACHE_HOME")) return *cache / "raya";
    if (const auto home = folder_of_variable("HOME")) return *home / ".cache" / "raya";
    return {};
}

std::string tuned_file_name(const DeviceInfo& device) {
    return fmt::format("tuned-{}-{}-{}.json", file_name_part(device.platform), file_name_part(device.name),
                       file_name_part(device.driver));
}

std::string tuned_text(const DeviceInfo& device, const TunedFile& file) {
    return to_json(StoredTuning{device, file}).dump(2) + "\n";
}

TunedFile read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device) {
    return read_json(text, {name}, [&](const Json& json) { return file_of(json, device); });
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

void save_tuned(const DeviceInfo& device, const TunedFile& tuned) {
    const fs::path path = tuned_path(device);
    TunedFile merged = tuned;
    try {
        if (const auto stored = read_stored(path, device))
            for (const TunedEntry& entry : stored->entries)
                if (std::none_of(tuned.entries.begin(), tuned.entries.end(),
                                 [&](const TunedEntry& replacement) { return replacement.key == entry.key; }))
                    merged.entries.push_back(entry);
    } catch (const UserError&) {  // an unusable file is overwritten
    }
    write_whole_file(path, tuned_text(device, merged));
}

TunedSource stored_choices(std::function<void(const std::string&)> warn) {
    const std::string setting = environment_value("RAYA_TUNED");
    if (!setting.empty() && setting != "off")
        throw UserError(fmt::format("RAYA_TUNED={}: must be off, or not set", setting));
    const auto folder = tuned_folder();
    if (!folder || setting == "off") return {};
    return [folder = *folder, warn = std::move(warn), files = std::map<std::string, std::optional<TunedFile>>()](
               const DeviceInfo& device, const TuningKey& key) mutable -> std::optional<TunedChoice> {
        const fs::path path = folder / tuned_file_name(device);
        const auto [file, is_new] = files.try_emplace(path.string());
        try {
            if (is_new) file->second = read_stored(path, device);
        } catch (const UserError& error) {
            warn(fmt::format("{}; the file is ignored; remedy: run raya tune to write a new one", error.what()));
        }
        if (!file->second) return {};
        for (const TunedEntry& entry : file->second->entries)
            if (entry.key == key)
                return TunedChoice{entry.values, fmt::format("{}, {}", path.string(), file->second->date)};
        return {};
    };
}

}  // namespace raya
