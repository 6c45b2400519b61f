// The record of a sequence's rendered frames: an interrupted sequence continues, and frames with changed settings are
// rendered again.
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

/// A rendered frame.
struct FrameEntry {
    std::uint32_t number = 0;
    std::string settings;                                    // a hash of everything that determines the frame
    std::string pixels;                                      // pixel_hash() of the image
    double imbalance = 0, speed_up = 0;                      // of the modelled loads
    std::vector<std::pair<std::string, std::string>> files;  // path relative to the record's folder; bytes_hash()
};

class FrameRecord {
  public:
    /// Reads `file` if it exists. UserError if it is not a record.
    explicit FrameRecord(std::filesystem::path file);

    /// The entry of a frame that was rendered with these settings and whose `files` are unchanged; else null.
    const FrameEntry* find(std::uint32_t number, const std::string& settings,
                           const std::vector<std::string>& files) const;

    /// Adds or replaces a frame whose `files` have been written; fills in entry.files. Writes the record, unless that
    /// would take over a twentieth of the time; then a later call or write() does.
    const FrameEntry& add(FrameEntry entry, const std::vector<std::string>& files);

    /// Merges the frames added here with those that other processes have written, and writes the record under a lock.
    void write();

  private:
    void read();
    std::string name_of(const std::string& file) const;

    std::filesystem::path file_;
    std::map<std::uint32_t, FrameEntry> entries_;  // by their numbers
    std::set<std::uint32_t> added_;                // by this process; newer than the file's entries
    Clock::time_point written_{};
    Clock::duration writing_{};  // duration of the last write
};

/// The path of the record for `image`: "turn-frames.json" for turn.png.
std::string frame_record_file(const std::string& image);

}  // namespace raya
