// What devices were tuned to, kept in a file for each device and driver.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/tuned.hpp"

namespace raya {

/// In files, and between processes.
Json to_json(const TunedValues& values);

/// JsonError where a value is missing or no whole number of 32 bits.
TunedValues values_of(const Json& json);

/// What is kept of one kind of kernels.
struct TunedEntry {
    TunedFor what;
    TunedValues values;
    double speedup = 1;  // over the defaults, as it was measured
    std::string scene;   // with which
};

struct TunedFile {
    std::string date;  // "2026-11-22"
    std::vector<TunedEntry> entries;
};

/// Where files lie: raya/ below XDG_CACHE_HOME, else below .cache in HOME; empty where neither names a folder by an
/// absolute path.
std::optional<std::filesystem::path> tuned_folder();

/// The name of a device's file in there: of platform, device and driver version.
std::string tuned_file_name(const DeviceInfo& device);

/// The file's text. It names device, driver and raya's version.
std::string tuned_text(const DeviceInfo& device, const TunedFile& file);

/// Reads such a text of the file `name`. UserError where it is another text, damaged, has values that the device does
/// not take, or is of another device, driver or version of raya.
TunedFile read_tuned(const std::string& text, const std::string& name, const DeviceInfo& device);

/// The file of a device, in a folder that is made. UserError where there is no place, or it cannot be written.
std::filesystem::path tuned_place(const DeviceInfo& device);

/// Adds `now` to what is kept of the device, in place of entries for the same, and writes the file whole; a file that
/// cannot be used is written over. UserError as tuned_place().
void keep_tuned(const DeviceInfo& device, const TunedFile& now);

/// What is kept, for TunedUse: a device's file is read when it is first asked for. One that cannot be used is told to
/// `warn`, once, and ignored, like one that other users may write. Knows nothing where the environment variable
/// RAYA_TUNED is "off". UserError where it is anything else.
TunedSource kept_choices(std::function<void(const std::string&)> warn);

}  // namespace raya
