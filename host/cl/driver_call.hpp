// Drivers that end the program: what they were asked for, said in time.
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

}  // namespace raya
