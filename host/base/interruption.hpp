// Interruption by a signal (Ctrl-C): the program ends at once, prints a message and leaves no half-written file.
#pragma once
#include <filesystem>

namespace raya {

/// Removes all files in progress. Async-signal-safe.
void remove_files_in_progress();

/// From now on SIGINT, SIGTERM, SIGHUP and SIGQUIT remove the files in progress, print "raya: interrupted" on stderr
/// and end the process by the same signal, which a shell reports as exit code 130, 143, 129 or 131. Ignored signals
/// (nohup) stay ignored. Libraries cannot replace the handlers; a handler that a library tried to install is called
/// before the process ends.
void install_interrupt_handlers();

/// Prevents libraries from replacing the installed handler of `signal`, or allows it again (`on` = false).
void protect_handler(int signal, bool on = true);

/// From now on an interruption prints nothing, because another process reports it or this one already reported why it
/// ends.
void suppress_interrupt_message();

/// Registers an unfinished file, which the signal handler removes while this object exists. The destructor does not
/// remove the file. A process has at most 16 of them at a time; further ones are not registered.
class FileInProgress {
  public:
    explicit FileInProgress(const std::filesystem::path& path);
    FileInProgress(const FileInProgress&) = delete;
    FileInProgress& operator=(const FileInProgress&) = delete;
    ~FileInProgress();

  private:
    char* name_ = nullptr;  // its slot
};

}  // namespace raya
