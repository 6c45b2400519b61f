// Device memory as arrays of T, and host memory for asynchronous transfers.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "host/cl/opencl.hpp"

namespace raya {

/// `size()` elements of T in the device's global memory, allocated by Session::buffer; initially undefined. A handle:
/// copies refer to the same memory, which is freed with the last one.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>, "buffers are copied byte by byte");

  public:
    Buffer(cl::Buffer memory, std::string name, std::size_t size)
        : memory_(std::move(memory)), name_(std::move(name)), size_(size) {}

    const cl::Buffer& memory() const { return memory_; }
    const std::string& name() const { return name_; }
    std::size_t size() const { return size_; }               // elements
    std::size_t bytes() const { return size_ * sizeof(T); }  // cannot overflow: checked by Session::buffer

  private:
    cl::Buffer memory_;
    std::string name_;
    std::size_t size_;
};

/// A kernel argument `__local T*`: `count` elements for each work-group.
template <class T>
struct LocalMemory {
    std::size_t count = 0;
    std::size_t bytes() const { return count * sizeof(T); }
};

/// Plain memory, or pinned memory allocated by the driver, which a device with memory of its own copies to and from
/// asynchronously at full bus speed. The destructor waits for the last command that uses it.
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

    /// Registers a command that uses this memory, later than all commands registered before.
    void used_by(const cl::Event& command) { last_ = command; }

    /// Waits for the last registered command. cl::Error if it failed.
    void wait();

  private:
    cl::CommandQueue queue_;
    std::size_t size_;
    std::unique_ptr<std::byte[]> plain_;
    cl::Buffer pinned_;
    std::byte* bytes_ = nullptr;
    cl::Event last_;
};

/// Host memory for asynchronous reads of up to `size()` elements of T by Session::read().
template <class T>
class Readback {
  public:
    Readback(std::unique_ptr<HostMemory> memory, std::size_t size) : memory_(std::move(memory)), size_(size) {}

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

/// Bytes of one half of a Staging. On a device that shares the host's memory a transfer is a copy by another thread.
/// For a small transfer, waking that thread and waiting for it takes longer than copying twice, hence the small plain
/// half.
inline constexpr std::size_t kPinnedHalf = 4u << 20, kPlainHalf = 64u << 10;

/// Double buffering for transfers. Consecutive transfers fill one half; while the device copies it, the host fills or
/// reads the other.
class Staging {
  public:
    /// Allocates both halves. Throws cl::Error.
    Staging(const cl::Context& context, const cl::CommandQueue& queue, HostMemory::Kind kind, std::size_t half_bytes);

    std::size_t half_bytes() const { return halves_[0].size(); }

    struct Place {
        HostMemory& half;  // register the command with half.used_by()
        std::byte* bytes;
    };

    /// Reserves `bytes` bytes, at most half_bytes(). If that switches to the other half, waits for the commands that
    /// use it. cl::Error if one failed.
    Place take(std::size_t bytes);

  private:
    std::array<HostMemory, 2> halves_;
    std::size_t turn_ = 0, used_ = 0;  // index of the current half; its reserved bytes
};

}  // namespace raya
