// Tests of the file of tuned values: writing, reading, damaged files, and use by renders.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "host/error.hpp"
#include "host/tune/store.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

DeviceInfo some_device() {
    DeviceInfo device;
    device.name = "GeForce (TM) / 9";
    device.platform = "NVIDIA CUDA";
    device.version = "OpenCL 3.0";
    device.driver = "550.1";
    device.type = "gpu";
    device.max_group_size = 1024;
    return device;
}

const TunedFile kFile{.date = "2026-11-22",
                      .entries = {{.key = {.torus = false, .accel = RAYA_ACCEL_GRID, .fp32 = true},
                                   .values = {4, 16, 0, 8, 2, 1, 96},
                                   .speedup = 1.25,
                                   .scene = "own"},
                                  {.key = {.torus = true, .accel = RAYA_ACCEL_NONE, .fp32 = false},
                                   .values = {1, 64, 1, 0, 0, 0, 0, 2},
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
    const DeviceInfo device = some_device();
    const TunedFile read = read_tuned(tuned_text(device, kFile), "t.json", device);
    CHECK(read.date == kFile.date);
    REQUIRE(read.entries.size() == kFile.entries.size());
    for (std::size_t i = 0; i < read.entries.size(); ++i) {
        CHECK(read.entries[i].key == kFile.entries[i].key);
        CHECK(read.entries[i].values == kFile.entries[i].values);
        CHECK(read.entries[i].speedup == kFile.entries[i].speedup);
        CHECK(read.entries[i].scene == kFile.entries[i].scene);
    }
}

TEST_CASE("read_tuned: refuses damaged files and files for other devices, with the reason", "[tune]") {
    const DeviceInfo device = some_device();
    const std::string text = tuned_text(device, kFile);
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string changed_text = text;
        REQUIRE(contains(changed_text, from));
        return changed_text.replace(changed_text.find(from), from.size(), to);
    };
    for (const auto& [bad, reason] :
         {std::pair<std::string, std::string>{text.substr(0, text.size() / 2), "not valid JSON"},
          {"", "t.json:1: not valid JSON (byte 1)"},
          {"{}", "t.json: not a file of raya tune"},
          {changed("\"version\": 2", "\"version\": 1"), "another version of the file format: 1, not 2"},
          {changed("\"raya\": \"", "\"raya\": \"9."), "another version of raya: 9."},
          {changed("550.1", "551.0"), "another device's driver: 551.0, not 550.1"},
          {changed("GeForce", "Radeon"), "another device's name"},
          {changed("\"lanes\": 4", "\"lanes\": 5"), "lanes 5"},
          {changed("\"group\": 16", "\"group\": 100000"), "group 100000"},
          {changed("\"batch\": 8", "\"batch\": 33"), "batch 33"},
          {changed("\"link_exchange\": 2", "\"link_exchange\": 3"), "link exchange 3"},
          {changed("\"trees\": 2", "\"trees\": -2"), "tuned[0].values.trees: -2 is negative"},
          {changed("\"accel\": \"grid\"", "\"accel\": \"octree\""), "octree"},
          {changed("\"beams\"", "\"beam\""), "tuned[0].values: 'beams' is missing"}}) {
        CAPTURE(reason);
        CHECK_THROWS_WITH(read_tuned(bad, "t.json", device), Catch::Contains(reason));
        CHECK_THROWS_AS(read_tuned(bad, "t.json", device), UserError);
    }
}

TEST_CASE("stored values: are found by device, driver and tuning key", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = some_device();
    save_tuned(device, kFile);
    WarningRecorder warned;
    const auto found = warned.source(device, kFile.entries[0].key);
    REQUIRE(found);
    CHECK(found->values == kFile.entries[0].values);
    CHECK_THAT(found->origin, Catch::Contains(tuned_file_name(device)) && Catch::EndsWith(", 2026-11-22"));
    CHECK_FALSE(warned.source(device, {.torus = false, .accel = RAYA_ACCEL_BVH, .fp32 = true}));
    DeviceInfo newer = device;
    newer.driver = "551.0";
    CHECK_FALSE(warned.source(newer, kFile.entries[0].key));
    CHECK(warned.texts.empty());
    CHECK(cache.folder().entries() == 1);
}

TEST_CASE("save_tuned: an entry replaces the entry with the same key, and the others stay", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = some_device();
    save_tuned(device, kFile);
    TunedEntry replacement = kFile.entries[0];
    replacement.values.lanes = 16;
    save_tuned(device, {"2027-01-01", {replacement}});
    WarningRecorder warned;
    CHECK(warned.source(device, replacement.key)->values.lanes == 16);
    CHECK(warned.source(device, kFile.entries[1].key)->values == kFile.entries[1].values);
    CHECK(warned.source(device, kFile.entries[1].key)->origin.ends_with(", 2027-01-01"));
}

TEST_CASE("stored values: an invalid file causes one warning, is ignored, and is overwritten", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = some_device();
    const std::filesystem::path file = tuned_path(device);
    for (const bool folder : {false, true}) {
        if (!folder) std::ofstream(file) << "{\"kind\":";
        if (folder) std::filesystem::create_directory(file);
        WarningRecorder warned;
        for (const TunedEntry& entry : kFile.entries) CHECK_FALSE(warned.source(device, entry.key));
        REQUIRE(warned.texts.size() == 1);
        CHECK_THAT(warned.texts[0],
                   Catch::Contains(file.string()) && Catch::Contains("ignored") && Catch::Contains("raya tune"));
        if (folder) break;
        save_tuned(device, kFile);
        CHECK(WarningRecorder().source(device, kFile.entries[0].key));
        std::filesystem::remove(file);
    }
    CHECK_THROWS_AS(tuned_path(device), UserError);  // a folder, not a file
}

TEST_CASE("stored values: a file that other users may write causes a warning and is ignored", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = some_device();
    save_tuned(device, kFile);
    std::filesystem::permissions(tuned_path(device), std::filesystem::perms(0666));
    WarningRecorder warned;
    CHECK_FALSE(warned.source(device, kFile.entries[0].key));
    REQUIRE(warned.texts.size() == 1);
    CHECK_THAT(warned.texts[0],
               Catch::Contains("other users may write '") && Catch::Contains("(mode 0666); the file is ignored"));
}

TEST_CASE("stored values: are not used if RAYA_TUNED is off or the cache folder is relative", "[tune]") {
    const ScopedCacheFolder cache;
    const DeviceInfo device = some_device();
    save_tuned(device, kFile);
    setenv("RAYA_TUNED", "off", 1);
    CHECK_FALSE(WarningRecorder().source);
    unsetenv("RAYA_TUNED");
    setenv("XDG_CACHE_HOME", "relative", 1);
    CHECK((!tuned_folder() || tuned_folder()->is_absolute()));
}

TEST_CASE("chosen: uses stored values unless lanes or group are given", "[tune]") {
    DeviceInfo device = some_device();
    device.type = "cpu";
    device.native_float_width = 16;
    const TuningKey workload{.torus = false, .accel = RAYA_ACCEL_NONE, .fp32 = true};
    CHECK(chosen({}, device, workload).origin == "defaults");
    const ScopedTunedSource source([](const DeviceInfo&, const TuningKey& key) -> std::optional<TunedChoice> {
        if (key.torus) return {};
        return TunedChoice{{4, 2, 0, 8, 2, 1, 96, 2}, "FILE, DATE"};
    });
    const KernelChoice tuned = chosen({}, device, workload);
    CHECK(tuned.origin == "FILE, DATE");
    CHECK((tuned.lanes == 4 && tuned.group_size == 2 && !tuned.local_words));
    CHECK(tuned.tuning == KernelTuning{8, 2, 1, 96});
    CHECK(tuned.link_move == LinkMove::kKernel);
    CHECK(tuned.link_origin == "FILE, DATE");
    const KernelChoice unknown = chosen({}, device, {.torus = true});
    CHECK(unknown.origin == "defaults");
    CHECK((unknown.link_move == LinkMove::kAutomatic && unknown.link_origin.empty()));
    KernelChoice by_copies;
    by_copies.link_move = LinkMove::kCopies;
    CHECK(chosen(by_copies, device, workload).link_move == LinkMove::kCopies);
    CHECK(chosen(by_copies, device, workload).link_origin == "options");
    CHECK(chosen(by_copies, device, workload).lanes == 4);
    KernelChoice with_group;
    with_group.group_size = 3;
    const KernelChoice options = chosen(with_group, device, workload);
    CHECK(options.origin == "options");
    CHECK((options.lanes == 16 && options.group_size == 3 && options.local_words));
    CHECK(options.tuning == KernelTuning{});
    CHECK((options.link_move == LinkMove::kAutomatic && options.link_origin.empty()));
}

}  // namespace
}  // namespace raya
