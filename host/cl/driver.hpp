// Error reports for drivers that crash or end the program, and the folder of PoCL's kernel cache.
#pragma once
#include <string>

namespace raya {

/// Marks the scope of a driver call; crash messages contain `what`, which must outlive this object. Threads of OpenCL
/// run meanwhile, so a crash in any thread is attributed to the driver or a kernel.
class DriverCall {
  public:
    explicit DriverCall(const char* what);
    ~DriverCall();
    DriverCall(const DriverCall&) = delete;
    DriverCall& operator=(const DriverCall&) = delete;

  private:
    const char* before_;
};

/// From now on, if a driver aborts or crashes in any thread, also by a stack overflow, raya prints the driver call and
/// remedies on stderr, removes files in progress and exits with the code of a DeviceError. Crashes outside of drivers
/// end the program by their signal, and so do all crashes if something else, such as a sanitizer, handles them. Threads
/// created later get stacks for the largest work-groups.
void install_crash_handlers();

/// For one of several processes: sets the prefix of a crash message ("rank 1 on node7: ") and the seconds to wait
/// before printing it. If all processes crash, the first one that prints ends the others.
void set_crash_prefix(const std::string& prefix, double delay_s);

/// From now on crashes end the program by their signal again, so that the parent process sees the signal.
void restore_crash_signals();

/// Sets POCL_CACHE_DIR, unless it is set, to a folder that only this user and root may write: PoCL's default, else one
/// in the folder for temporary files, with a warning. PoCL executes the binaries that it finds there, and offers no
/// device if it cannot write there. Call it before any OpenCL function. DeviceError if there is no such folder.
void set_driver_cache_folder();

/// Returns why PoCL cannot store kernels in that folder, with the remedy; empty if it can. Writes and removes a file
/// there.
std::string driver_cache_problem();

}  // namespace raya
