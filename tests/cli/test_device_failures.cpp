// Failures of the device, its driver or its compiler: exit code 3 and a message with the remedy.
#include <sys/mount.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

TEST_CASE("render: the error for a kernel that does not compile has device, options and build log", "[cli]") {
    const ScratchFolder kernels, outputs;
    const SourcePatch mistake{"geometry/sphere.clh", "#include \"kernels/geometry/ray.clh\"", "no_such_type broken;"};
    const std::string broken = write_kernels(kernels / "kernels", {mistake}), planes = scene_file("planes");
    const std::string text = kernel_file(mistake.file);
    const auto line = 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(text.find(mistake.find)), '\n');
    check_refused(outputs, render_into(outputs, planes, {"--lanes", "4", "--kernel-dir", broken}), 3,
                  {"building program 'ring/trace.cl'", "CL_BUILD_PROGRAM_FAILURE", "remedy",
                   "device: ", "options: -cl-std=CL1.2 ", "build log:", "geometry/sphere.clh:" + std::to_string(line),
                   "no_such_type"});
}

TEST_CASE("render: detects by the pixel count that the device ended a loop early, and writes no file", "[cli]") {
    const ScratchFolder kernels, outputs;
    const SourcePatch early_end{"ring/trace.cl", "store.points = points;",
                                "store.points = points; store.end -= group == 3 && store.end > 0;"};
    const std::string broken = write_kernels(kernels / "kernels", {early_end}), planes = scene_file("planes");
    for (const char* method : {"none", "supersample"}) {
        CAPTURE(method);
        check_refused(outputs,
                      render_into(outputs, planes,
                                  {"--size", "16", "--pes", "16", "--kernel-dir", broken, "--antialias", method}),
                      3, {"ended the trace kernel after 255 of 256 pixels", "remedy: ", "raya verify", "--pes"});
    }
}

TEST_CASE("RAYA_BUILD_OPTIONS: every build uses it, and the report and the error of a failed build show it", "[cli]") {
    const ScratchFolder outputs;
    const RunOutcome run =
        run_raya(render_into(outputs, scene_file("planes"), {"--size", "16", "--quiet", "--lanes", "4"}),
                 {.variables = {{"RAYA_BUILD_OPTIONS", "-cl-opt-disable -DNO_MATTER=1"}}});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(contains(file_contents(outputs / "x.json"), "-cl-opt-disable -DNO_MATTER=1\""));
    const ScratchFolder no_outputs;
    check_refused(no_outputs, render_into(no_outputs, scene_file("planes"), {"--size", "16"}), 3,
                  {"building program 'ring/trace.cl'", "-no-such-option"},
                  {.variables = {{"RAYA_BUILD_OPTIONS", "-no-such-option"}}});
}

TEST_CASE("RAYA_BUILD_OPTIONS: options that may change results cause a warning, also in the report", "[cli]") {
    const auto warnings_for = [](const std::string& options) {
        const ScratchFolder outputs;
        const RunOutcome run = run_raya({"render", scene_file("planes"), "-o", outputs / "x.pfm", "--report",
                                         outputs / "x.json", "--size", "8", "--pes", "8", "--lanes", "4", "-q"},
                                        {.variables = {{"RAYA_BUILD_OPTIONS", options}}});
        INFO(run.describe());
        CHECK(run.code == 0);
        std::vector<std::string> all =
            Document::parse(file_contents(outputs / "x.json")).value("warnings", Arguments());
        for (const std::string& text : all) CHECK_THAT(run.err, Catch::Contains("raya: warning: " + text));
        return all;
    };
    CHECK(warnings_for("").empty());
    CHECK(warnings_for("-cl-opt-disable -w -cl-fp32-correctly-rounded-divide-sqrt").empty());
    for (const char* option : {"-cl-fast-relaxed-math", "-cl-unsafe-math-optimizations", "-cl-finite-math-only",
                               "-cl-mad-enable", "-cl-no-signed-zeros", "-cl-denorms-are-zero", "-DRAYA_OTHER=1"})
        CHECK(warnings_for(std::string("-cl-opt-disable ") + option) ==
              Arguments{std::string("RAYA_BUILD_OPTIONS: ") + option + " may change pixels and counts"});
    for (const Arguments& arguments :
         {Arguments{"bench", "--size", "8", "--pes", "8", "--samples", "1", "--lanes", "4", "--format", "fp32"},
          Arguments{"verify", "--only", "machine bus", "--lanes", "4"}}) {
        const RunOutcome run = run_raya(arguments, {.variables = {{"RAYA_BUILD_OPTIONS", "-cl-mad-enable"}}});
        INFO(run.describe());
        CHECK_THAT(run.err, Catch::Contains("raya: warning: RAYA_BUILD_OPTIONS: -cl-mad-enable may change"));
    }
}

TEST_CASE("RAYA_TUNED: refuses values other than off", "[cli]") {
    const ScratchFolder outputs;
    const Arguments arguments =
        render_into(outputs, scene_file("planes"), {"--size", "8", "--pes", "8", "--lanes", "4"});
    for (const char* value : {"maybe", "on", "OFF", "0"})
        check_refused(outputs, arguments, 2, {std::string("RAYA_TUNED=") + value + ": must be off, or not set"},
                      {.variables = {{"RAYA_TUNED", value}}});
    check_refused(outputs, {"bench", "--size", "8"}, 2, {"RAYA_TUNED=maybe"}, {.variables = {{"RAYA_TUNED", "maybe"}}});
}

TEST_CASE("devices: lists a driver with two ICD entries once, and gives equal devices different numbers", "[cli]") {
    const ScratchFolder vendors;
    const fs::path entry = "/etc/OpenCL/vendors/pocl.icd";
    if (!fs::exists(entry)) return;
    for (const char* name : {"a.icd", "b.icd"}) fs::copy_file(entry, vendors / name);
    const auto devices = [&](const char* pocl_devices) {
        const RunOutcome run =
            run_raya({"devices"}, {.variables = {{"OCL_ICD_VENDORS", vendors.path()}, {"POCL_DEVICES", pocl_devices}}});
        INFO(run.describe());
        CHECK(run.code == 0);
        return std::count(run.out.begin(), run.out.end(), '\n') - 3;  // without the text at the end
    };
    const auto lines_of_one_device = devices("pthread");
    CHECK(devices("pthread basic") == 2 * lines_of_one_device);
    CHECK(devices("pthread pthread") == 2 * lines_of_one_device);
    const ScratchFolder outputs;
    const auto render = [&](const char* device) {
        return run_raya({"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "8", "--pes", "8",
                         "--lanes", "4", "-q", "--device", device},
                        {.variables = {{"OCL_ICD_VENDORS", vendors.path()}, {"POCL_DEVICES", "pthread pthread"}}});
    };
    for (const char* device : {"0", "1", "cpu", "0,1"}) CHECK(render(device).code == 0);
    const RunOutcome refused_run = render("no such device");
    CHECK(refused_run.code == 3);
    CHECK_THAT(refused_run.err, Catch::Contains("\n  1: ") && !Catch::Contains("\n  2: "));
}

TEST_CASE("--device: the error for an unknown device lists the devices", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes");
    const Arguments message = {"no OpenCL device matches 'nosuch'", "remedy: give a number, a type or a part of a name",
                               "\n  0: "};
    check_refused(outputs, render_into(outputs, scene, {"--device", "nosuch"}), 3, message);
    check_refused(outputs, render_into(outputs, scene), 3, message, {.variables = {{"RAYA_DEVICE", "nosuch"}}});
    check_refused(outputs, {"bench", "--device", "nosuch"}, 3, message);
    check_refused(outputs, render_into(outputs, scene, {"--device", "999"}), 3,
                  {"no OpenCL device matches '999'", "\n  0: "});
}

TEST_CASE("render, devices, bench: without OpenCL the error contains the remedy", "[cli]") {
    const ScratchFolder no_drivers, outputs;
    const RunOptions no_opencl{.variables = {{"OCL_ICD_VENDORS", no_drivers.path()}}};
    const Arguments message = {"no OpenCL device found", "apt install pocl-opencl-icd", "OCL_ICD_VENDORS"};
    check_refused(outputs, render_into(outputs, scene_file("planes")), 3, message, no_opencl);
    check_refused(outputs, {"devices"}, 3, message, no_opencl);
    check_refused(outputs, {"bench"}, 3, message, no_opencl);
}

TEST_CASE("render: if the driver crashes, raya exits with 3 and names the failed call", "[cli]") {
    if (kSanitized) return;  // the address sanitizer handles SIGSEGV itself
    const ScratchFolder outputs;
    // After a stack overflow the signal handler needs a separate stack, because the thread's stack is full.
    for (const char* crash : {"crash", "overflow"}) {
        CAPTURE(crash);
        check_refused(outputs,
                      render_into(outputs, scene_file("planes"), {"--size", "8", "--pes", "8", "--lanes", "4"}), 3,
                      {"raya: the OpenCL driver crashed (SIGSEGV) while ", "launching kernel 'trace'",
                       "remedy: ", "POCL_CACHE_DIR"},
                      device_with_fault(std::string("clEnqueueNDRangeKernel 1 ") + crash));
    }
}

TEST_CASE("render --group: the error for a group larger than the kernel allows names both sizes", "[cli]") {
    const ScratchFolder outputs;
    const Arguments arguments =
        render_into(outputs, scene_file("planes"), {"--size", "8", "--pes", "8", "--lanes", "4", "--group", "16"});
    check_refused(outputs, arguments, 3, {"groups of 16 work-items", "allows groups of 1..8", "--group 8"},
                  device_with_fault("clGetKernelWorkGroupInfo 4528 8"));
}

/// Returns the bytes of the image of a render with groups of `group` work-items on the PoCL device `device`.
std::string image_of(const std::string& group, const std::string& device, const Arguments& extra_options) {
    const ScratchFolder outputs;
    Arguments arguments = {"render", scene_file("centre"), "-o", outputs / "x.pfm", "--size", "16", "--lanes", "16"};
    arguments.insert(arguments.end(), {"--group", group});
    arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
    const RunOutcome run = run_raya(arguments, {.variables = {{"POCL_DEVICES", device}}});
    INFO(run.describe());
    CHECK(run.code == 0);
    return run.code == 0 ? file_contents(outputs / "x.pfm") : "";
}

// PoCL keeps the private memory of a whole work-group on the stack of one thread, so large groups may overflow it.
TEST_CASE("render --group: with 16 lanes, groups of 1 and 1024 work-items render the same image", "[cli]") {
    const Arguments grande = {"--machine", "grande"};
    CHECK(image_of("1024", "pthread", grande) == image_of("1", "pthread", grande));
}

TEST_CASE("render --group: groups of 1 and 1024 work-items render the same image with large kernels", "[cli][slow]") {
    for (const char* device : {"pthread", "basic"})
        for (const Arguments& extra_options :
             {Arguments{"--machine", "grande"}, Arguments{"--machine", "torus", "--nodes", "2x1x1"},
              Arguments{"--machine", "grande", "--antialias", "filter"},
              Arguments{"--machine", "grande", "--bounces", "31", "--accel", "grid"},
              Arguments{"--machine", "grande", "--bounces", "31", "--accel", "bvh", "--antialias", "supersample"}}) {
            CAPTURE(device, extra_options);
            CHECK(image_of("1024", device, extra_options) == image_of("1", device, extra_options));
        }
}

TEST_CASE("render: the error for a damaged kernel cache of the driver contains the remedy", "[cli]") {
    if (kSanitized) return;
    const ScratchFolder cache, outputs;
    const RunOptions run_options{.variables = {{"POCL_CACHE_DIR", cache.path()}}};
    const Arguments arguments = {
        "render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "8", "--pes", "8", "--lanes", "4"};
    REQUIRE(run_raya(arguments, run_options).code == 0);
    std::filesystem::remove(outputs / "x.pfm");
    int damaged = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.path()))
        if (entry.path().extension() == ".bc") {
            std::ofstream(entry.path()) << "damaged";
            ++damaged;
        }
    REQUIRE(damaged > 0);
    check_refused(outputs, arguments, 3, {"the OpenCL driver crashed (SIGABRT) while building program", "empty folder"},
                  run_options);
}

TEST_CASE("render: ends if memory runs out during a build, although the driver still holds a lock", "[cli]") {
    if (kSanitized) return;
    const ScratchFolder cache, outputs;
    RunOptions run_options = device_with_fault("new 1000000 0");
    run_options.variables.emplace_back("POCL_CACHE_DIR", cache.path());
    check_refused(outputs, render_into(outputs, scene_file("planes"), {"--size", "8", "--pes", "8"}), 2,
                  {"out of memory on the host"}, run_options);
}

TEST_CASE("render: the error names an unwritable POCL_CACHE_DIR first; raya replaces an unwritable default", "[cli]") {
    const ScratchFolder home, outputs;
    ::chmod(outputs.path().c_str(), 0777);
    ::chmod(home.path().c_str(), 0555);
    const Arguments arguments = {
        "render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "8", "--pes", "8", "--lanes", "4"};
    check_refused(outputs, arguments, 3,
                  {"raya: building program 'ring/trace.cl': PoCL's kernel cache (POCL_CACHE_DIR=" +
                       home.path().string() + "): cannot write '",
                   "is not writable; ", "build log:"},
                  {.variables = {{"POCL_CACHE_DIR", home.path()}}, .as_nobody = true});
    const RunOutcome run = run_raya(
        arguments,
        {.variables = {{"POCL_CACHE_DIR", ""}, {"XDG_CACHE_HOME", ""}, {"HOME", home.path()}}, .as_nobody = true});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.err, Catch::Contains("raya: warning: ") && Catch::Contains("PoCL keeps its kernels in"));
}

/// If the process has the permission, mounts a file system of `bytes` bytes at `folder` for the object's lifetime.
class SmallFileSystem {
  public:
    SmallFileSystem(const fs::path& folder, int bytes)
        : folder_(folder),
          is_mounted_(::mount("none", folder.c_str(), "tmpfs", 0, ("size=" + std::to_string(bytes)).c_str()) == 0) {}
    ~SmallFileSystem() {
        if (is_mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
    }
    SmallFileSystem(const SmallFileSystem&) = delete;
    SmallFileSystem& operator=(const SmallFileSystem&) = delete;
    bool is_mounted() const { return is_mounted_; }

  private:
    fs::path folder_;
    bool is_mounted_;
};

TEST_CASE("render: on a full disk, the error names the kernel cache, whether PoCL or LLVM fails first", "[cli]") {
    if (kSanitized) return;
    for (const int bytes : {4 << 10, 300 << 10}) {
        CAPTURE(bytes);
        const ScratchFolder cache, outputs;
        const SmallFileSystem disk(cache.path(), bytes);
        if (!disk.is_mounted()) return;
        check_refused(outputs,
                      render_into(outputs, scene_file("planes"), {"--size", "8", "--pes", "8", "--lanes", "4"}), 3,
                      {"No space left on device", "free some space", "POCL_CACHE_DIR"},
                      {.variables = {{"POCL_CACHE_DIR", cache.path()}}});
    }
}

}  // namespace
}  // namespace raya
