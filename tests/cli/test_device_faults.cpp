// Failures of the device, its driver, its compiler and its kernel cache, and of memory: exit code and message with the
// remedy, no files. Faults are injected by cl_faults.cpp, memory_faults.cpp and bad_driver.cpp.
#include <sys/mount.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

Arguments small_render(const ScratchFolder& outputs, Arguments more = {}) {
    more.insert(more.begin(), {"--size", "16", "--pes", "16", "--lanes", "4", "-q"});
    return render_into(outputs, scene_file("planes"), more);
}

TEST_CASE("render: the error for an OpenCL call that fails names the call, the error and the remedy", "[cli]") {
    struct Row {
        const char* fault;
        Arguments message, more{};
        bool sanitized = true;  // false: the address sanitizer handles the fault itself
    };
    const Arguments lost = {"CL_DEVICE_NOT_AVAILABLE", "another program may hold the device"};
    const Arguments crashed = {"raya: the OpenCL driver crashed (SIGSEGV) while ", "launching kernel 'trace'",
                               "remedy: ", "POCL_CACHE_DIR"};
    const ScratchFolder outputs;
    for (const Row& row : {
             Row{"clCreateBuffer 1 -4", {"allocating buffer '", "CL_MEM_OBJECT_ALLOCATION_FAILURE", "fewer pixels"}},
             Row{"clCreateBuffer 5 -6", {"allocating buffer '", "CL_OUT_OF_HOST_MEMORY", " has too little memory"}},
             Row{"clEnqueueNDRangeKernel 1 -4",
                 {"CL_MEM_OBJECT_ALLOCATION_FAILURE", "remedy: the device has too little"}},
             Row{"clCreateContext 1 -2", lost},
             Row{"clEnqueueNDRangeKernel 1 -2", lost},
             Row{"clEnqueueReadBuffer 1 -2", lost},
             Row{"clEnqueueNDRangeKernel 2 -2",
                 {"CL_DEVICE_NOT_AVAILABLE", "'add_neighbours'"},
                 {"--antialias", "filter"}},
             Row{"clEnqueueNDRangeKernel 1 crash", crashed, {}, false},
             Row{"clEnqueueNDRangeKernel 1 overflow", crashed, {}, false},
             Row{"clGetKernelWorkGroupInfo 4528 8",
                 {"groups of 16 work-items", "allows groups of 1..8", "--group 8"},
                 {"--group", "16"}},
         }) {
        if (kSanitized && !row.sanitized) continue;
        CAPTURE(row.fault);
        check_refused(outputs, small_render(outputs, row.more), 3, row.message, device_with_fault(row.fault));
    }
    check_refused(outputs,
                  {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "16", "--lanes", "4", "--machine",
                   "torus", "--nodes", "2x1x1", "--bounces", "4"},
                  3, lost, device_with_fault("clEnqueueNDRangeKernel 9 -2"));
    // raya refuses a buffer that is larger than the device allows, before it calls the driver.
    check_refused(
        outputs,
        render_into(outputs, scene_file("planes"), {"--size", "16384", "--machine", "grande", "--antialias", "filter"}),
        3, {"bytes for one buffer", "remedy: fewer pixels"}, {.variables = {{"POCL_MEMORY_LIMIT", "1"}}});
    const RunOutcome run = run_raya(small_render(outputs), device_with_fault("clCreateBuffer 1000000 -4"));  // control
    CHECK((run.code == 0 && outputs.entries() == 3));
}

TEST_CASE("render --profile: without memory for the peak measurement it prints no roofline and still succeeds",
          "[cli]") {
    // The n-th buffer and all later ones fail: for small n one of the render, for larger n one of the measurement.
    int failed_renders = 0, missing_peaks = 0;
    for (int n = 1; n < 60; n += thorough() ? 1 : 8) {
        const ScratchFolder outputs;
        const RunOutcome run = run_raya(small_render(outputs, {"--profile"}),
                                        device_with_fault("clCreateBuffer " + std::to_string(n) + " -4"));
        CAPTURE(n, run.describe());
        failed_renders += run.code == 3;
        if (run.code == 3) continue;
        REQUIRE(run.code == 0);
        CHECK(outputs.entries() == 3);
        if (!contains(run.out, "no roofline: ")) break;  // n exceeds the number of buffers
        ++missing_peaks;
        CHECK_THAT(run.out, Catch::Contains("CL_MEM_OBJECT_ALLOCATION_FAILURE") && !Catch::Contains("% of roof"));
    }
    CHECK(failed_renders >= 1);
    CHECK(missing_peaks >= 1);
}

TEST_CASE("render: a failed allocation anywhere in raya ends the run with a message; a memory limit is named",
          "[cli]") {
    if (kSanitized) return;  // the sanitizer has an allocator of its own
    const ScratchFolder outputs;
    check_refused(outputs, render_into(outputs, scene_file("planes"), {"--size", "512", "--lanes", "4"}), 2,
                  {"raya: out of memory on the host; remedy: fewer pixels"}, device_with_fault("new 1000000 0"));
    // Allocations before main(), while options are declared, while they are parsed, and in the render.
    for (const char* number : {"=1", "=100", "=1000", "=10000", "=20000"})
        check_refused(outputs, small_render(outputs), 2, {"raya: out of memory on the host"},
                      {.variables = {{"LD_PRELOAD", RAYA_MEMORY_FAULTS}, {"RAYA_MEMORY_FAULT", number}}});
    check_refused(outputs, {"render", scene_file("planes"), "-o", outputs / "x.png"}, 3,
                  {"no OpenCL device found; remedy: raise the limit of 100 MB on memory"},
                  {.max_memory_bytes = 100 << 20});
    check_refused(outputs, {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "512", "--lanes", "4"},
                  2, {"x.pfm", "File too large", "ulimit -f"}, {.max_file_bytes = 1 << 21});
    const ScratchFolder inputs;
    std::ofstream mesh(inputs / "large.obj");  // assimp needs far more memory than this text
    for (int i = 0; i < 100'000; ++i) mesh << "v 0 0 1\n";
    for (int i = 0; i < 400'000; ++i) mesh << "f 1 2 3\n";
    mesh.close();
    check_refused(outputs, {"info", inputs / "large.obj"}, 2, {"large.obj: "}, {.max_memory_bytes = 150 << 20});
}

TEST_CASE("render: faults of kernels: one that does not compile, one that ends early, a wrong build option", "[cli]") {
    const ScratchFolder kernels, outputs;
    const SourcePatch mistake{"geometry/sphere.clh", "#include \"kernels/geometry/ray.clh\"", "no_such_type broken;"},
        early_end{"ring/trace.cl", "store.points = points;",
                  "store.points = points; store.end -= group == 3 && store.end > 0;"};
    check_refused(outputs, small_render(outputs, {"--kernel-dir", write_kernels(kernels / "broken", {mistake})}), 3,
                  {"building program 'ring/trace.cl'", "CL_BUILD_PROGRAM_FAILURE", "remedy",
                   "device: ", "options: -cl-std=CL1.2 ", "build log:", "geometry/sphere.clh:", "no_such_type"});
    check_refused(outputs, small_render(outputs, {"--kernel-dir", write_kernels(kernels / "early", {early_end})}), 3,
                  {"ended the trace kernel after 255 of 256 pixels", "remedy: ", "raya verify", "--pes"});
    check_refused(outputs, small_render(outputs), 3, {"building program 'ring/trace.cl'", "-no-such-option"},
                  {.variables = {{"RAYA_BUILD_OPTIONS", "-no-such-option"}}});
}

TEST_CASE("devices: a driver with two ICD entries is listed once; equal devices have different numbers", "[cli]") {
    const fs::path pocl = "/etc/OpenCL/vendors/pocl.icd";
    if (!fs::exists(pocl)) return;
    const ScratchFolder vendors, outputs;
    for (const char* name : {"a.icd", "b.icd"}) fs::copy_file(pocl, vendors / name);
    const auto run_with = [&](const Arguments& arguments, const char* pocl_devices) {
        return run_raya(arguments,
                        {.variables = {{"OCL_ICD_VENDORS", vendors.path()}, {"POCL_DEVICES", pocl_devices}}});
    };
    const auto numbers = [&](const char* pocl_devices) {
        const std::string out = run_with({"devices"}, pocl_devices).out;
        return contains(out, "0  ") + contains(out, "\n1  ") + contains(out, "\n2  ");
    };
    CHECK(numbers("pthread") == 1);
    CHECK(numbers("pthread basic") == 2);
    CHECK(numbers("pthread pthread") == 2);
    for (const char* device : {"1", "cpu", "0,1"})
        CHECK(run_with(small_render(outputs, {"--device", device}), "pthread pthread").code == 0);
    const RunOutcome refused = run_with(small_render(outputs, {"--device", "nosuch"}), "pthread pthread");
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Catch::Contains("no OpenCL device matches 'nosuch'") && Catch::Contains("\n  1: ") &&
                                !Catch::Contains("\n  2: "));
}

TEST_CASE("a driver that crashes or hangs is reported with a remedy; one that fails is left out", "[cli]") {
    const fs::path pocl = "/etc/OpenCL/vendors/pocl.icd";
    if (!fs::exists(pocl) || kSanitized) return;
    const ScratchFolder vendors, outputs;
    fs::copy_file(pocl, vendors / "pocl.icd");
    std::ofstream(vendors / "bad.icd") << RAYA_BAD_DRIVER "\n";
    const Arguments verify = {"verify", "--only", "machine mapping: rows"};
    const auto with_fault = [&](const std::string& fault) -> RunOptions {
        return {.variables = {{"OCL_ICD_VENDORS", vendors.path()}, {"RAYA_BAD_DRIVER", fault}}};
    };
    for (const char* const fault : {"crash platforms", "crash devices", "crash info"}) {
        CAPTURE(fault);
        check_refused(outputs, {"devices"}, 3, {"OCL_ICD_VENDORS"}, with_fault(fault));
    }
    RunOptions hang = with_fault("hang devices");
    hang.signal = SIGTERM;
    hang.signal_after_ms = 11'000;
    check_refused(outputs, {"devices"}, 128 + SIGTERM, {"one may hang; remedy: leave out the driver"}, hang);
    check_refused(outputs, verify, 3, {"OCL_ICD_VENDORS"}, with_fault("crash platforms"));
    for (const char* const fault : {"fail devices", "fail info", ""})
        for (const Arguments& command : {Arguments{"devices"}, verify}) {
            const RunOutcome run = run_raya(command, with_fault(fault));
            INFO(fault << "\n" << run.describe());
            CHECK(run.code == 0);
            CHECK(contains(run.err, "left out") == (fault[0] != '\0'));
            CHECK(contains(run.err, "Bad driver") == (fault[0] != '\0'));
            CHECK_THAT(run.out, Catch::Contains("Portable Computing Language"));
        }
}

// PoCL keeps the private memory of a whole work-group on the stack of one thread, so large groups may overflow it.
TEST_CASE("render --group: 1024 work-items of 16 lanes render the same image as one work-item", "[cli]") {
    const auto image_of = [](const Arguments& group, const char* device, const Arguments& more) {
        const ScratchFolder outputs;
        Arguments arguments = {"render", scene_file("centre"), "-o", outputs / "x.pfm", "--size", "16"};
        for (const Arguments& part : {group, more}) arguments.insert(arguments.end(), part.begin(), part.end());
        const RunOutcome run = run_raya(arguments, {.variables = {{"POCL_DEVICES", device}}});
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return file_contents(outputs / "x.pfm");
    };
    for (const char* device : quick(1, {"pthread", "basic"}))
        for (const Arguments& more :
             quick(1, {Arguments{"--machine", "grande"},
                       {"--machine", "torus", "--nodes", "2x1x1"},
                       {"--machine", "grande", "--antialias", "filter"},
                       {"--machine", "grande", "--bounces", "31", "--accel", "bvh", "--antialias", "supersample"}}))
            CHECK(image_of({"--lanes", "16", "--group", "1024"}, device, more) == image_of({}, device, more));
}

/// If the process has the permission, mounts a file system of `bytes` bytes at `folder` for the object's lifetime.
struct SmallFileSystem {
    SmallFileSystem(const fs::path& at, int bytes)
        : folder(at),
          is_mounted(::mount("none", at.c_str(), "tmpfs", 0, ("size=" + std::to_string(bytes)).c_str()) == 0) {}
    SmallFileSystem(const SmallFileSystem&) = delete;
    SmallFileSystem& operator=(const SmallFileSystem&) = delete;
    ~SmallFileSystem() {
        if (is_mounted) ::umount2(folder.c_str(), MNT_DETACH);
    }

    fs::path folder;
    bool is_mounted;
};

TEST_CASE("kernel cache: the errors for a damaged, a full and an unwritable cache contain the remedy", "[cli]") {
    if (kSanitized) return;
    const ScratchFolder cache, locked, outputs;
    const auto with_cache = [](const ScratchFolder& folder, bool as_nobody = false) {
        return RunOptions{.variables = {{"POCL_CACHE_DIR", folder.path()}}, .as_nobody = as_nobody};
    };
    {
        const ScratchFolder others;
        const RunOutcome first = run_raya(
            {"render", scene_file("planes"), "-o", others / "x.pfm", "--size", "16", "--pes", "16", "--lanes", "4"},
            with_cache(cache));
        REQUIRE(first.code == 0);
        CHECK(std::regex_match(first.err, std::regex("raya: compiling kernels for .* \\(first run only\\) \\.\\.\\.\n"
                                                     "raya: compiling kernels took [0-9]+\\.[0-9] s\n")));
    }
    for (const auto& entry : fs::recursive_directory_iterator(cache.path()))
        if (entry.path().extension() == ".bc") std::ofstream(entry.path()) << "damaged";
    check_refused(outputs, small_render(outputs), 3,
                  {"the OpenCL driver crashed (SIGABRT) while building program", "empty folder"}, with_cache(cache));
    ::chmod(outputs.path().c_str(), 0777);
    ::chmod(locked.path().c_str(), 0555);
    check_refused(outputs, small_render(outputs), 3,
                  {"raya: building program 'ring/trace.cl': PoCL's kernel cache (POCL_CACHE_DIR=" +
                       locked.path().string() + "): cannot write '",
                   "is not writable; ", "build log:"},
                  with_cache(locked, true));
    for (const int bytes : {4 << 10, 300 << 10}) {  // PoCL or LLVM fails first
        const ScratchFolder full;
        const SmallFileSystem disk(full.path(), bytes);
        if (!disk.is_mounted) return;
        check_refused(outputs, small_render(outputs), 3,
                      {"No space left on device", "free some space", "POCL_CACHE_DIR"}, with_cache(full));
    }
    const ScratchFolder empty;  // memory runs out during a build, while the driver holds a lock
    RunOptions no_memory = device_with_fault("new 1000000 0");
    no_memory.variables.emplace_back("POCL_CACHE_DIR", empty.path());
    check_refused(outputs, small_render(outputs), 2, {"out of memory on the host"}, no_memory);
}

/// Returns true if raya or its child processes load a library whose name contains one of `parts` (LD_DEBUG, ld.so(8)).
bool loads(const Arguments& arguments, const std::string& parts, int code = 0) {
    const ScratchFolder logs;
    const RunOutcome run =
        run_raya(arguments, {.variables = {{"LD_DEBUG", "files"}, {"LD_DEBUG_OUTPUT", logs / "process"}}});
    INFO(run.describe());
    REQUIRE(run.code == code);
    bool found = false;
    for (const auto& process : fs::directory_iterator(logs.path()))
        found = found || has_line(file_contents(process.path()), ".*calling init: .*/[^/]*(" + parts + ").*");
    return found;
}

TEST_CASE("raya loads libraries only when it needs them: drivers, OpenImageIO, MPI", "[cli]") {
    const ScratchFolder outputs;
    const std::string planes = scene_file("planes"), image = outputs / "x.tif", missing = outputs / "none";
    const Arguments small = {"--size", "16", "--pes", "16", "--lanes", "4"};
    CHECK_FALSE(loads({"--version"}, "raya_|OpenImageIO|libtbb|libmpi|libpocl|libLLVM"));
    CHECK_FALSE(loads({"devices"}, "raya_|OpenImageIO|libtbb|libmpi"));
    Arguments render = {"render", planes, "-o", outputs / "x.png"};
    render.insert(render.end(), small.begin(), small.end());
    CHECK_FALSE(loads(render, "raya_|OpenImageIO|libtbb|libmpi"));
    render[3] = image;
    CHECK(loads(render, "raya_pictures"));
    for (const Arguments& refused : {Arguments{"render", missing, "-o", image},
                                     {"render", planes, "-o", outputs / "none/x.tif"},
                                     {"render", planes, "-o", image, "--size", "0"},
                                     {"render", planes, "-o", image, "--kernel-dir", missing},
                                     {"bench", "--compare", missing},
                                     {"tune", missing},
                                     {"explore", missing, "-o", outputs / "x.html"},
                                     {"verify", "--kernel-dir", missing}})
        CHECK_FALSE(loads(refused, "raya_pictures|OpenImageIO|libtbb|libpocl", 2));
}

}  // namespace
}  // namespace raya
