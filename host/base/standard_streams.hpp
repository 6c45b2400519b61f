// "-" as a file name: stdin or stdout.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace raya {

/// Returns true for "-", which means stdin for an input file and stdout for an output file. The path of a file that is
/// itself named - is "./-".
bool is_standard_stream(const std::filesystem::path& path);

/// Return the name of a file in messages and reports: "stdin" or "stdout" for "-", else the path.
std::string input_name(const std::filesystem::path& path);
std::string output_name(const std::filesystem::path& path);

/// Returns the descriptor of stdin. Prints a hint if stdin is a terminal. A second call throws UnreadableFile
/// (whole_file.hpp), because the input has been consumed.
int take_stdin();

/// Reserves stdout for a file: from now on everything that this process and its children print to stdout goes to
/// stderr. Further calls do nothing. Throws UserError if no file descriptor is free.
void reserve_stdout();
bool stdout_is_reserved();

/// Undoes reserve_stdout(), because the program executes another one. Async-signal-safe.
void restore_stdout();

/// Reserves stdout if necessary and returns its descriptor, which the caller closes. A second call throws UserError,
/// because the content of two files would be mixed.
int take_stdout();

/// Throws UserError if `path` is "-" and stdout is a terminal, which binary output would garble.
void refuse_bytes_on_terminal(const std::filesystem::path& path);

}  // namespace raya
