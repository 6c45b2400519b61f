// Checkpoints in tests: a render that stops after a number of checkpoints, and resumes from the bytes of one.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "host/base/checkpoint.hpp"

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

/// Returns the header of a checkpoint.
inline Json checkpoint_header(const std::string& bytes) {
    const std::size_t magic_end = bytes.find('\n') + 1;
    return Json::parse(bytes.substr(magic_end, bytes.find('\n', magic_end) - magic_end), {"the header"});
}

/// Returns the settings in a checkpoint.
inline StateSettings saved_settings(const std::string& bytes) {
    const Json header = checkpoint_header(bytes);
    StateSettings settings;
    for (const std::string& name : header.at("of").keys()) settings.emplace_back(name, header.at("of").at(name).text());
    return settings;
}

}  // namespace raya
