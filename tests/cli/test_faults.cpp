// Faults during a render: raya ends with a message and an exit code, and leaves neither output files nor parts of them.
#include <fmt/core.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <utility>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {
namespace {

Arguments small_render(const ScratchFolder& outputs, const Arguments& extra_options = {}) {
    Arguments options = {"--size", "16", "--lanes", "1", "--quiet"};
    options.insert(options.end(), extra_options.begin(), extra_options.end());
    return render_into(outputs, scene_file("planes"), options);
}

TEST_CASE("render: if the device runs out of memory, the error names buffer, OpenCL error and remedy", "[cli]") {
    const ScratchFolder outputs;
    for (const auto& [fault, name] :
         {std::pair("1 -4", "CL_MEM_OBJECT_ALLOCATION_FAILURE"), std::pair("2 -5", "CL_OUT_OF_RESOURCES"),
          std::pair("5 -6", "CL_OUT_OF_HOST_MEMORY")}) {
        CAPTURE(fault);
        check_refused(outputs, small_render(outputs), 3,
                      {"allocating buffer '", "bytes)", name, " has too little memory", "fewer pixels"},
                      device_with_fault(std::string("clCreateBuffer ") + fault));
    }
    // Drivers that allocate a buffer only at its first use fail at the kernel launch.
    check_refused(outputs, small_render(outputs), 3,
                  {"CL_MEM_OBJECT_ALLOCATION_FAILURE", "trace", "remedy: the device has too little memory"},
                  device_with_fault("clEnqueueNDRangeKernel 1 -4"));
    // raya refuses a buffer that is larger than the device allows, before it calls the driver.
    check_refused(
        outputs,
        render_into(outputs, scene_file("planes"), {"--size", "16384", "--machine", "grande", "--antialias", "filter"}),
        3, {"bytes for one buffer", "remedy: fewer pixels"}, {.variables = {{"POCL_MEMORY_LIMIT", "1"}}});
}

TEST_CASE("render: if the device is lost, the error names the command and the OpenCL error", "[cli]") {
    const ScratchFolder outputs;
    const Arguments message = {"CL_DEVICE_NOT_AVAILABLE", "another program may hold the device"};
    for (const char* call : {"clCreateContext 1 -2", "clEnqueueNDRangeKernel 1 -2", "clEnqueueReadBuffer 1 -2"}) {
        CAPTURE(call);
        check_refused(outputs, small_render(outputs), 3, message, device_with_fault(call));
    }
    check_refused(outputs, small_render(outputs, {"--antialias", "filter"}), 3,
                  {"CL_DEVICE_NOT_AVAILABLE", "'add_neighbours'"}, device_with_fault("clEnqueueNDRangeKernel 2 -2"));
    check_refused(outputs,
                  {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "16", "--lanes", "1", "--machine",
                   "torus", "--nodes", "2x1x1"},
                  3, message, device_with_fault("clEnqueueNDRangeKernel 9 -2"));
}

TEST_CASE("render --profile: without memory for the peak measurement it prints no roofline and still succeeds",
          "[cli]") {
    // The n-th buffer and all later ones fail. For small n, the n-th buffer belongs to the render, which then fails;
    // for larger n, it belongs to the peak measurement.
    int failed_renders = 0, missing_peaks = 0;
    for (int n = 1; n < 60; n += thorough() ? 1 : 4) {
        const ScratchFolder outputs;
        const RunOutcome run =
            run_raya(small_render(outputs, {"--profile"}), device_with_fault(fmt::format("clCreateBuffer {} -4", n)));
        CAPTURE(n, run.describe());
        failed_renders += run.code == 3;
        if (run.code == 3) continue;
        REQUIRE(run.code == 0);
        CHECK(outputs.entries() == 3);
        const bool has_no_peak = run.out.find("no roofline: ") != std::string::npos;
        CHECK(has_no_peak == (run.out.find("% of roof") == std::string::npos));
        if (!has_no_peak) break;  // n exceeds the number of buffers
        ++missing_peaks;
        CHECK_THAT(run.out, Catch::Contains("CL_MEM_OBJECT_ALLOCATION_FAILURE"));
    }
    CHECK(failed_renders >= (thorough() ? 3 : 1));
    CHECK(missing_peaks >= (thorough() ? 3 : 1));
}

TEST_CASE("render: if the host runs out of memory, the error contains the remedy", "[cli]") {
    const ScratchFolder outputs;
    Arguments options = small_render(outputs);
    options[std::find(options.begin(), options.end(), "--size") - options.begin() + 1] = "512";  // 3 MB of pixels
    if (kSanitized)
        WARN("skipped: the sanitizer has an allocator of its own");
    else
        check_refused(outputs, options, 2, {"raya: out of memory on the host; remedy: fewer pixels"},
                      device_with_fault("new 1000000 0"));
}

TEST_CASE("render: a failed allocation anywhere in raya ends the run with a message", "[cli]") {
    if (kSanitized) {
        WARN("skipped: the sanitizer has an allocator of its own");
        return;
    }
    const auto count_outputs = [](const std::string& number) {
        const ScratchFolder outputs;
        const RunOutcome run =
            run_raya(small_render(outputs),
                     {.variables = {{"LD_PRELOAD", RAYA_MEMORY_FAULTS}, {"RAYA_MEMORY_FAULT", "=" + number}}});
        CAPTURE(number, run.describe());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Catch::Contains("raya: out of memory on the host"));
        return outputs.entries();
    };
    // These allocations happen before main(), while options are declared, while they are parsed, and in the render.
    for (const char* number : {"1", "100", "1000", "10000", "20000"}) CHECK(count_outputs(number) == 0);
}

TEST_CASE("render: the error names a memory limit that is too small for a library", "[cli]") {
    if (kSanitized) {
        WARN("skipped: the sanitizer takes more memory than any limit");
        return;
    }
    const ScratchFolder outputs;
    const RunOptions run_options{.max_memory_bytes = 100 << 20};
    const auto render = [&](const std::string& image) {
        return run_raya({"render", scene_file("planes"), "--size", "16", "-o", outputs / image}, run_options);
    };
    const RunOutcome run = render("x.png");
    INFO(run.describe());
    CHECK(run.code == 3);
    CHECK_THAT(run.err, Catch::Contains("no OpenCL device found; remedy: raise the limit of 100 MB on memory"));
    CHECK(outputs.entries() == 0);
}

TEST_CASE("render: succeeds with a fault that is never reached (control)", "[cli]") {
    const ScratchFolder outputs;
    const RunOutcome run = run_raya(small_render(outputs), device_with_fault("clCreateBuffer 1000000 -4"));
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(outputs.entries() == 3);
}

TEST_CASE("render --device: the error for a device that is no longer there lists the available devices", "[cli]") {
    const ScratchFolder outputs;
    const RunOptions basic{.variables = {{"POCL_DEVICES", "basic"}}};  // PoCL 5 and later name it cpu-minimal
    const std::string name =
        run_raya({"devices"}, basic).out.find("minimal") == std::string::npos ? "basic" : "minimal";
    const Arguments arguments = small_render(outputs, {"--device", name});
    const RunOutcome run = run_raya(arguments, basic);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    for (const auto& entry : std::filesystem::directory_iterator(outputs.path())) std::filesystem::remove(entry);
    check_refused(outputs, arguments, 3, {"no OpenCL device matches '" + name + "'", "\n  0: "},
                  {.variables = {{"POCL_DEVICES", "pthread"}}});
}

// Returns the arguments of a render that writes an image file of 3 MB. Kernel and report files are far smaller.
Arguments large_render(const std::string& image) {
    return {"render", scene_file("planes"), "-o", image, "--size", "512", "--lanes", "4", "--quiet"};
}

TEST_CASE("render: beyond a file size limit, the error contains the reason and no file is left", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, large_render(outputs / "x.pfm"), 2, {"x.pfm", "File too large", "ulimit -f"},
                  {.max_file_bytes = 1 << 21});
}

/// Returns the options of a run in which the folder `outputs` has space for `bytes` bytes (disk_faults.cpp).
RunOptions full_disk(const ScratchFolder& outputs, const std::string& bytes) {
    return {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                          {"RAYA_FULL_DISK", bytes + " " + std::filesystem::canonical(outputs.path()).string()},
                          {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}};
}

TEST_CASE("render: on a full disk, the error contains the reason and no file is left", "[cli]") {
    const ScratchFolder outputs;
    // The disk is full before the first byte of the image (a colour PFM), in the middle, and before its last byte.
    const std::string header = "PF\n512 512\n-1.0\n";
    const std::size_t image_bytes = header.size() + 12 * 512 * 512;
    for (const std::size_t free_bytes : {std::size_t{0}, std::size_t{1} << 20, image_bytes - 1}) {
        CAPTURE(free_bytes);
        check_refused(outputs, large_render(outputs / "x.pfm"), 2,
                      {"x.pfm", "No space left on device", "free some space there or name a file on another disk"},
                      full_disk(outputs, std::to_string(free_bytes)));
    }
    // The run succeeds if the image exactly fits.
    const RunOutcome run = run_raya(large_render(outputs / "x.pfm"), full_disk(outputs, std::to_string(image_bytes)));
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(std::filesystem::file_size(outputs / "x.pfm") == image_bytes);
}

TEST_CASE("render: a full disk leaves an older file unchanged", "[cli]") {
    const ScratchFolder outputs;
    std::ofstream(outputs / "x.pfm") << "older";
    const RunOutcome run = run_raya(large_render(outputs / "x.pfm"), full_disk(outputs, "1000"));
    INFO(run.describe());
    CHECK(run.code == 2);
    CHECK(outputs.entries() == 1);
    CHECK(file_contents(outputs / "x.pfm") == "older");
}

TEST_CASE("render: SIGINT and SIGTERM end a long render at once, without a file", "[cli]") {
    const ScratchFolder outputs;
    // A render that takes minutes: a large image, one lane, a slow format.
    const Arguments long_render_options = {"--size",    "4096",   "--lanes",  "1",
                                           "--machine", "grande", "--format", "e8m21"};
    for (const int signal : {SIGINT, SIGTERM}) {
        for (const int after_ms : {0, 1500}) {  // while the kernel is built, and while it runs
            CAPTURE(signal, after_ms);
            check_refused(outputs, render_into(outputs, scene_file("spheres"), long_render_options), 128 + signal,
                          {"raya: interrupted\n"}, {.signal = signal, .signal_after_ms = after_ms});
        }
    }
}

}  // namespace
}  // namespace raya
