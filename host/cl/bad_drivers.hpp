// OpenCL drivers that hang or crash while they are asked for their devices: raya starts again without them.
#pragma once
#include <array>
#include <csignal>

namespace raya {

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
