// Tuned values, stored in one file for each device and driver version.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"

namespace raya {

/// For files, and between processes.
Json to_json(const TunedValues& values);

/// Throws JsonError if a value is missing or not an unsigned 32-bit integer.
TunedValues values_of(const Json& json);

/// Tuned values of one kind of kernels.
struct TunedEntry {
    TunedFor what;
    TunedValues values;
    double speedup = 1;  // measured, over the defaults
    std::string scene;   // that it was measured with
};

struct TunedFile {
    std::string date;  // "2026-11-22"
    std::vector<TunedEntry> entries;
};

/// Folder of the files: $XDG_CACHE_HOME/raya, or else $HOME/.cache/raya. Empty if neither variable is an absolute path.
std::optional<std::filesystem::path> tuned_folder();

/// File name of a device, from the names of platform and device and the driver version.
std::string tuned_file_name(const DeviceInfo& device);

/// Text of a file, with the names of device and driver and the version of raya.
std::string tuned_text(const DeviceInfo& device, const TunedFile& file);

/// Reads the text of the file `name`. Throws UserError if it is damaged or another file, has values that the device
/// does not support, or is for another device, driver or version of raya.
TunedFile read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device);

/// Path of a device's file; creates its folder. Throws UserError if there is no folder or the file is not writable.
std::filesystem::path tuned_path(const DeviceInfo& device);

/// Merges `now` into the device's file, replacing entries for the same kernels, and writes the file atomically. An
/// unusable file is overwritten. Throws UserError like tuned_path().
void save_tuned(const DeviceInfo& device, const TunedFile& now);

/// Stored values, for ScopedTunedSource. Reads a device's file at the first request for it. A file that is unusable or
/// writable by other users is ignored, with one call of `warn`. Empty if the environment variable RAYA_TUNED is "off";
/// throws UserError for any other value.
TunedSource stored_choices(std::function<void(const std::string&)> warn);

}  // namespace raya
