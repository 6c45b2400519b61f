// Another program, run to its end.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raya {

/// "signal 11 (SIGSEGV)" or "exit code 1", of a status as waitpid() gives it.
std::string ending_text(int status);

/// What became of it.
struct ProgramRun {
    int not_started = 0;  // errno of what kept it from starting, ENOENT for a program that there is not; 0: it ran
    int status = 0;       // as waitpid() gives it
    std::string out, err;

    bool succeeded() const { return not_started == 0 && status == 0; }
};

/// Runs `arguments`, the program first, found by PATH where it names no folder; `input` is what it reads. No shell sees
/// them. Waits for its end. std::system_error where there is no room for what goes in and out.
ProgramRun run_program(const std::vector<std::string>& arguments, const std::string& input = {});

/// The last line that says something, without what ends it, 300 characters at most; empty where none does.
std::string last_line(const std::string& text);

/// A program of that name in the folder of the program that runs, where there is one.
std::optional<std::filesystem::path> program_beside_this(const std::string& name);

}  // namespace raya
