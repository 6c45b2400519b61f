#include "host/cl/staging.hpp"

#include <algorithm>

namespace raya {
namespace {

constexpr std::size_t kAlignment = 64;  // bytes; a cache line, and what drivers copy fastest from

}  // namespace

Staging::Staging(const cl::Context& context, const cl::CommandQueue& queue, HostMemory::Kind kind,
                 std::size_t half_bytes)
    : halves_{{{context, queue, kind, half_bytes}, {context, queue, kind, half_bytes}}} {}

Staging::Place Staging::take(std::size_t bytes) {
    if (bytes > half_bytes() - used_) {
        turn_ = (turn_ + 1) % halves_.size();
        halves_[turn_].wait();
        used_ = 0;
    }
    HostMemory& half = halves_[turn_];
    const Place place{half, half.bytes() + used_};
    used_ = std::min(half_bytes(), (used_ + bytes + kAlignment - 1) / kAlignment * kAlignment);
    return place;
}

}  // namespace raya
