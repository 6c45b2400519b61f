// What drivers need from outside: a word on what they were asked for where they end the program, and a folder where
// PoCL keeps the kernels that it has built.
#pragma once
#include <string>

namespace raya {

/// While it lives, `what` (which outlives it) is what the driver is doing. OpenCL's own threads work meanwhile, so a
/// crash in any thread is the driver's, or a kernel's.
class DriverCall {
  public:
    explicit DriverCall(const char* what);
    ~DriverCall();
    DriverCall(const DriverCall&) = delete;
    DriverCall& operator=(const DriverCall&) = delete;

  private:
    const char* before_;
};

/// From now on a driver that aborts or crashes, in any thread and by an overflow of its stack too, is named on stderr
/// with what it was doing and with remedies, files in progress are removed, and the exit code is that of a DeviceError.
/// Crashes elsewhere end the program by their signal; so do all where something else, such as a sanitizer, handles
/// them. Threads that are created later get stacks for the largest work-groups.
void explain_driver_crashes();

/// Of several processes: what stands before a crash's message ("rank 1 on node7: "), and how many seconds this process
/// waits before it says it, in case all crash alike and one that speaks ends the others.
void name_process_in_crashes(const std::string& name, double turn_s);

/// Crashes end the program by their signal again: for a process whose parent wants to see it.
void leave_driver_crashes();

/// Names in POCL_CACHE_DIR, unless it is set, a folder for PoCL's kernels that no other user but root may write: the
/// one that PoCL would take, else one below the folder for temporary files, with a warning. PoCL runs what it finds
/// there, and has no device where it cannot write it. To be called before OpenCL is.
void provide_driver_cache();

/// Why PoCL cannot keep kernels in that folder, and the remedy; empty where it can. Writes a file there for a moment.
std::string driver_cache_trouble();

}  // namespace raya
