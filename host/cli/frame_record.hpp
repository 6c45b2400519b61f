// What is kept of a sequence's frames beside them, so that a sequence that was stopped goes on, and one that was
// changed keeps no stale frame.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "host/base/clock.hpp"
#include "host/base/json.hpp"

namespace raya {

/// One frame that was rendered.
struct FrameEntry {
    std::uint32_t number = 0;
    std::string settings;                                    // a hash of all that the frame follows from
    std::string pixels;                                      // pixel_hash() of the image
    double imbalance = 0, speed_up = 0;                      // of the modelled loads
    std::vector<std::pair<std::string, std::string>> files;  // name, seen from the record's folder; bytes_hash()
};

class FrameRecord {
  public:
    /// Reads `file`, where it is there. UserError where it is and is no record.
    explicit FrameRecord(std::filesystem::path file);

    /// The entry of that frame, if it was rendered by these settings and `files` lie there as they were written; else a
    /// null pointer.
    const FrameEntry* find(std::uint32_t number, const std::string& settings,
                           const std::vector<std::string>& files) const;

    /// Adds a frame whose files have been written, `entry.files` aside, replacing an older one, and writes the record,
    /// unless that would take over a twentieth of the time: then a later call does, or write().
    const FrameEntry& add(FrameEntry entry, const std::vector<std::string>& files);

    /// Writes the frames added here and those that other processes have written since: one process at a time merges.
    void write();

  private:
    void read();
    std::string name_of(const std::string& file) const;

    std::filesystem::path file_;
    std::map<std::uint32_t, FrameEntry> entries_;  // by their numbers
    std::set<std::uint32_t> added_;                // here, and so newer than the file's
    Clock::time_point written_{};
    Clock::duration writing_{};  // that the last one took
};

/// Where the record of the frames of `image` lies: "turn-frames.json" of turn.png.
std::string frame_record_file(const std::string& image);

}  // namespace raya
