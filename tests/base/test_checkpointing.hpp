// Checkpoints in tests: a render that stops after a number of checkpoints, and resumes from the bytes of one.
#pragma once
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "host/base/checkpoint.hpp"
#include "host/base/encoding.hpp"
#include "host/base/json.hpp"

namespace raya {

struct Stopped {};

/// Saves a checkpoint as bytes after every band or superstep, and stops the render after `saves` checkpoints. The
/// render resumes from the checkpoint `resumed` unless it is empty.
class TestCheckpointing {
  public:
    explicit TestCheckpointing(int saves = 1 << 30, std::string resumed = "")
        : saves_left_(saves), saved_(std::move(resumed)) {
        checkpointing_.band_s = 0;  // shortest possible bands
        checkpointing_.due = [] { return true; };
        checkpointing_.save = [this](const std::string& bytes) {
            all_.push_back(bytes);
            saved_ = bytes;
            if (--saves_left_ == 0) throw Stopped();
        };
        checkpointing_.resume = [this](const auto& read) {
            if (!saved_.empty()) read(saved_);
        };
    }
    const Checkpointing* checkpointing() const { return &checkpointing_; }
    const std::string& saved() const { return saved_; }
    const std::vector<std::string>& all() const { return all_; }
    int count() const { return static_cast<int>(all_.size()); }

  private:
    int saves_left_;
    std::string saved_;
    std::vector<std::string> all_;
    Checkpointing checkpointing_;
};

/// The vectors of a checkpoint, for damage with a valid hash.
struct CheckpointBody {
    explicit CheckpointBody(const std::string& bytes)
        : header(bytes.substr(0, bytes.find('\n', bytes.find('\n') + 1) + 1)),
          body(bytes.substr(header.size(), bytes.size() - header.size() - bytes_hash("").size())) {}

    std::string bytes() const { return header + body + bytes_hash(header + body); }

    /// Returns the position of the number of elements of a vector; the elements follow after 8 bytes. `element_bytes`:
    /// size of an element, for each of the vectors before it.
    std::size_t vector_at(const std::vector<std::size_t>& element_bytes) const {
        std::size_t at = 0;
        for (const std::size_t size : element_bytes) at += 8 + size * number<std::uint64_t>(at);
        return at;
    }
    template <class T>
    T number(std::size_t at) const {
        T value{};
        std::memcpy(&value, &body.at(at), sizeof value);
        return value;
    }
    template <class T>
    void set(std::size_t at, T value) {
        std::memcpy(&body.at(at), &value, sizeof value);
    }

    std::string header, body;
};

}  // namespace raya
