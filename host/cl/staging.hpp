// Memory through which transfers go, so that the host need not wait until the device has done with its own.
#pragma once
#include <array>
#include <cstddef>

#include "host/cl/host_memory.hpp"

namespace raya {

/// Bytes of half a staging. Where the device's memory is the host's a transfer is a copy that the host waits for, by
/// threads that wake each other: a small one takes longer to wait for than to copy twice.
inline constexpr std::size_t kPinnedHalf = 4u << 20, kPlainHalf = 64u << 10;

/// Two halves that are used in turn, each for as many transfers as fit into it one after another: while the device
/// copies those of one, the host fills or empties the other.
class Staging {
  public:
    /// Takes the memory. cl::Error.
    Staging(const cl::Context& context, const cl::CommandQueue& queue, HostMemory::Kind kind, std::size_t half_bytes);

    std::size_t half_bytes() const { return halves_[0].size(); }

    struct Place {
        HostMemory& half;  // is told of the command that uses the place
        std::byte* bytes;
    };

    /// Room for a transfer of so many bytes, half_bytes() at most; where it lies in another half than the one before,
    /// once the commands that used that one have ended. cl::Error where one has failed.
    Place take(std::size_t bytes);

  private:
    std::array<HostMemory, 2> halves_;
    std::size_t turn_ = 0, used_ = 0;  // bytes of the half whose turn it is
};

}  // namespace raya
