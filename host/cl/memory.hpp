// Device memory as arrays of T, and host memory for asynchronous transfers.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "host/cl/opencl.hpp"

namespace raya {

/// An array of `size()` elements of T in the device's global memory, allocated by Session::buffer(), initially
/// undefined. A Buffer is a handle: its copies refer to the same memory, which is freed with the last copy.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>, "buffers are copied byte by byte");

  public:
    /// `owner`: released with the last copy, before the memory; may be null.
    Buffer(cl::Buffer memory, std::string name, std::size_t size, std::shared_ptr<const void> owner = {})
        : memory_(std::move(memory)), name_(std::move(name)), size_(size), owner_(std::move(owner)) {}

    const cl::Buffer& memory() const { return memory_; }
    const std::string& name() const { return name_; }
    std::size_t size() const { return size_; }               // elements
    std::size_t bytes() const { return size_ * sizeof(T); }  // cannot overflow: checked by Session::buffer

  private:
    cl::Buffer memory_;
    std::string name_;
    std::size_t size_;
    std::shared_ptr<const void> owner_;
};

/// A kernel argument `__local T*`: `count` elements in local memory for each work-group.
template <class T>
struct LocalMemory {
    std::size_t count = 0;
    std::size_t bytes() const { return count * sizeof(T); }
};

/// Host memory for transfers: plain, or pinned (page-locked) memory allocated by the driver. A device with separate
/// memory copies to and from pinned memory asynchronously at full bus speed. The destructor waits for the last command
/// that uses the memory.
class HostMemory {
  public:
    enum class Kind { kPlain, kPinned };

    /// Allocates `bytes` > 0 bytes. Throws cl::Error.
    HostMemory(const cl::Context& context, const cl::CommandQueue& queue, Kind kind, std::size_t bytes);
    ~HostMemory();
    HostMemory(const HostMemory&) = delete;
    HostMemory& operator=(const HostMemory&) = delete;

    std::byte* bytes() const { return bytes_; }
    std::size_t size() const { return size_; }

    /// Registers a command that uses this memory. The queue must run it after all commands registered before.
    void used_by(const cl::Event& command) { last_command_ = command; }

    /// Waits for the last registered command. Throws cl::Error if that command failed.
    void wait();

  private:
    cl::CommandQueue queue_;
    std::size_t size_;
    std::unique_ptr<std::byte[]> plain_memory_;
    cl::Buffer pinned_buffer_;
    std::byte* bytes_ = nullptr;
    cl::Event last_command_;
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

/// Sizes in bytes of one half of a Staging, in pinned and in plain memory. Plain halves are for devices that share the
/// host's memory, where a thread of the driver copies the bytes of a transfer. For a small transfer, waking that thread
/// and waiting for it takes longer than copying its bytes twice through the staging buffer.
inline constexpr std::size_t kPinnedHalfBytes = 4u << 20, kPlainHalfBytes = 64u << 10;

/// Staging buffer: host memory in two halves through which transfers between host and device go. Consecutive transfers
/// fill one half. While the device copies that half, the host fills or reads the other half.
class Staging {
  public:
    /// Allocates both halves. Throws cl::Error.
    Staging(const cl::Context& context, const cl::CommandQueue& queue, HostMemory::Kind kind, std::size_t half_bytes);

    std::size_t half_bytes() const { return halves_[0].size(); }

    /// Reserved bytes of a half.
    struct Place {
        HostMemory& half;  // register each command that uses `bytes` with half.used_by()
        std::byte* bytes;
    };

    /// Reserves `bytes` bytes, at most half_bytes(). If they do not fit into the current half, switches to the other
    /// half and waits for the commands that use it. Throws cl::Error if such a command failed.
    Place reserve(std::size_t bytes);

  private:
    std::array<HostMemory, 2> halves_;
    std::size_t current_half_ = 0, used_bytes_ = 0;  // of the current half: index, and bytes reserved in it
};

}  // namespace raya
