// Ctrl-C and its kin: the program ends at once, says so, and leaves no half-written file.
#pragma once
#include <filesystem>

namespace raya {

/// Removes all files in progress. May be called by a handler of signals.
void remove_files_in_progress();

/// From now on SIGINT, SIGTERM and SIGHUP remove files in progress, print "raya: interrupted" on stderr and end the
/// process by that same signal, which a shell shows as exit code 130, 143 or 129. Signals that are ignored (nohup) stay
/// so.
void end_cleanly_when_interrupted();

/// From now on that signal ends the process without a word: of several processes that get it one speaks, or who sent it.
void end_silently_on(int signal);

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
