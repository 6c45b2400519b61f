// Observers of program builds and kernel launches, and one of them: the capture of a build or launch as files, from
// which a self-contained test case is made (host/verify/reproduce.cpp).
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/opencl.hpp"
#include "host/cl/profile.hpp"

namespace raya {

/// Observes the builds and launches of a session (Session::observe()). The functions do nothing unless overridden.
class SessionObserver {
  public:
    virtual ~SessionObserver() = default;

    virtual void build_begins(const std::string& /*name*/, const std::string& /*source*/,
                              const std::string& /*options*/) {}
    virtual void build_ended(const cl::Program& /*program*/, const std::string& /*name*/,
                             const std::string& /*options*/, double /*seconds*/) {}
    /// Before and after the launch is enqueued; may wait for the queue. launch_ended() may add figures to the record.
    virtual void launch_begins(const cl::CommandQueue& /*queue*/, const cl::Kernel& /*kernel*/,
                               const CommandRecord& /*launch*/) {}
    virtual void launch_ended(const cl::CommandQueue& /*queue*/, const cl::Kernel& /*kernel*/,
                              CommandRecord& /*launch*/) {}
};

/// Correct words of a buffer, as far as they are known.
struct KnownWords {
    std::vector<std::uint32_t> words;
    std::vector<std::uint32_t> mask;  // 0: the word is not known; 1: known; 2: a NaN, of any sign and payload

    /// Marks all words of a buffer of `size` words as unknown.
    explicit KnownWords(std::size_t size) : words(size), mask(size) {}
    explicit KnownWords(std::vector<std::uint32_t> all) : words(std::move(all)), mask(words.size(), 1) {}
    void set(std::size_t at, std::uint32_t word, bool any_nan = false) { words[at] = word, mask[at] = any_nan ? 2 : 1; }
};

/// Observes all builds and launches ("steps", numbered from 1) of this process while the object exists. Each step
/// finishes before the next command starts. `report` is called with one JSON object per event:
///
///     {"step": N, "name": TEXT}               step N starts; if it is the captured step, the files with its inputs
///                                             are complete
///     {"done": N, "outputs": {NAME: HASH}}    step N has ended; hashes of all buffers among the kernel's arguments
///     {"expected": N}                         report_expected() gave the correct words of a buffer of step N
///
/// Files of a captured launch: kernel.cl (source with all included files), launch.json (program, kernel, options,
/// work-groups, arguments), and for each buffer or value among the arguments NAME.in, for each buffer also NAME.out,
/// and NAME.expected and NAME.mask if correct words are known (KnownWords). Of a captured build: kernel.cl and
/// launch.json only.
class Capture final : public SessionObserver {
  public:
    /// Captures step number `step`, if not 0, into the existing folder `folder`.
    Capture(std::size_t step, std::filesystem::path folder, std::function<void(const Json&)> report);
    ~Capture() override;
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    /// Returns the existing Capture, or a null pointer.
    static Capture* active();

    void build_begins(const std::string& name, const std::string& source, const std::string& options) override;
    void build_ended(const cl::Program& program, const std::string& name, const std::string& options,
                     double seconds) override;
    void launch_begins(const cl::CommandQueue& queue, const cl::Kernel& kernel, const CommandRecord& launch) override;
    void launch_ended(const cl::CommandQueue& queue, const cl::Kernel& kernel, CommandRecord& launch) override;
    // Called by Session and Kernel:
    /// Fills the new buffer, so that its contents are the same in all runs.
    void add_buffer(const cl::CommandQueue& queue, const cl::Buffer& buffer, const std::string& name,
                    std::size_t bytes);
    void set_argument(const cl::Kernel& kernel, std::size_t index, std::size_t bytes, const void* value);
    void expect(const std::string& buffer, const KnownWords& words);

  private:
    struct ProgramText {
        std::string name, source, options;
    };
    struct NamedBuffer {
        std::string name;
        std::size_t bytes;
    };
    struct Argument {
        std::string name;         // "arg2_results"; the file's name without extension
        std::size_t bytes = 0;    // size of the buffer, of the value or of the local memory
        cl_mem buffer = nullptr;  // null: a value or local memory
        std::string value{};      // bytes of a value; empty: a buffer or local memory
    };

    void start_step(const std::string& name) const;
    void write_file(const std::string& name, const std::string& bytes) const;
    std::vector<Argument> arguments_of(cl_kernel kernel) const;

    std::size_t captured_step_, step_ = 0;
    std::filesystem::path folder_;
    std::function<void(const Json&)> report_;
    ProgramText building_;
    std::map<cl_program, ProgramText> programs_;
    std::map<cl_mem, NamedBuffer> buffers_;
    std::map<cl_kernel, std::map<std::size_t, std::pair<std::size_t, std::string>>> set_arguments_;  // size and bytes
    std::vector<Argument> launched_;  // arguments of the current or last launch
};

/// For checks: if a Capture exists, gives it the correct words of the buffer of this name in the last launch.
void report_expected(const std::string& buffer, const KnownWords& words);

}  // namespace raya
