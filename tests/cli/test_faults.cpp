// What can go wrong around a render once it has begun: a clear message, the right exit code, and no file, whole or not.
#include <fmt/core.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <utility>

#include "tests/cli/failing_device.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {
namespace {

Words small_render(const ScratchFolder& outputs, const Words& more = {}) {
    Words options = {"--size", "16", "--lanes", "1", "--quiet"};
    options.insert(options.end(), more.begin(), more.end());
    return render_into(outputs, scene_file("planes"), options);
}

TEST_CASE("a device that runs out of memory ends with buffer, error and remedy", "[cli]") {
    const ScratchFolder outputs;
    for (const auto& [fault, name] :
         {std::pair("1 -4", "CL_MEM_OBJECT_ALLOCATION_FAILURE"), std::pair("2 -5", "CL_OUT_OF_RESOURCES"),
          std::pair("5 -6", "CL_OUT_OF_HOST_MEMORY")}) {
        CAPTURE(fault);
        check_refused(outputs, small_render(outputs), 3,
                      {"allocating buffer '", "bytes)", name, " lacks memory", "fewer pixels"},
                      failing_device(std::string("clCreateBuffer ") + fault));
    }
    // Drivers that take memory at the first use of a buffer say so at the launch.
    check_refused(outputs, small_render(outputs), 3,
                  {"CL_MEM_OBJECT_ALLOCATION_FAILURE", "trace", "remedy: the device lacks memory"},
                  failing_device("clEnqueueNDRangeKernel 1 -4"));
    // More than the device allows for one buffer: known before the driver is asked.
    check_refused(
        outputs,
        render_into(outputs, scene_file("planes"), {"--size", "16384", "--machine", "grande", "--antialias", "filter"}),
        3, {"bytes for one buffer", "remedy: fewer pixels"}, {.variables = {{"POCL_MEMORY_LIMIT", "1"}}});
}

TEST_CASE("a device that disappears in the middle of a render ends with the command and the error", "[cli]") {
    const ScratchFolder outputs;
    const Words message = {"CL_DEVICE_NOT_AVAILABLE", "another program may hold the device"};
    for (const char* call : {"clCreateContext 1 -2", "clEnqueueNDRangeKernel 1 -2", "clEnqueueReadBuffer 1 -2"}) {
        CAPTURE(call);
        check_refused(outputs, small_render(outputs), 3, message, failing_device(call));
    }
    check_refused(outputs, small_render(outputs, {"--antialias", "filter"}), 3,
                  {"CL_DEVICE_NOT_AVAILABLE", "'add_neighbours'"}, failing_device("clEnqueueNDRangeKernel 2 -2"));
    check_refused(outputs,
                  {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "16", "--lanes", "1", "--machine",
                   "torus", "--nodes", "2x1x1"},
                  3, message, failing_device("clEnqueueNDRangeKernel 9 -2"));
}

TEST_CASE("a device that lacks memory for the peak loses the roofline, not the render", "[cli]") {
    // The n-th buffer cannot be had: first those of the render, which fails, then those of the peak, which does not.
    int lost_renders = 0, lost_peaks = 0;
    for (int n = 1; n < 60; n += thorough() ? 1 : 4) {
        const ScratchFolder outputs;
        const RunOutcome run =
            run_raya(small_render(outputs, {"--profile"}), failing_device(fmt::format("clCreateBuffer {} -4", n)));
        CAPTURE(n, run.told());
        lost_renders += run.code == 3;
        if (run.code == 3) continue;
        REQUIRE(run.code == 0);
        CHECK(outputs.entries() == 3);
        const bool lost = run.out.find("no roofline: ") != std::string::npos;
        CHECK(lost == (run.out.find("% of roof") == std::string::npos));
        if (!lost) break;  // no buffer is left that could be lacking
        ++lost_peaks;
        CHECK_THAT(run.out, Catch::Contains("CL_MEM_OBJECT_ALLOCATION_FAILURE"));
    }
    CHECK(lost_renders >= (thorough() ? 3 : 1));
    CHECK(lost_peaks >= (thorough() ? 3 : 1));
}

TEST_CASE("a host that runs out of memory ends with the remedy", "[cli]") {
    const ScratchFolder outputs;
    Words options = small_render(outputs);
    options[std::find(options.begin(), options.end(), "--size") - options.begin() + 1] = "512";  // 3 MB of pixels
    if (kSanitized)
        WARN("skipped: the sanitizer has an allocator of its own");
    else
        check_refused(outputs, options, 2, {"raya: out of memory on the host; remedy: fewer pixels"},
                      failing_device("new 1000000 0"));
}

TEST_CASE("memory that ends anywhere in raya ends it with a message", "[cli]") {
    if (kSanitized) {
        WARN("skipped: the sanitizer has an allocator of its own");
        return;
    }
    const auto outputs_of = [](const std::string& number) {
        const ScratchFolder outputs;
        const RunOutcome run =
            run_raya(small_render(outputs),
                     {.variables = {{"LD_PRELOAD", RAYA_MEMORY_FAULTS}, {"RAYA_MEMORY_FAULT", "=" + number}}});
        CAPTURE(number, run.told());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Catch::Contains("raya: out of memory on the host"));
        return outputs.entries();
    };
    // Before main(), while the options are made, while they are read, in the render.
    for (const char* number : {"1", "100", "1000", "10000", "20000"}) CHECK(outputs_of(number) == 0);
}

TEST_CASE("a limit on memory in which a library does not fit is named", "[cli]") {
    if (kSanitized) {
        WARN("skipped: the sanitizer takes more memory than any limit");
        return;
    }
    const ScratchFolder outputs;
    const Surroundings around{.memory = 100 << 20};
    const auto render = [&](const std::string& image) {
        return run_raya({"render", scene_file("planes"), "--size", "16", "-o", outputs / image}, around);
    };
    const RunOutcome run = render("x.png");
    INFO(run.told());
    CHECK(run.code == 3);
    CHECK_THAT(run.err, Catch::Contains("no OpenCL device found; remedy: raise the limit of 100 MB on memory"));
    CHECK(outputs.entries() == 0);
}

TEST_CASE("without a fault the same runs end well: the tests above can fail", "[cli]") {
    const ScratchFolder outputs;
    const RunOutcome run = run_raya(small_render(outputs), failing_device("clCreateBuffer 1000000 -4"));
    INFO(run.told());
    CHECK(run.code == 0);
    CHECK(outputs.entries() == 3);
}

TEST_CASE("a device that is there no more is named, with those that there are", "[cli]") {
    const ScratchFolder outputs;
    const Words with = small_render(outputs, {"--device", "basic"});
    const RunOutcome there = run_raya(with, {.variables = {{"POCL_DEVICES", "basic"}}});
    INFO(there.told());
    REQUIRE(there.code == 0);
    for (const auto& entry : std::filesystem::directory_iterator(outputs.path())) std::filesystem::remove(entry);
    check_refused(outputs, with, 3, {"no OpenCL device matches 'basic'", "\n  0: "},
                  {.variables = {{"POCL_DEVICES", "pthread"}}});
}

// An image of 3 MB; kernels and reports are far smaller.
Words large_render(const std::string& image) {
    return {"render", scene_file("planes"), "-o", image, "--size", "512", "--lanes", "4", "--quiet"};
}

TEST_CASE("a file that may not grow far enough ends with the reason and leaves nothing", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, large_render(outputs / "x.pfm"), 2, {"x.pfm", "File too large", "ulimit -f"},
                  {.largest_file = 1 << 20});
}

/// A disk under `outputs` that takes so many bytes, see disk_faults.cpp.
Surroundings full_disk(const ScratchFolder& outputs, const std::string& bytes) {
    return {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                          {"RAYA_FULL_DISK", bytes + " " + std::filesystem::canonical(outputs.path()).string()},
                          {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}};
}

TEST_CASE("a full disk ends with the reason and leaves nothing", "[cli]") {
    const ScratchFolder outputs;
    // Before the first byte; in the middle; one byte before the end of the image (its header is that of a colour PFM).
    const std::string header = "PF\n512 512\n-1.0\n";
    const std::size_t whole = header.size() + 12 * 512 * 512;
    for (const std::size_t room : {std::size_t{0}, std::size_t{1} << 20, whole - 1}) {
        CAPTURE(room);
        check_refused(outputs, large_render(outputs / "x.pfm"), 2,
                      {"x.pfm", "No space left on device", "make room there or name a file on another disk"},
                      full_disk(outputs, std::to_string(room)));
    }
    // With room enough the same run ends well: the disk is no more than full.
    const RunOutcome run = run_raya(large_render(outputs / "x.pfm"), full_disk(outputs, std::to_string(whole)));
    INFO(run.told());
    CHECK(run.code == 0);
    CHECK(std::filesystem::file_size(outputs / "x.pfm") == whole);
}

TEST_CASE("a full disk leaves an older file as it was", "[cli]") {
    const ScratchFolder outputs;
    std::ofstream(outputs / "x.pfm") << "older";
    const RunOutcome run = run_raya(large_render(outputs / "x.pfm"), full_disk(outputs, "1000"));
    INFO(run.told());
    CHECK(run.code == 2);
    CHECK(outputs.entries() == 1);
    CHECK(file_contents(outputs / "x.pfm") == "older");
}

TEST_CASE("Ctrl-C in a long render ends it at once, without a file", "[cli]") {
    const ScratchFolder outputs;
    // Minutes of work: by one lane, in a format that is slow.
    const Words minutes = {"--size", "4096", "--lanes", "1", "--machine", "grande", "--format", "e8m21"};
    for (const int signal : {SIGINT, SIGTERM}) {
        for (const int after_ms : {0, 1500}) {  // while the kernel is built; while it runs
            CAPTURE(signal, after_ms);
            check_refused(outputs, render_into(outputs, scene_file("spheres"), minutes), 128 + signal,
                          {"raya: interrupted\n"}, {.signal = signal, .signal_after_ms = after_ms});
        }
    }
}

}  // namespace
}  // namespace raya
