// Human-readable sizes, times and rates.
#pragma once
#include <cstdint>
#include <string>

namespace raya {

/// A count with its noun: "1 frame", "2 frames". `many`: the plural; empty: `one` with an s.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many = "");

/// A size: below 1 KB (1024 bytes) in bytes, else in KB with one decimal (none for an available size of whole KB). A
/// required size is rounded up and an available size is rounded down, so that the texts never suggest that data fits
/// when it does not.
std::string required_size_text(std::uint64_t bytes);
std::string available_size_text(std::uint64_t bytes);

/// An amount of data that is not compared with a limit: "12 bytes", from 10,000 bytes on "12.3 KB", from a million
/// bytes on "12.3 MB".
std::string data_text(double bytes);

/// A time: "12.3 ms", from ten seconds on "12.3 s", from ten minutes on "12.3 min", from ten hours on "12.3 h".
std::string time_text(double ms);

/// A rate: "12.3 Mrays/s", "12.3 krays/s" or "12.3 rays/s".
std::string rate_text(double rays_per_s);

}  // namespace raya
