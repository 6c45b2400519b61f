#include "host/cl/memory.hpp"

#include <algorithm>

namespace raya {
namespace {

constexpr std::size_t kAlignment = 64;  // bytes; drivers copy fastest from the start of a cache line

}  // namespace

HostMemory::HostMemory(const cl::Context& context, const cl::CommandQueue& queue, Kind kind, std::size_t bytes)
    : queue_(queue), size_(bytes) {
    if (kind == Kind::kPlain) {
        // The memory is not cleared, so that the system allocates only pages that are used.
        plain_memory_.reset(new std::byte[bytes]);
        bytes_ = plain_memory_.get();
        return;
    }
    pinned_buffer_ = cl::Buffer(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    bytes_ =
        static_cast<std::byte*>(queue_.enqueueMapBuffer(pinned_buffer_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes));
}

// Calls the C functions because, unlike the C++ bindings, they do not throw.
HostMemory::~HostMemory() {
    if (last_command_() != nullptr) clWaitForEvents(1, &last_command_());
    if (plain_memory_ || bytes_ == nullptr) return;
    clEnqueueUnmapMemObject(queue_(), pinned_buffer_(), bytes_, 0, nullptr, nullptr);
    clFinish(queue_());
}

void HostMemory::wait() {
    if (last_command_() != nullptr) std::exchange(last_command_, {}).wait();
}

Staging::Staging(const cl::Context& context, const cl::CommandQueue& queue, HostMemory::Kind kind,
                 std::size_t half_bytes)
    : halves_{{{context, queue, kind, half_bytes}, {context, queue, kind, half_bytes}}} {}

Staging::Place Staging::reserve(std::size_t bytes) {
    if (bytes > half_bytes() - used_bytes_) {
        current_half_ = (current_half_ + 1) % halves_.size();
        halves_[current_half_].wait();
        used_bytes_ = 0;
    }
    HostMemory& half = halves_[current_half_];
    const Place place{half, half.bytes() + used_bytes_};
    used_bytes_ = std::min(half_bytes(), (used_bytes_ + bytes + kAlignment - 1) / kAlignment * kAlignment);
    return place;
}

}  // namespace raya
