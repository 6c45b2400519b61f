// Messages about drivers that crash, hang or end the program, and the folder of PoCL's kernel cache.
#pragma once
#include <string>
#include <thread>

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
/// thread's stack) or calls exit() in any thread, raya prints the operation and remedies on stderr, deletes the file in
/// progress and exits with the code of a DeviceError. A crash outside of drivers ends the program by its signal. A
/// signal that has another handler, such as a sanitizer's, keeps that handler. If `is_worker` is true, installs no
/// handlers, so that the parent process sees the signal. Threads created later with default attributes get stacks that
/// suffice for the largest work-groups.
void install_crash_handlers(bool is_worker);

/// For a rank of an MPI job: sets the prefix of its crash messages ("rank 1 on node7: ") and the time in seconds that
/// the rank waits before it prints such a message. The first rank that prints ends the other ranks. So if all ranks
/// crash and their delays differ, only one rank prints.
void set_crash_prefix(const std::string& prefix, double delay_s);

/// Sets POCL_CACHE_DIR, unless it is set, to a folder that only this user and root may write: PoCL's default folder if
/// it is safe, else, with a warning, raya-pocl-cache-UID in the folder for temporary files. The choice matters because
/// PoCL executes the binaries in it, and offers no device if it cannot write to the folder. Call this before any OpenCL
/// function. Throws DeviceError if neither is safe.
void set_driver_cache_folder();

/// Checks if PoCL can store kernels in the folder POCL_CACHE_DIR, by writing and deleting a file in it. Returns the
/// reason and the remedy if it cannot, else an empty string.
std::string driver_cache_problem();

/// Marks a search for devices while this object exists. If it takes more than 10 s, because a driver may hang, prints a
/// warning with the remedy.
class DeviceSearch {
  public:
    DeviceSearch();
    ~DeviceSearch();
    DeviceSearch(const DeviceSearch&) = delete;
    DeviceSearch& operator=(const DeviceSearch&) = delete;

  private:
    std::jthread warning_;
};

}  // namespace raya
