// Checkpoints: the state of a partial render as the bytes of a file.
//
//     raya state 4
//     {"of": {NAME: VALUE, ...}, "fraction": ..., "seconds": ...}
//     vectors: the number of elements (64 bits), then the elements; numbers are little-endian on every host
//     hash of all bytes before it, 32 hexadecimal digits
//
// A checkpoint does not depend on the number of ranks, so a render can be resumed with other ranks.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raya {

/// Names and values of all settings that determine the state. CheckpointReader compares them, so that it rejects the
/// checkpoint of a different render. A name is an option, or a text that can follow "was rendered with". The value of a
/// flag is "yes" or "no".
using StateSettings = std::vector<std::pair<std::string, std::string>>;

/// First bytes of a checkpoint.
inline constexpr std::string_view kStateMagic = "raya state 4\n";

/// Progress of a render: completed fraction, 0..1, and measured time of all runs so far, seconds.
struct RenderedPart {
    double fraction = 0, seconds = 0;
};

class CheckpointWriter {
  public:
    CheckpointWriter(const StateSettings& settings, const RenderedPart& part);

    template <class T>
    void put(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::uint64_t count = values.size();
        put_numbers(std::as_bytes(std::span(&count, 1)), sizeof count);
        put_numbers(std::as_bytes(std::span(values)), alignof(T));  // a structure's members have the same type
    }
    /// Returns the bytes of the file.
    std::string finish();

  private:
    void put_numbers(std::span<const std::byte> numbers, std::size_t number_bytes);

    std::string bytes_;
};

/// Reads what a CheckpointWriter has written. All functions throw UserError, whose text does not contain the file's
/// name, if the bytes are damaged.
class CheckpointReader {
  public:
    /// Also throws UserError if the bytes are not a checkpoint, or belong to a different render: then the text contains
    /// the first setting that differs. `bytes` must outlive the reader.
    CheckpointReader(std::string_view bytes, const StateSettings& settings);

    const RenderedPart& part() const { return part_; }

    /// Replaces the elements of `values`. The file must have the same number of elements.
    template <class T>
    void take(std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        take_count(sizeof(T), values.size());
        take_numbers(std::as_writable_bytes(std::span(values)), alignof(T));
    }
    /// Returns a vector of any number of elements.
    template <class T>
    std::vector<T> take_any() {
        static_assert(std::is_trivially_copyable_v<T>);
        std::vector<T> values(take_count(sizeof(T), {}));
        take_numbers(std::as_writable_bytes(std::span(values)), alignof(T));
        return values;
    }

    /// Throws UserError if vectors are left.
    void check_end() const;

  private:
    /// Returns the number of elements of the next vector.
    std::uint64_t take_count(std::size_t value_bytes, std::optional<std::uint64_t> expected);
    void take_numbers(std::span<std::byte> numbers, std::size_t number_bytes);

    std::string_view bytes_;
    RenderedPart part_;
};

/// Callbacks for the checkpoints of a render. With several ranks, only rank 0 calls `due`, `save` and `resume`.
struct Checkpointing {
    /// Target duration of a band of pixels, seconds.
    double band_s = 2;
    /// Returns true if the next checkpoint is due.
    std::function<bool()> due;
    /// Saves the bytes of a CheckpointWriter.
    std::function<void(const std::string& bytes)> save;
    /// Calls `read` with the bytes of the checkpoint to resume, if there is one. Empty: do not resume.
    std::function<void(const std::function<RenderedPart(std::string_view bytes)>& read)> resume;
};

// Checkpoints of long renders: --checkpoint, --resume, --checkpoint-every.

/// The options as given on the command line. An empty `file` means no checkpoints.
struct CheckpointOptions {
    std::string file;
    bool resume = false;
    double every_s = 10;  // minimum seconds between two checkpoints
};

/// Throws UserError for an existing file that is not a checkpoint. Without --resume, also throws UserError for an
/// existing checkpoint, because the render would overwrite hours of work.
void check_checkpoint_options(const CheckpointOptions& options);

/// Removes the checkpoint, if there is one. Call it after all outputs of the render are written.
void remove_checkpoint(const CheckpointOptions& options);

/// Returns the callbacks with which a renderer saves and loads the checkpoint; null without --checkpoint. Saving takes
/// at most 5 % of the time, unless `every_s` is 0.
std::unique_ptr<const Checkpointing> checkpointing_of(const CheckpointOptions& options);

}  // namespace raya
