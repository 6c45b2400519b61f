// A session: creates buffers and programs for one device and enqueues its commands. Every command has a label and is
// profiled.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cl/device.hpp"
#include "host/cl/error_names.hpp"
#include "host/cl/memory.hpp"
#include "host/cl/opencl.hpp"
#include "host/cl/profile.hpp"
#include "host/cl/program.hpp"

namespace raya {

/// kOn: the device records the times of commands, if it supports profiling. kOff: it records no times.
enum class Timing { kOn, kOff };

/// A context and an in-order queue: commands run one after another, in the order in which they were enqueued.
///
/// All offsets and counts are in elements. A range beyond a buffer's end throws std::out_of_range. A launch without
/// work-items or a buffer without elements throws std::invalid_argument. Both exceptions mean an error in the host
/// program. If a call of the driver fails, a DeviceError is thrown; its message contains the call, the label, the
/// buffers or the kernel, the error's name and a remedy. A transfer of no elements does nothing and is not recorded.
class Session {
  public:
    explicit Session(const cl::Device& device, Timing timing = Timing::kOn);
    Session(Session&&) = default;  // not copyable: a copy would report the same commands twice
    /// Waits for all commands, also during stack unwinding.
    ~Session();

    const DeviceInfo& device() const { return info_; }

    /// Returns the total size in bytes of all buffers allocated so far, including buffers that were freed.
    std::uint64_t bytes_taken() const { return bytes_taken_; }

    /// Allocates `count` > 0 elements; `name` is for messages. Throws DeviceError if the buffer would exceed the
    /// device's maximum buffer size, or if the allocation fails.
    template <class T>
    Buffer<T> buffer(const std::string& name, std::size_t count) const {
        return Buffer<T>(allocate(name, count, sizeof(T), nullptr), name, count);
    }

    /// Allocates a buffer for the elements of `host`, which must outlive the buffer and stay unchanged. The caller must
    /// still write() them. If they are large and the device uses the host's memory, the buffer is `host` itself, so
    /// that a large scene is stored only once. The last copy of the buffer waits for all commands when it is destroyed.
    template <class T>
    Buffer<T> buffer_of(const std::string& name, std::span<const T> host) const {
        return Buffer<T>(allocate(name, host.size(), sizeof(T), host.data()), name, host.size(),
                         std::shared_ptr<void>(nullptr, [queue = queue_](void*) { clFinish(queue()); }));
    }

    /// Builds a program, see Program. All sessions of a device share their programs: each combination of source and
    /// options is built once per process.
    Program build(const std::string& name, const std::string& source, const std::vector<std::string>& options) const;

    /// Returns a reference to the maximum amount of work of a launch with this label, in units that the kernel defines;
    /// LaunchLoop (host/array/render.hpp) lowers the maximum. UINT32_MAX, which means no limit, unless the device
    /// may end loops early.
    std::uint32_t& launch_limit(const std::string& label) {
        constexpr std::uint32_t kCautiousLimit = 2048;  // a test takes some 25 iterations, of 65,535
        return launch_limits_.try_emplace(label, info_.ends_loops_early ? kCautiousLimit : UINT32_MAX).first->second;
    }

    /// Runs `groups` work-groups of `group_size` work-items each (one dimension). Does not wait.
    template <class... Params>
    void launch(const std::string& label, Kernel<Params...>& kernel, std::size_t groups, std::size_t group_size,
                std::type_identity_t<Params>... args) {
        kernel.set_arguments(args...);
        const std::size_t local_bytes = (local_bytes_of(args) + ... + 0);
        launch_kernel({.label = label,
                       .kind = "kernel",
                       .target_name = kernel.name(),
                       .groups = groups,
                       .group_size = group_size},
                      kernel.handle(), local_bytes);
    }

    /// Host to device: writes `source` into `target` from element `offset` on. The caller may change `source`
    /// afterwards, because the call either waits or copies the elements.
    template <class T>
    void write(const std::string& label, Buffer<T>& target, std::span<const std::type_identity_t<T>> source,
               std::size_t offset = 0) {
        check_range(label, target.name(), target.size(), offset, source.size());
        write_bytes(label, target.memory(), target.name(), offset * sizeof(T), source.size_bytes(), source.data());
    }

    /// Device to host: reads `target.size()` elements of `source` from element `offset` on. Waits.
    template <class T>
    void read(const std::string& label, const Buffer<T>& source, std::span<std::type_identity_t<T>> target,
              std::size_t offset = 0) {
        check_range(label, source.name(), source.size(), offset, target.size());
        read_bytes(label, source.memory(), source.name(), offset * sizeof(T), target.size_bytes(), target.data(),
                   nullptr);
    }

    /// Device to host: reads `count` elements of `source`, starting at element `offset`, into `target`, starting at
    /// element `target_offset`. Does not wait; the elements are valid after wait(). Reads complete in the order of the
    /// calls.
    template <class T>
    void read(const std::string& label, const Buffer<T>& source, std::size_t offset, Readback<T>& target,
              std::size_t target_offset, std::size_t count) {
        check_range(label, source.name(), source.size(), offset, count);
        check_range(label, "readback of " + source.name(), target.size(), target_offset, count);
        read_bytes(label, source.memory(), source.name(), offset * sizeof(T), count * sizeof(T),
                   target.data() + target_offset, &target.last_read());
    }

    /// Waits for all reads into `readback`. Throws DeviceError, with the label, if a read failed.
    template <class T>
    void wait(const std::string& label, Readback<T>& readback) {
        if (readback.last_read()() == nullptr) return;
        guarded(fmt::format("'{}': waiting for a read", label),
                [&] { std::exchange(readback.last_read(), {}).wait(); });
    }

    /// Device to device: copies `count` elements. Within one buffer the two ranges must not overlap. Does not wait.
    template <class T>
    void copy(const std::string& label, const Buffer<T>& source, std::size_t source_offset, Buffer<T>& target,
              std::size_t target_offset, std::size_t count) {
        check_range(label, source.name(), source.size(), source_offset, count);
        check_range(label, target.name(), target.size(), target_offset, count);
        copy_rows(label, {source.memory(), source.name(), source_offset * sizeof(T)}, 0,
                  {target.memory(), target.name(), target_offset * sizeof(T)}, 0, count * sizeof(T), 1);
    }

    /// Equidistant blocks of a buffer: block i starts at element `first` + i * `pitch`. The range to copy starts at
    /// element `offset` of each block.
    struct Blocks {
        std::size_t offset = 0, pitch = 0, first = 0;
    };

    /// Device to device, between different buffers: copies `count` elements of each of `blocks` blocks. Does not wait.
    template <class T>
    void copy_blocks(const std::string& label, const Buffer<T>& source, Blocks source_blocks, Buffer<T>& target,
                     Blocks target_blocks, std::size_t count, std::size_t blocks) {
        check_blocks(label, source.name(), source.size(), source_blocks, count, blocks);
        check_blocks(label, target.name(), target.size(), target_blocks, count, blocks);
        copy_rows(label, {source.memory(), source.name(), (source_blocks.first + source_blocks.offset) * sizeof(T)},
                  source_blocks.pitch * sizeof(T),
                  {target.memory(), target.name(), (target_blocks.first + target_blocks.offset) * sizeof(T)},
                  target_blocks.pitch * sizeof(T), count * sizeof(T), blocks);
    }

    /// Sets every element of `target` to `value`. Does not wait.
    template <class T>
    void fill(const std::string& label, Buffer<T>& target, const std::type_identity_t<T>& value) {
        static_assert(sizeof(T) <= 128 && (sizeof(T) & (sizeof(T) - 1)) == 0,
                      "OpenCL fills with 1, 2, 4, ... 128 bytes");
        submit(fmt::format("'{}': filling buffer '{}' of {} bytes", label, target.name(), target.bytes()),
               {.label = label, .kind = "fill", .bytes = target.bytes(), .target_name = target.name()},
               [&](cl::Event* event) {
                   queue_.enqueueFillBuffer(target.memory(), value, 0, target.bytes(), nullptr, event);
               });
    }

    /// For traces: from now on, span() and build() add entries to `spans`, which must outlive the session.
    void observe(SpanLog& spans) { spans_ = &spans; }

    /// From now on, `observer`, which must outlive the session or ignore(), observes builds and launches.
    void observe(SessionObserver& observer) { observers_.push_back(&observer); }
    void ignore(const SessionObserver& observer) { std::erase(observers_, &observer); }

    /// Enables the messages of compile_notice().
    void announce_compiling() { announces_compiling_ = true; }

    /// Returns the thread of announce_compiling() (base/log.hpp), or an empty thread if messages are not enabled.
    /// Keep the thread while kernels are compiled and launched for the first time.
    [[nodiscard]] std::jthread compile_notice() const;

    /// Starts a host span, which ends when the returned object is destroyed. Records it in the SpanLog of observe().
    [[nodiscard]] SpanLog::Span span(const std::string& name) const { return SpanLog::Span(spans_, name); }

    /// Submits all enqueued commands to the device (clFlush). Until this call a driver may defer them. Does not wait.
    void flush();

    /// Waits for all commands. Throws DeviceError, with the label, if a command failed on the device.
    void finish();

    /// Waits for all commands and returns the records of all commands since the last clear_profile().
    const Profile& profile();

    /// Waits for all commands and clears the profile, to start a new measurement.
    void clear_profile();

  private:
    struct CopyEnd {  // source or destination of a copy
        const cl::Buffer& memory;
        const std::string& name;
        std::size_t offset;  // bytes
    };
    struct PendingCommand {  // a command whose times have not been read yet
        CommandRecord record;
        cl::Event event;
        std::vector<std::byte> source{};  // of a write that copies its source
    };

    static void check_range(const std::string& label, const std::string& buffer, std::size_t size, std::size_t offset,
                            std::size_t count);
    static void check_blocks(const std::string& label, const std::string& buffer, std::size_t size, Blocks layout,
                             std::size_t count, std::size_t blocks);
    /// `host`: memory to use on a device that uses the host's memory, or nullptr.
    cl::Buffer allocate(const std::string& name, std::size_t count, std::size_t element_bytes, const void* host) const;
    /// Calls call(observer) for all observers, and for the Capture if there is one.
    template <class Call>
    void for_each_observer(const Call& call) const;
    void launch_kernel(CommandRecord record, const cl::Kernel& kernel, std::size_t local_bytes);
    void write_bytes(const std::string& label, const cl::Buffer& target, const std::string& name, std::size_t offset,
                     std::size_t bytes, const void* source);
    /// Waits, unless `done` is given: it becomes the read's event.
    void read_bytes(const std::string& label, const cl::Buffer& source, const std::string& name, std::size_t offset,
                    std::size_t bytes, void* target, cl::Event* done);
    /// Copies `rows` rows of `bytes` bytes. Pitches are in bytes too.
    void copy_rows(const std::string& label, const CopyEnd& source, std::size_t source_pitch, const CopyEnd& target,
                   std::size_t target_pitch, std::size_t bytes, std::size_t rows);

    /// Enqueues one command by `enqueue(cl::Event*)` and records it. `operation`: description of the command for error
    /// messages.
    template <class Enqueue>
    void submit(const std::string& operation, CommandRecord record, Enqueue&& enqueue);
    CommandRecord finished_record(const PendingCommand& pending) const;

    // If this number of commands is pending, the session waits for the device and reads the commands' times. Events of
    // pending commands occupy memory of the driver.
    static constexpr std::size_t kMaxPendingCommands = 4096;
    // Minimum size of a buffer that shares the host's memory. Smaller ones are copied, so that a device's transfers are
    // tested by the scenes of `raya verify`.
    static constexpr std::size_t kMinSharedBytes = 64u << 20;

    cl::Device device_;
    DeviceInfo info_;
    mutable std::uint64_t bytes_taken_ = 0;
    cl::Context context_;
    cl::CommandQueue queue_;
    std::vector<PendingCommand> pending_;
    Profile profile_;
    std::map<std::string, std::uint32_t> launch_limits_;
    std::vector<SessionObserver*> observers_;
    std::unique_ptr<SessionObserver> build_log_;  // with RAYA_KERNEL_LOG
    bool announces_compiling_ = false;
    SpanLog* spans_ = nullptr;
};

template <class Enqueue>
void Session::submit(const std::string& operation, CommandRecord record, Enqueue&& enqueue) {
    if (pending_.size() >= kMaxPendingCommands) finish();
    cl::Event event;
    guarded(operation, [&] { enqueue(&event); });
    pending_.push_back({std::move(record), std::move(event)});
}

}  // namespace raya
