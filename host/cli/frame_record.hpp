// The record of a sequence's rendered frames. An interrupted sequence continues after the last recorded frame. A
// changed sequence renders only the frames whose settings or files have changed.
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

/// The record's entry of a rendered frame.
struct FrameEntry {
    std::uint32_t number = 0;
    std::string settings;                                    // hash of the settings that determine the pixels
    std::string pixels;                                      // pixel_hash() of the image
    double imbalance = 0, speed_up = 0;                      // of the loads of the modelled machine
    std::vector<std::pair<std::string, std::string>> files;  // [path relative to the record, bytes_hash()]
};

/// The entries of the rendered frames, and their file.
class FrameRecord {
  public:
    /// Reads `file` if it exists. Throws UserError if the file is not a record.
    explicit FrameRecord(std::filesystem::path file);

    /// Returns the entry of frame `number` if it was rendered with these settings and if `files` still have the
    /// recorded hashes; otherwise null.
    const FrameEntry* find(std::uint32_t number, const std::string& settings,
                           const std::vector<std::string>& files) const;

    /// Adds or replaces the entry of a frame whose `files` have been written, and fills in entry.files. Writes the
    /// record if the last write ended at least 20 times its duration ago, so that writes take at most 5 % of the time.
    const FrameEntry& add(FrameEntry entry, const std::vector<std::string>& files);

    /// Merges the frames that this object added with the frames that other processes have written to the file, and
    /// writes the file. Locks the file's folder meanwhile.
    void write();

  private:
    void read();
    std::string name_of(const std::string& file) const;  // returns the path relative to the record

    std::filesystem::path file_;
    std::map<std::uint32_t, FrameEntry> entries_;  // key: number of the frame
    std::set<std::uint32_t> added_;                // numbers of the frames that this object added
    Clock::time_point last_write_{};               // end of the last write
    Clock::duration write_duration_{};             // duration of the last write
};

/// Returns the path of the record for `image`: "turn-frames.json" for "turn.png".
std::string frame_record_file(const std::string& image);

}  // namespace raya
