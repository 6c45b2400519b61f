// Ctrl-C and its kin: the program ends at once, says so, and leaves no half-written file.
#pragma once
#include <filesystem>

namespace raya {

/// Removes all files in progress. May be called by a handler of signals.
void remove_files_in_progress();

/// From now on SIGINT, SIGTERM, SIGHUP and SIGQUIT remove files in progress, print "raya: interrupted" on stderr and
/// end the process by that same signal, which a shell shows as exit code 130, 143, 129 or 131. Signals that are ignored
/// (nohup) stay so. No library replaces the handlers; theirs are called before the process ends.
void end_cleanly_when_interrupted();

/// Until `keep` is false no library replaces what the program has installed for that signal.
void keep_handler(int signal, bool keep = true);

/// From now on an interruption prints nothing: another process reports it, or this one has reported why it ends.
void end_silently();

/// A file that must not outlive the process unless it is finished: known to the handler while this object lives. Does
/// not remove the file itself. A process has few at a time; one beyond the 16th is left to itself.
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
