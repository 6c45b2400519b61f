// Device memory as arrays of T; memory of the host's that the device copies to and from while the host does something
// else.
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

/// `size()` elements of T in the device's global memory. Made by Session::buffer; what it holds at first is undefined.
/// A handle: copies of it name the same memory, which lives as long as one of them.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>, "buffers are copied byte by byte");

  public:
    Buffer(cl::Buffer memory, std::string name, std::size_t size)
        : memory_(std::move(memory)), name_(std::move(name)), size_(size) {}

    const cl::Buffer& memory() const { return memory_; }
    const std::string& name() const { return name_; }
    std::size_t size() const { return size_; }               // elements
    std::size_t bytes() const { return size_ * sizeof(T); }  // cannot overflow: Session::buffer has checked it

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
