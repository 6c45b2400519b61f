// Interruption by a signal (Ctrl-C): the program prints a message, deletes unfinished files and ends at once.
#pragma once
#include <filesystem>

namespace raya {

/// Deletes all files that are registered by FileInProgress. Async-signal-safe.
void remove_files_in_progress();

/// Installs handlers of SIGINT, SIGTERM, SIGHUP and SIGQUIT. They delete the files in progress, print
/// "raya: interrupted" on stderr and end the process by the same signal, which a shell reports as exit code 130, 143,
/// 129 or 131. Ignored signals (nohup) stay ignored. Libraries cannot replace these handlers. If a library has tried
/// to install its own handler, the library's handler is called before the process ends.
void install_interrupt_handlers();

/// Prevents libraries from replacing the installed handler of `signal`; unprotect_handler() allows it again.
void protect_handler(int signal);
void unprotect_handler(int signal);

/// Suppresses the message of later interruptions. Call it if another process prints the message, or if this process has
/// already printed why it ends.
void suppress_interrupt_message();

/// Registers an unfinished file: while this object exists, an interruption deletes the file. The destructor does not
/// delete the file. At most 16 files are registered at a time; the constructor ignores further files, and paths of
/// PATH_MAX bytes or more.
class FileInProgress {
  public:
    explicit FileInProgress(const std::filesystem::path& path);
    FileInProgress(const FileInProgress&) = delete;
    FileInProgress& operator=(const FileInProgress&) = delete;
    ~FileInProgress();

  private:
    char* path_ = nullptr;  // in the table of registered files; null: not registered
};

}  // namespace raya
