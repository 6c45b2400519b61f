// The file of tuned values: writing, reading, damaged files, and the choice of values for a render.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "host/base/encoding.hpp"
#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "tests/base/scratch_folder.hpp"

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

const DeviceInfo kDevice = gpu_device();
const TunedEntry kGrid{{.accel = RAYA_ACCEL_GRID}, {4, 16, 0, 8}, 1.25, "own"};
const TunedEntry kTorus{{.torus = true, .fp32 = false}, {1, 64, 1, 0}, 1, "x.nff"};

/// For its lifetime, sets XDG_CACHE_HOME to a new folder with the values of kDevice, and unsets RAYA_TUNED.
class ScopedCacheFolder {
  public:
    ScopedCacheFolder() {
        setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1);
        unsetenv("RAYA_TUNED");
        save_tuned(kDevice, kGrid);
        save_tuned(kDevice, kTorus);
    }
    ~ScopedCacheFolder() {
        unsetenv("XDG_CACHE_HOME");
        setenv("RAYA_TUNED", "off", 1);
    }

  private:
    ScratchFolder folder_;
};

/// A source of stored tuned values, and the warnings of the source.
struct WarningRecorder {
    std::vector<std::string> texts{};
    TunedSource source = stored_choices([this](const std::string& text) { texts.push_back(text); });
};

TEST_CASE("stored values are found by device and key; an entry replaces the entry with the same key", "[tune]") {
    const ScopedCacheFolder cache;
    TunedEntry replacement = kGrid;
    replacement.values.lanes = 16;
    save_tuned(kDevice, replacement);
    WarningRecorder recorder;
    const auto found = recorder.source(kDevice, kGrid.key);
    REQUIRE(found);
    CHECK(found->values == replacement.values);
    CHECK_THAT(found->origin, Catch::Contains(tuned_file_name(kDevice) + ", 20"));
    CHECK(recorder.source(kDevice, kTorus.key)->values == kTorus.values);
    CHECK_FALSE(recorder.source(kDevice, {.accel = RAYA_ACCEL_BVH}));
    DeviceInfo with_new_driver = kDevice;
    with_new_driver.driver = "551.0";
    CHECK_FALSE(recorder.source(with_new_driver, kGrid.key));
    CHECK(recorder.texts.empty());
    CHECK(read_tuned(read_file(tuned_path(kDevice)), "t.json", kDevice).entries.size() == 2);
}

TEST_CASE("read_tuned: refuses damaged files and files for other devices, with the reason", "[tune]") {
    const ScopedCacheFolder cache;
    const std::string text = read_file(tuned_path(kDevice));
    for (const auto& [old_part, new_part, reason] :
         {std::tuple{"\"version\": 2", "\"version\": 1", "another version: 1, not 2"},
          {"\"raya\": \"", "\"raya\": \"9.", "another raya: \"9."},
          {"550.1", "551.0", "another device: "},
          {"\"kind\"", "\"sort\"", "key 'kind' not found"},
          {"\"accel\": \"grid\"", "\"accel\": \"octree\"", "octree"},
          {"\"lanes\": 4", "\"lanes\": 5", "lanes 5"},
          {"\"group\": 16", "\"group\": 100000", "group 100000"},
          {"\"batch\": 8", "\"batch\": 33", "sphere batch 33"},
          {"\"batch\": 8", "\"batch\": -2", "/values/batch) must be a whole number from 0"},
          {"\"batch\": 8", "\"batch\": \"\"", "/values/batch) must be a whole number from 0"},
          {"\"batch\": 8", "\"bat\": 8", "/values) key 'batch' not found"}}) {
        CAPTURE(reason);
        const std::string damaged = replaced(text, old_part, new_part);
        REQUIRE(damaged != text);
        CHECK_THROWS_WITH(read_tuned(damaged, "t.json", kDevice), Catch::Contains(reason));
        CHECK_THROWS_AS(read_tuned(damaged, "t.json", kDevice), UserError);
    }
}

TEST_CASE("stored values: an unusable file causes one warning, is ignored, and is overwritten", "[tune]") {
    const ScopedCacheFolder cache;
    const std::filesystem::path file = tuned_path(kDevice);
    const auto check_ignored = [&](const std::string& reason) {
        CAPTURE(reason);
        WarningRecorder recorder;
        for (const TunedEntry& entry : {kGrid, kTorus}) CHECK_FALSE(recorder.source(kDevice, entry.key));
        REQUIRE(recorder.texts.size() == 1);
        CHECK_THAT(recorder.texts[0], Catch::Contains(reason) && Catch::Contains("the file is ignored; remedy: run"));
    };
    std::filesystem::permissions(file, std::filesystem::perms(0666));
    check_ignored("other users may write '");
    std::filesystem::permissions(file, std::filesystem::perms(0600));
    std::ofstream(file) << "{\"kind\":";
    check_ignored(file.string() + ": not valid JSON");
    save_tuned(kDevice, kGrid);
    CHECK(WarningRecorder().source(kDevice, kGrid.key));
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    check_ignored(file.string());
    CHECK_THROWS_AS(tuned_path(kDevice), UserError);
}

TEST_CASE("stored values: are not used if RAYA_TUNED is off or the cache folder is relative", "[tune]") {
    const ScopedCacheFolder cache;
    setenv("RAYA_TUNED", "off", 1);
    CHECK_FALSE(WarningRecorder().source);
    unsetenv("RAYA_TUNED");
    setenv("XDG_CACHE_HOME", "relative", 1);
    CHECK((!tuned_folder() || tuned_folder()->is_absolute()));
}

TEST_CASE("chosen: uses stored values unless lanes or group are given", "[tune]") {
    DeviceInfo device = kDevice;
    device.type = "cpu";
    device.native_float_width = 16;
    CHECK(chosen_kernels({}, device, {}).origin == "defaults");
    const ScopedTunedSource source([](const DeviceInfo&, const TuningKey& key) -> std::optional<TunedChoice> {
        if (key.torus) return {};
        return TunedChoice{{4, 2, 0, 8}, "FILE, DATE"};
    });
    const KernelChoice tuned = chosen_kernels({}, device, {});
    CHECK(tuned.origin == "FILE, DATE");
    CHECK((tuned.lanes == 4 && tuned.group_size == 2 && !tuned.local_words && tuned.sphere_batch == 8));
    CHECK(chosen_kernels({}, device, {.torus = true}).origin == "defaults");
    const KernelChoice options = chosen_kernels({.group_size = 3}, device, {});
    CHECK(options.origin == "options");
    CHECK((options.lanes == 16 && options.group_size == 3 && options.local_words && options.sphere_batch == 0));
}

}  // namespace
}  // namespace raya
