// Device memory as an array of T, counted in elements.
#pragma once
#include <cstddef>
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

}  // namespace raya
