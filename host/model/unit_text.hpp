// Sizes, times and rates as people read them: in the unit that fits.
#pragma once
#include <cstdint>
#include <string>

namespace raya {

/// "1 frame", "2 frames"; `many` where an s does not make the plural.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many = "");

/// Below 1 KB in bytes, else in KB with a decimal where they are no whole ones: what is needed rounded up, what there
/// is rounded down, so that what does not fit never reads as if it did.
std::string needed_text(std::uint64_t bytes);
std::string present_text(std::uint64_t bytes);

/// An amount of data that is not held against a limit: "12 bytes", from 10,000 on "12.3 KB", from a million "12.3 MB".
std::string data_text(double bytes);

/// "12.3 ms", from ten seconds on "12.3 s", from ten minutes on "12.3 min", from ten hours on "12.3 h".
std::string time_text(double ms);

/// Rays per second: "12.3 Mrays/s", "12.3 krays/s", "12.3 rays/s".
std::string rate_text(double rays_per_s);

}  // namespace raya
