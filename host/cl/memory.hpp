// Device memory as arrays of T, and host memory for asynchronous transfers.
#pragma once
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
    std::size_t local_bytes() const { return count * sizeof(T); }
};

/// Host memory for asynchronous reads of up to `size()` elements of T by Session::read(). The destructor waits for the
/// last read.
template <class T>
class Readback {
  public:
    explicit Readback(std::size_t size) : elements_(std::make_unique_for_overwrite<T[]>(size)), size_(size) {}
    Readback(Readback&&) noexcept = default;
    Readback& operator=(Readback&&) = delete;
    ~Readback() {
        if (last_read_() != nullptr) clWaitForEvents(1, &last_read_());
    }

    std::size_t size() const { return size_; }
    T* data() { return elements_.get(); }
    cl::Event& last_read() { return last_read_; }

    /// The first `count` elements, valid after Session::wait().
    std::span<const T> first(std::size_t count) const { return std::span(elements_.get(), size_).first(count); }

  private:
    std::unique_ptr<T[]> elements_;
    std::size_t size_;
    cl::Event last_read_;
};

}  // namespace raya
