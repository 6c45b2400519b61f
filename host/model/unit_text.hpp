// Texts of counts, sizes, times and rates, for messages and reports.
#pragma once
#include <cstdint>
#include <string>

namespace raya {

/// Returns a count with its noun: "1 frame", "2 frames". The default plural is `singular` with an s.
std::string counted(std::uint64_t count, const std::string& singular, const std::string& plural = "");

/// Return a size: below 1 KB (1024 bytes) in bytes, else in KB with one decimal, or without a decimal for an available
/// size of whole KB. A required size is rounded up and an available size is rounded down, so that the texts never
/// suggest that data fits if it does not.
std::string required_size_text(std::uint64_t bytes);
std::string available_size_text(std::uint64_t bytes);

/// Returns an amount of data that is not compared with a limit: "12 bytes", from 10,000 bytes on "12.3 KB", from a
/// million bytes on "12.3 MB".
std::string data_text(double bytes);

/// Returns a time: "12.3 ms", from ten seconds on "12.3 s", from ten minutes on "12.3 min", from ten hours on "12.3 h".
std::string time_text(double ms);

/// Returns a rate: "12.3 Mrays/s", "12.3 krays/s" or "12.3 rays/s".
std::string rate_text(double rays_per_s);

}  // namespace raya
