#include "host/cl/staging.hpp"

#include <utility>

namespace raya {

Staging::Staging(const cl::Context& context, const cl::CommandQueue& queue) : queue_(queue) {
    for (Half& half : halves_) {
        half.buffer = cl::Buffer(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, kHalfBytes);
        half.memory = static_cast<std::byte*>(
            queue_.enqueueMapBuffer(half.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, kHalfBytes));
    }
}

Staging::~Staging() {
    for (const Half& half : halves_)  // by the calls that do not throw
        if (half.memory != nullptr) clEnqueueUnmapMemObject(queue_(), half.buffer(), half.memory, 0, nullptr, nullptr);
    clFinish(queue_());
}

void Staging::Half::wait() {
    if (last() != nullptr) std::exchange(last, {}).wait();
}

Staging::Half& Staging::next() {
    Half& half = halves_[turn_++ % halves_.size()];
    half.wait();
    return half;
}

}  // namespace raya
