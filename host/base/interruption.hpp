// Signals: an interruption (Ctrl-C) prints a message, deletes an unfinished file and ends the program at once.
#pragma once
#include <filesystem>

namespace raya {

/// Installs the handler of a signal, unless it is ignored (nohup) or has a handler. From then on, libraries cannot
/// change the signal's handler.
void handle_signal(int signal, void (*handler)(int));

/// Installs handlers of SIGINT, SIGTERM, SIGHUP and SIGQUIT. They delete the file in progress, print
/// "raya: interrupted" on stderr and end the process by the same signal, which a shell reports as exit code 130, 143,
/// 129 or 131.
void install_interrupt_handlers();

/// Suppresses the message of later interruptions. Call it if another process prints the message, or if this process has
/// already printed why it ends.
void suppress_interrupt_message();

/// Deletes the file that is registered by FileInProgress. Async-signal-safe.
void remove_file_in_progress();

/// Registers an unfinished file: while this object exists, an interruption deletes the file. The destructor does not
/// delete the file. The program writes one file after another; the constructor ignores a second file at a time, and a
/// path of PATH_MAX bytes or more.
class FileInProgress {
  public:
    explicit FileInProgress(const std::filesystem::path& path);
    FileInProgress(const FileInProgress&) = delete;
    FileInProgress& operator=(const FileInProgress&) = delete;
    ~FileInProgress();

  private:
    bool is_registered_ = false;
};

}  // namespace raya
