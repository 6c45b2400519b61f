// Storage of tuned values, in one file for each device and driver version.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/members.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"

namespace raya {

/// Lists the tuned values, for files and for messages between processes.
void members_of(Members& m, TunedValues& values);

/// Tuned values of one kind of render.
struct TunedEntry {
    TuningKey key;
    TunedValues values;
    double speedup = 1;  // measured time with the default values divided by the time with `values`
    std::string scene;   // name of the measured scene
};

/// The file of a device, for to_json(), from_json() and schema_of().
struct TunedFile {
    DeviceInfo device;
    std::string date{};  // of the latest search: "2026-11-22"
    std::vector<TunedEntry> entries{};
};
void members_of(Members& m, TunedEntry& entry);
void members_of(Members& m, TunedFile& file);

/// Returns the folder of the files of tuned values: $XDG_CACHE_HOME/raya, or, if that variable is not an absolute path,
/// $HOME/.cache/raya. Empty if neither is absolute.
std::optional<std::filesystem::path> tuned_folder();

/// Returns the name of a device's file, made of the names of platform and device and the driver version.
std::string tuned_file_name(const DeviceInfo& device);

/// Parses the text of file `name`. Throws UserError if the text is not a valid file of tuned values, has values that
/// the device does not support, or is for another device, driver or version of raya.
TunedFile read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device);

/// Returns the path of a device's file, and creates its folder. Throws UserError if tuned_folder() is empty or the file
/// is not writable.
std::filesystem::path tuned_path(const DeviceInfo& device);

/// Adds an entry to the device's file, or replaces the entry with the same key. Writes the file atomically, and
/// overwrites an unusable file. Throws UserError like tuned_path().
void save_tuned(const DeviceInfo& device, const TunedEntry& entry);

/// Returns a source of the stored values, for ScopedTunedSource. The source reads a device's file when values for the
/// device are first requested. If the file is unusable or writable by other users, the source ignores the file and
/// calls `warn` once. Returns an empty function if the environment variable RAYA_TUNED is "off" or tuned_folder() is
/// empty. Throws UserError if RAYA_TUNED has another value (an empty value counts as not set).
TunedSource stored_choices(std::function<void(const std::string&)> warn);

}  // namespace raya
