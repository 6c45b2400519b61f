// A session on one device: every buffer, program and command is made here; every command has a label and is profiled.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/cl/device.hpp"
#include "host/cl/memory.hpp"
#include "host/cl/opencl.hpp"
#include "host/cl/profile.hpp"
#include "host/cl/program.hpp"

namespace raya {

/// Whether the device is asked to measure its commands (a device that cannot is not asked).
enum class Timing { kOn, kOff };

/// Whether all transfers go through pinned memory (host/cl/memory.hpp), or small writes alone, through plain memory;
/// of the device: the former where its memory is its own.
enum class Transfers { kOfDevice, kDirect, kStaged };

/// A context and an in-order queue: commands run one after another, in the order in which they were given.
///
/// All offsets and counts are elements. A range beyond a buffer's end throws std::out_of_range, an empty launch or
/// buffer std::invalid_argument: both are mistakes in the host program. What the driver refuses throws DeviceError with
/// call, label, buffers or kernel, error name and remedy. A transfer of no elements does nothing and leaves no record.
class Session {
  public:
    explicit Session(const cl::Device& device, Timing timing = Timing::kOn, Transfers transfers = Transfers::kOfDevice);
    Session(Session&&) = default;  // not copied: a copy would report the same commands twice
    /// Waits for all commands, those that an exception has overtaken too; tells their times to who wants to know
    /// (host/base/say.hpp).
    ~Session();

    const DeviceInfo& device() const { return info_; }

    /// Of all buffers that were made so far, those that are gone among them.
    std::uint64_t bytes_taken() const { return bytes_taken_; }

    /// `count` > 0 elements; `name` is for messages. DeviceError if larger than the device allows for one buffer.
    template <class T>
    Buffer<T> buffer(const std::string& name, std::size_t count) const {
        return Buffer<T>(allocate(name, count, sizeof(T)), name, count);
    }

    /// See Program. A device's sessions share what they have built: the same source with the same options is built once
    /// in a process.
    Program build(const std::string& name, const std::string& source, const std::vector<std::string>& options) const;

    /// The most work of a launch labelled so, in its kernel's units: no limit until the device has cut loops.
    std::uint32_t& launch_limit(const std::string& label) {
        return launch_limits_.try_emplace(label, UINT32_MAX).first->second;
    }

    /// Runs `groups` work-groups of `group_size` work-items each (one dimension). Does not wait.
    template <class... Params>
    void launch(const std::string& label, Kernel<Params...>& kernel, std::size_t groups, std::size_t group_size,
                std::type_identity_t<Params>... args) {
        kernel.set_arguments(args...);
        const std::size_t local_bytes = (local_bytes_of(args) + ... + 0);
        const bool texts = noted_arguments_ > 0;
        noted_arguments_ -= texts;
        launch_kernel({.label = label,
                       .kind = "kernel",
                       .object = kernel.name(),
                       .groups = groups,
                       .group_size = group_size,
                       .arguments = texts ? kernel.argument_texts(args...) : std::vector<ArgumentText>{}},
                      kernel.handle(), local_bytes);
    }

    /// Host to device: `from` into `to` from element `offset` on. `from` may change afterwards: either this waits, or
    /// its bytes are on their way from memory of the session's.
    template <class T>
    void write(const std::string& label, Buffer<T>& to, std::span<const std::type_identity_t<T>> from,
               std::size_t offset = 0) {
        check_range(label, to.name(), to.size(), offset, from.size());
        write_bytes(label, to.memory(), to.name(), offset * sizeof(T), from.size_bytes(), from.data());
    }

    /// Device to host: `from` from element `offset` on, as many as `to` holds. Waits.
    template <class T>
    void read(const std::string& label, const Buffer<T>& from, std::span<std::type_identity_t<T>> to,
              std::size_t offset = 0) {
        check_range(label, from.name(), from.size(), offset, to.size());
        read_bytes(label, from.memory(), from.name(), offset * sizeof(T), to.size_bytes(), to.data());
    }

    /// Memory for `count` > 0 elements that are read while the host goes on. DeviceError where there is none.
    template <class T>
    Landing<T> landing(const std::string& name, std::size_t count) const {
        return {host_memory(name, count * sizeof(T)), count};
    }

    /// Device to host: `count` elements of `from` from element `offset` on, into `to` from element `to_offset` on. Does
    /// not wait; they are there after wait(), and later reads into `to` come after this one.
    template <class T>
    void read(const std::string& label, const Buffer<T>& from, std::size_t offset, Landing<T>& to,
              std::size_t to_offset, std::size_t count) {
        check_range(label, from.name(), from.size(), offset, count);
        check_range(label, "landing of " + from.name(), to.size(), to_offset, count);
        read_later(label, from.memory(), from.name(), offset * sizeof(T), count * sizeof(T), to.memory(),
                   to_offset * sizeof(T));
    }

    /// Waits for what is to land there. DeviceError with the label where that has failed.
    template <class T>
    void wait(const std::string& label, Landing<T>& landing) {
        wait_for(label, landing.memory());
    }

    /// Device to device: `count` elements; within one buffer the two ranges must not overlap. Does not wait.
    template <class T>
    void copy(const std::string& label, const Buffer<T>& from, std::size_t from_offset, Buffer<T>& to,
              std::size_t to_offset, std::size_t count) {
        check_range(label, from.name(), from.size(), from_offset, count);
        check_range(label, to.name(), to.size(), to_offset, count);
        copy_bytes(label, {from.memory(), from.name(), from_offset * sizeof(T)},
                   {to.memory(), to.name(), to_offset * sizeof(T)}, count * sizeof(T));
    }

    /// Where the blocks of a buffer lie: the first at element `first`, `pitch` elements from one to the next; a range
    /// starts at element `offset` of each.
    struct Blocks {
        std::size_t offset = 0, pitch = 0, first = 0;
    };

    /// Device to device, between different buffers: `count` elements of each of `blocks` blocks. Does not wait.
    template <class T>
    void copy_blocks(const std::string& label, const Buffer<T>& from, Blocks from_at, Buffer<T>& to, Blocks to_at,
                     std::size_t count, std::size_t blocks) {
        check_blocks(label, from.name(), from.size(), from_at, count, blocks);
        check_blocks(label, to.name(), to.size(), to_at, count, blocks);
        copy_rows(label, {from.memory(), from.name(), (from_at.first + from_at.offset) * sizeof(T)},
                  from_at.pitch * sizeof(T), {to.memory(), to.name(), (to_at.first + to_at.offset) * sizeof(T)},
                  to_at.pitch * sizeof(T), count * sizeof(T), blocks);
    }

    /// Sets every element of `to` to `value`. Does not wait.
    template <class T>
    void fill(const std::string& label, Buffer<T>& to, const std::type_identity_t<T>& value) {
        static_assert(sizeof(T) <= 128 && (sizeof(T) & (sizeof(T) - 1)) == 0,
                      "OpenCL fills with 1, 2, 4, ... 128 bytes");
        fill_bytes(label, to.memory(), to.name(), to.bytes(), &value, sizeof(T));
    }

    /// For traces: from now on `steps`, which outlives the session, is told of step()s and builds, and the profile
    /// keeps the arguments of the next `launches` launches, with their names in programs built from now on.
    void observe(StepLog& steps, std::size_t launches) {
        steps_ = &steps;
        noted_arguments_ = launches;
    }

    /// From now on compiling() says what it does.
    void announce_compiling() { announces_ = true; }

    /// From now on `builds` gets an entry for each program that is built, with its kernels' first launches;
    /// null: no longer.
    void note_builds(std::vector<KernelBuild>* builds) { builds_ = builds; }

    /// Keeps the binaries of all programs that were built for the device, see Program::keep_binary().
    void keep_binaries() const;

    /// To be kept while kernels are compiled and first launched, see announce_compiling() of host/base/progress.hpp.
    [[nodiscard]] std::jthread compiling() const;

    /// A step of the host, from now to the end of the scope that it is kept in; for the log of observe(), else nothing.
    [[nodiscard]] StepLog::Step step(const std::string& name) const { return StepLog::Step(steps_, name); }

    /// Has the device begin with all commands so far, which a driver may put off. Does not wait.
    void flush();

    /// Waits for all commands. DeviceError names the label of a command that failed on the device.
    void finish();

    /// All commands so far; waits for them.
    const Profile& profile();

    /// Forgets all commands so far, after they have finished: what follows is a measurement of its own.
    void clear_profile();

  private:
    struct Place {  // one end of a copy
        const cl::Buffer& memory;
        const std::string& name;
        std::size_t offset;  // bytes
    };
    struct Pending {  // a command whose times are not known yet
        CommandRecord record;
        cl::Event event;
    };

    static void check_range(const std::string& label, const std::string& buffer, std::size_t size, std::size_t offset,
                            std::size_t count);
    static void check_blocks(const std::string& label, const std::string& buffer, std::size_t size, Blocks at,
                             std::size_t count, std::size_t blocks);
    cl::Buffer allocate(const std::string& name, std::size_t count, std::size_t element_bytes) const;
    std::unique_ptr<HostMemory> host_memory(const std::string& name, std::size_t bytes) const;
    void launch_kernel(CommandRecord record, const cl::Kernel& kernel, std::size_t local_bytes);
    void write_bytes(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t offset,
                     std::size_t bytes, const void* from);
    void read_bytes(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                    std::size_t bytes, void* to);
    void read_later(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                    std::size_t bytes, HostMemory& to, std::size_t to_offset);
    static void wait_for(const std::string& label, HostMemory& memory);
    void write_staged(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t offset,
                      std::size_t bytes, const std::byte* from);
    void read_staged(const std::string& label, const cl::Buffer& from, const std::string& name, std::size_t offset,
                     std::size_t bytes, std::byte* to);
    void copy_bytes(const std::string& label, const Place& from, const Place& to, std::size_t bytes);
    /// `rows` of so many bytes; pitches in bytes too.
    void copy_rows(const std::string& label, const Place& from, std::size_t from_pitch, const Place& to,
                   std::size_t to_pitch, std::size_t bytes, std::size_t rows);
    void fill_bytes(const std::string& label, const cl::Buffer& to, const std::string& name, std::size_t bytes,
                    const void* value, std::size_t value_bytes);

    /// Puts one command into the queue by `enqueue(cl::Event*)` and notes it; `what` is for the message of a failure.
    template <class Enqueue>
    void submit(const std::string& what, CommandRecord record, Enqueue&& enqueue);
    CommandRecord finished(const Pending& pending) const;

    cl::Device device_;
    DeviceInfo info_;
    mutable std::uint64_t bytes_taken_ = 0;
    cl::Context context_;
    std::unique_ptr<cl::CommandQueue> queue_;  // at an address that stays, when a session moves
    bool pinned_ = false;                      // all transfers go through pinned memory; else small writes, plain
    std::unique_ptr<Staging> staging_;
    std::vector<Pending> pending_;
    Profile profile_;
    std::map<std::string, std::uint32_t> launch_limits_;
    bool logs_builds_ = logs_kernel_builds();
    std::vector<KernelBuild>* builds_ = nullptr;
    std::set<std::pair<cl_kernel, std::size_t>> launched_;  // with which group size, where builds are noted
    bool announces_ = false;
    StepLog* steps_ = nullptr;
    std::size_t noted_arguments_ = 0;  // launches whose arguments are still to be kept
};

}  // namespace raya
