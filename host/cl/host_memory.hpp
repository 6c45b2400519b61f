// Memory of the host's that the device copies to and from while the host does something else.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "host/cl/opencl.hpp"

namespace raya {

/// Plain memory, or pinned memory of the driver's, to and from which a device with memory of its own copies at its
/// bus's full speed and without making the host wait. It goes no sooner than the last command that uses it has ended.
class HostMemory {
  public:
    enum class Kind { kPlain, kPinned };

    /// `bytes` > 0. cl::Error.
    HostMemory(const cl::Context& context, const cl::CommandQueue& queue, Kind kind, std::size_t bytes);
    ~HostMemory();
    HostMemory(const HostMemory&) = delete;
    HostMemory& operator=(const HostMemory&) = delete;

    std::byte* bytes() const { return bytes_; }
    std::size_t size() const { return size_; }

    /// The command uses it, later than all others so far.
    void used_by(const cl::Event& command) { last_ = command; }

    /// Waits for the last command that uses it. cl::Error where that has failed.
    void wait();

  private:
    cl::CommandQueue queue_;
    std::size_t size_;
    std::unique_ptr<std::byte[]> plain_;
    cl::Buffer pinned_;
    std::byte* bytes_ = nullptr;
    cl::Event last_;
};

/// Where Session::read() lets `size()` elements of T land while the host goes on.
template <class T>
class Landing {
  public:
    Landing(std::unique_ptr<HostMemory> memory, std::size_t size) : memory_(std::move(memory)), size_(size) {}

    std::size_t size() const { return size_; }
    HostMemory& memory() const { return *memory_; }

    /// The first `count` elements, valid after Session::wait().
    std::span<const T> first(std::size_t count) const {
        return std::span(reinterpret_cast<const T*>(memory_->bytes()), size_).first(count);
    }

  private:
    std::unique_ptr<HostMemory> memory_;
    std::size_t size_;
};

}  // namespace raya
