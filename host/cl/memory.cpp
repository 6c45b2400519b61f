#include "host/cl/memory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "host/cl/commands.hpp"

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

namespace {

// Returns the names of both buffers of a copy, for the profile.
std::string copy_name(const std::string& source, const std::string& target) { return source + " -> " + target; }

}  // namespace

void Session::write_bytes(const std::string& label, const cl::Buffer& target, const std::string& name,
                          std::size_t offset, std::size_t bytes, const void* source) {
    if (bytes == 0) return;
    if (pinned_ || bytes <= staging_->half_bytes())
        return write_staged(label, target, name, offset, bytes, static_cast<const std::byte*>(source));
    submit(fmt::format("'{}': writing {} bytes into buffer '{}'", label, bytes, name),
           {.label = label, .kind = "write", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_->enqueueWriteBuffer(target, CL_TRUE, offset, bytes, source, nullptr, event);
           });
}

void Session::read_bytes(const std::string& label, const cl::Buffer& source, const std::string& name,
                         std::size_t offset, std::size_t bytes, void* target) {
    if (bytes == 0) return;
    if (pinned_) return read_staged(label, source, name, offset, bytes, static_cast<std::byte*>(target));
    submit(fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name),
           {.label = label, .kind = "read", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_->enqueueReadBuffer(source, CL_TRUE, offset, bytes, target, nullptr, event);
           });
}

void Session::write_staged(const std::string& label, const cl::Buffer& target, const std::string& name,
                           std::size_t offset, std::size_t bytes, const std::byte* source) {
    for (std::size_t done_bytes = 0; done_bytes < bytes; done_bytes += staging_->half_bytes()) {
        const std::size_t part_bytes = std::min(bytes - done_bytes, staging_->half_bytes());
        const std::string operation = fmt::format("'{}': writing {} bytes into buffer '{}'", label, part_bytes, name);
        const Staging::Place place = guarded(operation, [&] { return staging_->reserve(part_bytes); });
        std::memcpy(place.bytes, source + done_bytes, part_bytes);
        submit(operation, {.label = label, .kind = "write", .bytes = part_bytes, .target_name = name},
               [&](cl::Event* event) {
                   queue_->enqueueWriteBuffer(target, CL_FALSE, offset + done_bytes, part_bytes, place.bytes, nullptr,
                                              event);
                   place.half.used_by(*event);
               });
    }
}

void Session::read_staged(const std::string& label, const cl::Buffer& source, const std::string& name,
                          std::size_t offset, std::size_t bytes, std::byte* target) {
    std::optional<Staging::Place> previous;  // staging memory of the previous part
    std::size_t copied_bytes = 0;            // number of bytes copied to `target`
    const std::string operation = fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name);
    const auto copy_previous = [&](std::size_t part_bytes) {
        guarded(operation, [&] { previous->half.wait(); });
        std::memcpy(target + copied_bytes, previous->bytes, part_bytes);
        copied_bytes += part_bytes;
    };
    for (std::size_t done_bytes = 0; done_bytes < bytes; done_bytes += staging_->half_bytes()) {
        const std::size_t part_bytes = std::min(bytes - done_bytes, staging_->half_bytes());
        const Staging::Place place = guarded(operation, [&] { return staging_->reserve(part_bytes); });
        submit(operation, {.label = label, .kind = "read", .bytes = part_bytes, .target_name = name},
               [&](cl::Event* event) {
                   queue_->enqueueReadBuffer(source, CL_FALSE, offset + done_bytes, part_bytes, place.bytes, nullptr,
                                             event);
                   place.half.used_by(*event);
               });
        guarded(operation, [&] { queue_->flush(); });
        if (previous) copy_previous(staging_->half_bytes());
        previous.emplace(place);
    }
    copy_previous(bytes - copied_bytes);
}

void Session::read_async(const std::string& label, const cl::Buffer& source, const std::string& name,
                         std::size_t offset, std::size_t bytes, HostMemory& target, std::size_t target_offset) {
    if (bytes == 0) return;
    submit(fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name),
           {.label = label, .kind = "read", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_->enqueueReadBuffer(source, CL_FALSE, offset, bytes, target.bytes() + target_offset, nullptr,
                                         event);
               target.used_by(*event);
           });
}

void Session::wait_for(const std::string& label, HostMemory& memory) {
    guarded(fmt::format("'{}': waiting for a read", label), [&] { memory.wait(); });
}

void Session::copy_bytes(const std::string& label, const CopyEnd& source, const CopyEnd& target, std::size_t bytes) {
    if (bytes == 0) return;
    submit(
        fmt::format("'{}': copying {} bytes of buffer '{}' into buffer '{}'", label, bytes, source.name, target.name),
        {.label = label, .kind = "copy", .bytes = bytes, .target_name = copy_name(source.name, target.name)},
        [&](cl::Event* event) {
            queue_->enqueueCopyBuffer(source.memory, target.memory, source.offset, target.offset, bytes, nullptr,
                                      event);
        });
}

void Session::copy_rows(const std::string& label, const CopyEnd& source, std::size_t source_pitch,
                        const CopyEnd& target, std::size_t target_pitch, std::size_t bytes, std::size_t rows) {
    if (bytes == 0 || rows == 0) return;
    submit(fmt::format("'{}': copying {} rows of {} bytes of buffer '{}' into buffer '{}'", label, rows, bytes,
                       source.name, target.name),
           {.label = label, .kind = "copy", .bytes = bytes * rows, .target_name = copy_name(source.name, target.name)},
           [&](cl::Event* event) {
               queue_->enqueueCopyBufferRect(source.memory, target.memory, {source.offset, 0, 0}, {target.offset, 0, 0},
                                             {bytes, rows, 1}, source_pitch, 0, target_pitch, 0, nullptr, event);
           });
}

void Session::fill_bytes(const std::string& label, const cl::Buffer& target, const std::string& name, std::size_t bytes,
                         const void* value, std::size_t value_bytes) {
    submit(fmt::format("'{}': filling buffer '{}' of {} bytes", label, name, bytes),
           {.label = label, .kind = "fill", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               cl_event filled = nullptr;
               const cl_int code =
                   clEnqueueFillBuffer((*queue_)(), target(), value, value_bytes, 0, bytes, 0, nullptr, &filled);
               if (code != CL_SUCCESS) throw cl::Error(code, "clEnqueueFillBuffer");
               *event = cl::Event(filled);
           });
}

}  // namespace raya
