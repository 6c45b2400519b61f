// Transfers of a session: writes, reads, copies and fills of buffers.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "host/cl/commands.hpp"

namespace raya {
namespace {

// Returns the names of both buffers of a copy, for the profile.
std::string copy_name(const std::string& from, const std::string& to) { return from + " -> " + to; }

}  // namespace

void Session::write_bytes(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t offset,
                          std::size_t bytes, const void* from) {
    if (bytes == 0) return;
    if (pinned_ || bytes <= staging_->half_bytes())
        return write_staged(label, to, name, offset, bytes, static_cast<const std::byte*>(from));
    submit(fmt::format("'{}': writing {} bytes into buffer '{}'", label, bytes, name),
           {.label = label, .kind = "write", .bytes = bytes, .target_name = name},
           [&](cl::Event* event) { queue_->enqueueWriteBuffer(to, CL_TRUE, offset, bytes, from, nullptr, event); });
}

void Session::read_bytes(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                         std::size_t bytes, void* to) {
    if (bytes == 0) return;
    if (pinned_) return read_staged(label, from, name, offset, bytes, static_cast<std::byte*>(to));
    submit(fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name),
           {.label = label, .kind = "read", .bytes = bytes, .target_name = name},
           [&](cl::Event* event) { queue_->enqueueReadBuffer(from, CL_TRUE, offset, bytes, to, nullptr, event); });
}

void Session::write_staged(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t offset,
                           std::size_t bytes, const std::byte* from) {
    for (std::size_t done = 0; done < bytes; done += staging_->half_bytes()) {
        const std::size_t part = std::min(bytes - done, staging_->half_bytes());
        const std::string what = fmt::format("'{}': writing {} bytes into buffer '{}'", label, part, name);
        const Staging::Place place = guarded(what, [&] { return staging_->reserve(part); });
        std::memcpy(place.bytes, from + done, part);
        submit(what, {.label = label, .kind = "write", .bytes = part, .target_name = name}, [&](cl::Event* event) {
            queue_->enqueueWriteBuffer(to, CL_FALSE, offset + done, part, place.bytes, nullptr, event);
            place.half.used_by(*event);
        });
    }
}

void Session::read_staged(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                          std::size_t bytes, std::byte* to) {
    std::optional<Staging::Place> previous;  // staging memory of the previous part, which starts at byte `copied`
    std::size_t copied = 0;
    const std::string what = fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name);
    const auto copy_previous = [&](std::size_t part) {
        guarded(what, [&] { previous->half.wait(); });
        std::memcpy(to + copied, previous->bytes, part);
        copied += part;
    };
    for (std::size_t done = 0; done < bytes; done += staging_->half_bytes()) {
        const std::size_t part = std::min(bytes - done, staging_->half_bytes());
        const Staging::Place place = guarded(what, [&] { return staging_->reserve(part); });
        submit(what, {.label = label, .kind = "read", .bytes = part, .target_name = name}, [&](cl::Event* event) {
            queue_->enqueueReadBuffer(from, CL_FALSE, offset + done, part, place.bytes, nullptr, event);
            place.half.used_by(*event);
        });
        guarded(what, [&] { queue_->flush(); });
        if (previous) copy_previous(staging_->half_bytes());
        previous.emplace(place);
    }
    copy_previous(bytes - copied);
}

void Session::read_async(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                         std::size_t bytes, HostMemory& to, std::size_t to_offset) {
    if (bytes == 0) return;
    submit(fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name),
           {.label = label, .kind = "read", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_->enqueueReadBuffer(from, CL_FALSE, offset, bytes, to.bytes() + to_offset, nullptr, event);
               to.used_by(*event);
           });
}

void Session::wait_for(const std::string& label, HostMemory& memory) {
    guarded(fmt::format("'{}': waiting for a read", label), [&] { memory.wait(); });
}

void Session::copy_bytes(const std::string& label, const CopyEnd& from, const CopyEnd& to, std::size_t bytes) {
    if (bytes == 0) return;
    submit(fmt::format("'{}': copying {} bytes of buffer '{}' into buffer '{}'", label, bytes, from.name, to.name),
           {.label = label, .kind = "copy", .bytes = bytes, .target_name = copy_name(from.name, to.name)},
           [&](cl::Event* event) {
               queue_->enqueueCopyBuffer(from.memory, to.memory, from.offset, to.offset, bytes, nullptr, event);
           });
}

void Session::copy_rows(const std::string& label, const CopyEnd& from, std::size_t from_pitch, const CopyEnd& to,
                        std::size_t to_pitch, std::size_t bytes, std::size_t rows) {
    if (bytes == 0 || rows == 0) return;
    submit(fmt::format("'{}': copying {} rows of {} bytes of buffer '{}' into buffer '{}'", label, rows, bytes,
                       from.name, to.name),
           {.label = label, .kind = "copy", .bytes = bytes * rows, .target_name = copy_name(from.name, to.name)},
           [&](cl::Event* event) {
               queue_->enqueueCopyBufferRect(from.memory, to.memory, {from.offset, 0, 0}, {to.offset, 0, 0},
                                             {bytes, rows, 1}, from_pitch, 0, to_pitch, 0, nullptr, event);
           });
}

void Session::fill_bytes(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t bytes,
                         const void* value, std::size_t value_bytes) {
    submit(fmt::format("'{}': filling buffer '{}' of {} bytes", label, name, bytes),
           {.label = label, .kind = "fill", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               cl_event filled = nullptr;
               const cl_int code =
                   clEnqueueFillBuffer((*queue_)(), to(), value, value_bytes, 0, bytes, 0, nullptr, &filled);
               if (code != CL_SUCCESS) throw cl::Error(code, "clEnqueueFillBuffer");
               *event = cl::Event(filled);
           });
}

}  // namespace raya
