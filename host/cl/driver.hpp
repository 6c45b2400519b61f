// Error reports for drivers that crash or end the program, and the folder of PoCL's kernel cache.
#pragma once
#include <array>
#include <csignal>
#include <string>

namespace raya {

/// Marks a driver call as in progress while this object exists. If any thread crashes during that time, raya attributes
/// the crash to the driver or a kernel and prints `operation`, a text that must outlive this object.
class DriverCall {
  public:
    explicit DriverCall(const char* operation);
    ~DriverCall();
    DriverCall(const DriverCall&) = delete;
    DriverCall& operator=(const DriverCall&) = delete;

  private:
    const char* outer_operation_;  // of the enclosing DriverCall; null: none
};

/// Installs handlers of crash signals and of exit(). If a driver then aborts, crashes (also by an overflow of the first
/// thread's stack) or calls exit() in any thread, raya prints the operation and remedies on stderr, deletes files in
/// progress and exits with the code of a DeviceError. A crash outside of drivers ends the program by its signal. A
/// signal that has another handler, such as a sanitizer's, keeps that handler. Threads created later with default
/// attributes get stacks that suffice for the largest work-groups.
void install_crash_handlers();

/// For a rank of an MPI job: sets the prefix of its crash messages ("rank 1 on node7: ") and the time in seconds that
/// the rank waits before it prints such a message. The first rank that prints ends the other ranks. So if all ranks
/// crash and their delays differ, only one rank prints.
void set_crash_prefix(const std::string& prefix, double delay_s);

/// Removes the crash handlers, so that crashes end the program by their signal and the parent process sees the signal.
void remove_crash_handlers();

/// Sets POCL_CACHE_DIR, unless it is set, to a folder that only this user and root may write: PoCL's default folder if
/// it is safe, else, with a warning, a folder in the folder for temporary files. The choice matters because PoCL
/// executes the binaries in it, and offers no device if it cannot write to the folder. Call this before any OpenCL
/// function. Throws DeviceError if there is no safe folder.
void set_driver_cache_folder();

/// Checks if PoCL can store kernels in the folder POCL_CACHE_DIR, by writing and deleting a file in it. Returns the
/// reason and the remedy if it cannot, else an empty string.
std::string driver_cache_problem();

// OpenCL drivers that hang or crash while they are asked for their devices: raya starts again without them.

/// The signals with which a crash ends a program.
inline constexpr std::array<int, 5> kCrashSignals = {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE};

/// Task of a worker (child_process.hpp) that looks for devices, and ends by a signal or not at all if a driver is bad.
inline constexpr const char* kDiscoveryTask = "discovery";

/// Call at the start of main(). From then on, a Discovery in which a driver hangs or crashes executes this program
/// anew, with the same arguments. `kept`: a descriptor that stays open, or -1. In the program so executed, asks each
/// driver in a process of its own, sets OCL_ICD_VENDORS to the drivers that answer, and names the others in a warning.
void restart_without_bad_drivers(char** argv, int kept);

/// Marks a search for devices while this object exists. Does nothing unless restart_without_bad_drivers() was called.
class Discovery {
  public:
    Discovery();
    ~Discovery();
    Discovery(const Discovery&) = delete;
    Discovery& operator=(const Discovery&) = delete;
};

/// If this thread is in a Discovery, executes the program anew. Async-signal-safe.
void restart_after_crash();

}  // namespace raya
