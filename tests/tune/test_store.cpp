// Tests of the file of tuned values: writing, reading, damaged files, and the choice of values for a render.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

DeviceInfo gpu_device() {
    DeviceInfo device;
    device.name = "GeForce (TM) / 9";
    device.platform = "NVIDIA CUDA";
    device.version = "OpenCL 3.0";
    device.driver = "550.1";
    device.type = "gpu";
    device.max_group_size = 1024;
    return device;
}

const TunedFile kTunedFile{.date = "2026-11-22",
                           .entries = {{.key = {.torus = false, .accel = RAYA_ACCEL_GRID, .fp32 = true},
                                        .values = {4, 16, 0, 8},
                                        .speedup = 1.25,
                                        .scene = "own"},
                                       {.key = {.torus = true, .accel = RAYA_ACCEL_NONE, .fp32 = false},
                                        .values = {1, 64, 1, 0},
                                        .speedup = 1,
                                        .scene = "x.nff"}}};

/// For its lifetime, sets XDG_CACHE_HOME to a new folder and unsets RAYA_TUNED.
class ScopedCacheFolder {
  public:
    ScopedCacheFolder() {
        setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
        unsetenv("RAYA_TUNED");
    }
    ~ScopedCacheFolder() {
        unsetenv("XDG_CACHE_HOME");
        setenv("RAYA_TUNED", "off", 1);
    }
    const ScratchFolder& folder() const { return folder_; }

  private:
    ScratchFolder folder_;
};

/// A source of stored tuned values, and the warnings of the source.
struct WarningRecorder {
    std::vector<std::string> texts{};
    TunedSource source = stored_choices([this](const std::string& text) { texts.push_back(text); });
};

TEST_CASE("read_tuned: inverts tuned_text", "[tune]") {
    const DeviceInfo device = gpu_device();
    const TunedFile read_file = read_tuned(tuned_text(device, kTunedFile), "t.json", device);
    CHECK(read_file.date == kTunedFile.date);
    REQUIRE(read_file.entries.size() == kTunedFile.entries.size());
    for (std::size_t i = 0; i < read_file.entries.size(); ++i) {
        CHECK(read_file.entries[i].key == kTunedFile.entries[i].key);
        CHECK(read_file.entries[i].values == kTunedFile.entries[i].values);
        CHECK(read_file.entries[i].speedup == kTunedFile.entries[i].speedup);
        CHECK(read_file.entries[i].scene == kTunedFile.entries[i].scene);
    }
}

TEST_CASE("read_tuned: refuses damaged files and files for other devices, with the reason", "[tune]") {
    const DeviceInfo device = gpu_device();
    const std::string text = tuned_text(device, kTunedFile);
    const auto text_with = [&](const std::string& old_part, const std::string& new_part) {
        std::string changed_text = text;
        REQUIRE(contains(changed_text, old_part));
        return changed_text.replace(changed_text.find(old_part), old_part.size(), new_part);
    };
    for (const auto& [damaged_text, reason] :
         {std::pair<std::string, std::string>{text.substr(0, text.size() / 2), "parse error at line"},
          {"", "t.json: not valid JSON: parse error at line 1"},
          {"{}", "t.json: not a file of raya tune"},
          {text_with("\"version\": 2", "\"version\": 1"), "another version of the file format: 1, not 2"},
          {text_with("\"raya\": \"", "\"raya\": \"9."), "another version of raya: 9."},
          {text_with("550.1", "551.0"), "another device's driver: 551.0, not 550.1"},
          {text_with("GeForce", "Radeon"), "another device's name"},
          {text_with("\"lanes\": 4", "\"lanes\": 5"), "lanes 5"},
          {text_with("\"group\": 16", "\"group\": 100000"), "group 100000"},
          {text_with("\"batch\": 8", "\"batch\": 33"), "sphere batch 33"},
          {text_with("\"batch\": 8", "\"batch\": -2"), "(/tuned/0/values/batch) -2 is negative"},
          {text_with("\"accel\": \"grid\"", "\"accel\": \"octree\""), "octree"},
          {text_with("\"batch\"", "\"bat\""), "(/tuned/0/values) key 'batch' not found"}}) {
        CAPTURE(reason);
        CHECK_THROWS_WITH(read_tuned(damaged_text, "t.json", device), Catch::Contains(reason));
        CHECK_THROWS_AS(read_tuned(damaged_text, "t.json", device), UserError);
    }
}

TEST_CASE("stored values: are found by device, driver and tuning key", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = gpu_device();
    save_tuned(device, kTunedFile);
    WarningRecorder recorder;
    const auto found = recorder.source(device, kTunedFile.entries[0].key);
    REQUIRE(found);
    CHECK(found->values == kTunedFile.entries[0].values);
    CHECK_THAT(found->origin, Catch::Contains(tuned_file_name(device)) && Catch::EndsWith(", 2026-11-22"));
    CHECK_FALSE(recorder.source(device, {.torus = false, .accel = RAYA_ACCEL_BVH, .fp32 = true}));
    DeviceInfo with_new_driver = device;
    with_new_driver.driver = "551.0";
    CHECK_FALSE(recorder.source(with_new_driver, kTunedFile.entries[0].key));
    CHECK(recorder.texts.empty());
    CHECK(cache.folder().entries() == 1);
}

TEST_CASE("save_tuned: an entry replaces the entry with the same key, and the others stay", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = gpu_device();
    save_tuned(device, kTunedFile);
    TunedEntry replacement = kTunedFile.entries[0];
    replacement.values.lanes = 16;
    save_tuned(device, {"2027-01-01", {replacement}});
    WarningRecorder recorder;
    CHECK(recorder.source(device, replacement.key)->values.lanes == 16);
    CHECK(recorder.source(device, kTunedFile.entries[1].key)->values == kTunedFile.entries[1].values);
    CHECK(recorder.source(device, kTunedFile.entries[1].key)->origin.ends_with(", 2027-01-01"));
}

TEST_CASE("stored values: an invalid file causes one warning, is ignored, and is overwritten", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = gpu_device();
    const std::filesystem::path file = tuned_path(device);
    for (const bool is_folder : {false, true}) {
        if (!is_folder) std::ofstream(file) << "{\"kind\":";
        if (is_folder) std::filesystem::create_directory(file);
        WarningRecorder recorder;
        for (const TunedEntry& entry : kTunedFile.entries) CHECK_FALSE(recorder.source(device, entry.key));
        REQUIRE(recorder.texts.size() == 1);
        CHECK_THAT(recorder.texts[0],
                   Catch::Contains(file.string()) && Catch::Contains("ignored") && Catch::Contains("raya tune"));
        if (is_folder) break;
        save_tuned(device, kTunedFile);
        CHECK(WarningRecorder().source(device, kTunedFile.entries[0].key));
        std::filesystem::remove(file);
    }
    CHECK_THROWS_AS(tuned_path(device), UserError);  // a folder, not a file
}

TEST_CASE("stored values: a file that other users may write causes a warning and is ignored", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = gpu_device();
    save_tuned(device, kTunedFile);
    std::filesystem::permissions(tuned_path(device), std::filesystem::perms(0666));
    WarningRecorder recorder;
    CHECK_FALSE(recorder.source(device, kTunedFile.entries[0].key));
    REQUIRE(recorder.texts.size() == 1);
    CHECK_THAT(recorder.texts[0],
               Catch::Contains("other users may write '") && Catch::Contains("(mode 0666); the file is ignored"));
}

TEST_CASE("stored values: are not used if RAYA_TUNED is off or the cache folder is relative", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = gpu_device();
    save_tuned(device, kTunedFile);
    setenv("RAYA_TUNED", "off", 1);
    CHECK_FALSE(WarningRecorder().source);
    unsetenv("RAYA_TUNED");
    setenv("XDG_CACHE_HOME", "relative", 1);
    CHECK((!tuned_folder() || tuned_folder()->is_absolute()));
}

TEST_CASE("chosen: uses stored values unless lanes or group are given", "[tune]") {
    DeviceInfo device = gpu_device();
    device.type = "cpu";
    device.native_float_width = 16;
    const TuningKey workload{.torus = false, .accel = RAYA_ACCEL_NONE, .fp32 = true};
    CHECK(chosen_kernels({}, device, workload).origin == "defaults");
    const ScopedTunedSource source([](const DeviceInfo&, const TuningKey& key) -> std::optional<TunedChoice> {
        if (key.torus) return {};
        return TunedChoice{{4, 2, 0, 8}, "FILE, DATE"};
    });
    const KernelChoice tuned = chosen_kernels({}, device, workload);
    CHECK(tuned.origin == "FILE, DATE");
    CHECK((tuned.lanes == 4 && tuned.group_size == 2 && !tuned.local_words));
    CHECK(tuned.sphere_batch == 8);
    const KernelChoice unknown = chosen_kernels({}, device, {.torus = true});
    CHECK(unknown.origin == "defaults");
    KernelChoice with_group;
    with_group.group_size = 3;
    const KernelChoice options = chosen_kernels(with_group, device, workload);
    CHECK(options.origin == "options");
    CHECK((options.lanes == 16 && options.group_size == 3 && options.local_words));
    CHECK(options.sphere_batch == 0);
}

}  // namespace
}  // namespace raya
