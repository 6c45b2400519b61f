#include "host/cl/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>

#include "host/base/log.hpp"

namespace raya {
namespace {

/// State shared by all sessions of a device. Never destroyed, because the driver may be unloaded before static objects
/// are destroyed.
struct SharedContext {
    cl::Context context;
    std::mutex build_mutex;
    std::map<std::pair<std::vector<std::string>, std::string>, Program> programs;  // by (options, source)
};

SharedContext& shared_context(const cl::Device& device) {
    static std::mutex mutex;
    static auto* const contexts = new std::map<cl_device_id, SharedContext>;
    const std::scoped_lock lock(mutex);
    const auto [shared, is_new] = contexts->try_emplace(device());
    try {
        if (is_new) shared->second.context = cl::Context(device);
    } catch (...) {
        contexts->erase(shared);
        throw;
    }
    return shared->second;
}

}  // namespace

Session::Session(const cl::Device& device, Timing timing)
    : device_(device), info_(device_info(device)), profile_(timing == Timing::kOn && info_.profiling) {
    guarded(fmt::format("opening a session on {} {}", info_.platform, info_.name), [&] {
        context_ = shared_context(device_).context;
        queue_ = cl::CommandQueue(context_, device_, profile_.timed() ? CL_QUEUE_PROFILING_ENABLE : 0);
    });
    if (const char* log = std::getenv("RAYA_KERNEL_LOG")) {
        build_log_ = std::make_unique<KernelBuilds>(log);
        observe(*build_log_);
    }
}

template <class Call>
void Session::for_each_observer(const Call& call) const {
    for (SessionObserver* observer : observers_) call(*observer);
    if (Capture::active() != nullptr) call(*Capture::active());
}

Session::~Session() {
    if (queue_() == nullptr) return;  // another object has taken the contents of this session
    // The device must be idle when the program ends: PoCL's threads, which may still be compiling a kernel, crash with
    // SIGSEGV if PoCL's library is unloaded while they run. clFinish() does not throw.
    clFinish(queue_());
}

Program Session::build(const std::string& name, const std::string& source,
                       const std::vector<std::string>& options) const {
    std::vector<std::string> all_options = options;
    if (const std::string user_options = user_build_options(); !user_options.empty())
        all_options.push_back(user_options);
    SharedContext& shared = shared_context(device_);
    const std::scoped_lock lock(shared.build_mutex);
    const auto built = shared.programs.find({all_options, source});
    if (built != shared.programs.end()) return built->second;
    const SpanLog::Span building = span("build " + name);
    const std::string joined_options = fmt::format("{}", fmt::join(all_options, " "));
    for_each_observer([&](SessionObserver& observer) { observer.build_begins(name, source, joined_options); });
    const Clock::time_point start = Clock::now();
    Program program(context_, device_, name, source, all_options);
    const double seconds = seconds_since(start);
    for_each_observer(
        [&](SessionObserver& observer) { observer.build_ended(program.handle(), name, program.options(), seconds); });
    log_message(kDetailed, fmt::format("build {}: options {}", name, program.options()));
    log_message(kDetailed, program.log());
    return shared.programs.emplace(std::pair(all_options, source), program).first->second;
}

std::jthread Session::compile_notice() const {
    return announces_compiling_ ? raya::announce_compiling(info_.name) : std::jthread();
}

cl::Buffer Session::allocate(const std::string& name, std::size_t count, std::size_t element_bytes,
                             const void* host) const {
    if (count == 0) throw std::invalid_argument(fmt::format("buffer '{}': OpenCL has no empty buffers", name));
    if (count > info_.max_allocation_bytes / element_bytes) {
        throw DeviceError(fmt::format(
            "buffer '{}' needs {} elements of {} bytes = {:.0f} bytes; {} allows {} bytes for one buffer; remedy: "
            "fewer pixels, a smaller scene, or another device",
            name, count, element_bytes, double(count) * double(element_bytes), info_.name, info_.max_allocation_bytes));
    }
    bytes_taken_ += count * element_bytes;
    const bool shared = host != nullptr && !info_.separate_memory && count * element_bytes >= kMinSharedBytes;
    const cl_mem_flags flags = shared ? CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR : CL_MEM_READ_WRITE;
    void* const memory = shared ? const_cast<void*>(host) : nullptr;
    const cl::Buffer buffer = guarded(fmt::format("allocating buffer '{}' ({} bytes)", name, count * element_bytes),
                                      [&] { return cl::Buffer(context_, flags, count * element_bytes, memory); });
    if (Capture::active() != nullptr) Capture::active()->add_buffer(queue_, buffer, name, count * element_bytes);
    return buffer;
}

void Session::check_range(const std::string& label, const std::string& buffer, std::size_t size, std::size_t offset,
                          std::size_t count) {
    if (offset > size || count > size - offset) {
        throw std::out_of_range(fmt::format("'{}': {} elements from element {} on exceed buffer '{}' of {} elements",
                                            label, count, offset, buffer, size));
    }
}

void Session::check_blocks(const std::string& label, const std::string& buffer, std::size_t size, Blocks layout,
                           std::size_t count, std::size_t blocks) {
    check_range(label, buffer, layout.pitch, layout.offset, count);
    if (layout.first > size || (layout.pitch > 0 && blocks > (size - layout.first) / layout.pitch)) {
        throw std::out_of_range(
            fmt::format("'{}': {} blocks of {} elements from element {} on exceed buffer '{}' of {} elements", label,
                        blocks, layout.pitch, layout.first, buffer, size));
    }
}

void Session::write_bytes(const std::string& label, const cl::Buffer& target, const std::string& name,
                          std::size_t offset, std::size_t bytes, const void* source) {
    // A small source is copied, because waking and awaiting the driver's thread takes longer.
    constexpr std::size_t kMaxCopiedBytes = 64u << 10;
    if (bytes == 0) return;
    const bool is_copied = bytes <= kMaxCopiedBytes;
    std::vector<std::byte> copy(is_copied ? bytes : 0);
    if (is_copied) std::memcpy(copy.data(), source, bytes);
    submit(fmt::format("'{}': writing {} bytes into buffer '{}'", label, bytes, name),
           {.label = label, .kind = "write", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_.enqueueWriteBuffer(target, is_copied ? CL_FALSE : CL_TRUE, offset, bytes,
                                         is_copied ? copy.data() : source, nullptr, event);
           });
    pending_.back().source = std::move(copy);
}

void Session::read_bytes(const std::string& label, const cl::Buffer& source, const std::string& name,
                         std::size_t offset, std::size_t bytes, void* target, cl::Event* done) {
    if (bytes == 0) return;
    submit(fmt::format("'{}': reading {} bytes of buffer '{}'", label, bytes, name),
           {.label = label, .kind = "read", .bytes = bytes, .target_name = name}, [&](cl::Event* event) {
               queue_.enqueueReadBuffer(source, done == nullptr ? CL_TRUE : CL_FALSE, offset, bytes, target, nullptr,
                                        event);
           });
    if (done != nullptr) *done = pending_.back().event;
}

void Session::copy_rows(const std::string& label, const CopyEnd& source, std::size_t source_pitch,
                        const CopyEnd& target, std::size_t target_pitch, std::size_t bytes, std::size_t rows) {
    if (bytes == 0 || rows == 0) return;
    submit(fmt::format("'{}': copying {} x {} bytes of buffer '{}' into buffer '{}'", label, rows, bytes, source.name,
                       target.name),
           {.label = label, .kind = "copy", .bytes = bytes * rows, .target_name = source.name + " -> " + target.name},
           [&](cl::Event* event) {
               if (rows == 1)
                   queue_.enqueueCopyBuffer(source.memory, target.memory, source.offset, target.offset, bytes, nullptr,
                                            event);
               else
                   queue_.enqueueCopyBufferRect(source.memory, target.memory, {source.offset, 0, 0},
                                                {target.offset, 0, 0}, {bytes, rows, 1}, source_pitch, 0, target_pitch,
                                                0, nullptr, event);
           });
}

void Session::launch_kernel(CommandRecord record, const cl::Kernel& kernel, std::size_t local_bytes) {
    const std::size_t groups = record.groups, group_size = record.group_size;
    const std::string operation = fmt::format("'{}': launching kernel '{}' ({} groups of {} work-items)", record.label,
                                              record.target_name, groups, group_size);
    if (groups == 0 || group_size == 0) throw std::invalid_argument(operation + ": no work-items");
    if (local_bytes > info_.local_memory_bytes) {
        throw DeviceError(
            fmt::format("{}: needs {} bytes of local memory, {} has {} per work-group; remedy: a smaller scene, or "
                        "another device",
                        operation, local_bytes, info_.name, info_.local_memory_bytes));
    }
    const std::size_t max_size =
        guarded(operation, [&] { return kernel.getWorkGroupInfo<CL_KERNEL_WORK_GROUP_SIZE>(device_); });
    if (group_size > max_size) {
        throw DeviceError(
            fmt::format("{}: {} allows groups of 1..{} for this kernel; remedy: --group {}, or fewer lanes (--lanes)",
                        operation, info_.name, max_size, max_size));
    }
    guarded(operation, [&] {
        for_each_observer([&](SessionObserver& observer) { observer.launch_begins(queue_, kernel, record); });
    });
    submit(operation, std::move(record), [&](cl::Event* event) {
        queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * group_size), cl::NDRange(group_size),
                                    nullptr, event);
    });
    guarded(operation, [&] {
        for_each_observer(
            [&](SessionObserver& observer) { observer.launch_ended(queue_, kernel, pending_.back().record); });
    });
}

CommandRecord Session::finished_record(const PendingCommand& pending) const {
    CommandRecord record = pending.record;
    guarded(fmt::format("'{}' ({})", record.label, record.kind), [&] {
        const cl_int status = pending.event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>();
        if (status < 0) throw cl::Error(status, "the command");
        if (!profile_.timed()) return;
        record.queued = pending.event.getProfilingInfo<CL_PROFILING_COMMAND_QUEUED>();
        record.submitted = pending.event.getProfilingInfo<CL_PROFILING_COMMAND_SUBMIT>();
        record.started = pending.event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
        record.ended = pending.event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
    });
    return record;
}

void Session::flush() {
    guarded("flushing the command queue", [this] { queue_.flush(); });
}

void Session::finish() {
    const std::vector<PendingCommand> done = std::exchange(pending_, {});  // cleared even if a command failed
    guarded("waiting for the device", [this] { queue_.finish(); });
    for (const PendingCommand& command : done) profile_.add(finished_record(command));
}

const Profile& Session::profile() {
    finish();
    return profile_;
}

void Session::clear_profile() {
    finish();
    profile_.clear();
}

}  // namespace raya
