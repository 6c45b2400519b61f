#include "host/cli/frame_record.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>

#include "host/base/clock.hpp"
#include "host/base/encoding.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "raya frames";  // member "kind" of a record

std::optional<std::string> hash_of_file(const fs::path& file) try {
    return bytes_hash(read_file(file));
} catch (const UnreadableFile&) {
    return {};
}

Json json_of(const FrameEntry& entry) {
    Json files = Json::array();
    for (const auto& [name, hash] : entry.files) files.push_back({{"name", name}, {"hash", hash}});
    return {{"number", entry.number},       {"settings", entry.settings}, {"pixels", entry.pixels},
            {"imbalance", entry.imbalance}, {"speed_up", entry.speed_up}, {"files", files}};
}

FrameEntry entry_of(const Json& json) {
    FrameEntry entry{static_cast<std::uint32_t>(json.at("number").integer(UINT32_MAX)),
                     json.at("settings").text(),
                     json.at("pixels").text(),
                     json.at("imbalance").number(),
                     json.at("speed_up").number(),
                     {}};
    for (const Json& file : json.at("files").elements())
        entry.files.emplace_back(file.at("name").text(), file.at("hash").text());
    return entry;
}

std::map<std::uint32_t, FrameEntry> entries_of(const Json& record) {
    if (record.at("kind").text() != kKind) throw JsonError("not a record of frames");
    std::map<std::uint32_t, FrameEntry> entries;
    for (const Json& json : record.at("frames").elements()) {
        FrameEntry frame = entry_of(json);
        entries[frame.number] = std::move(frame);
    }
    return entries;
}

/// Locks the folder of a file for the object's lifetime, if the file system supports locks. Creates no lock file.
class FolderLock {
  public:
    explicit FolderLock(const fs::path& file)
        : folder_(::open(fs::absolute(file).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        int lock_result = 0;
        while ((lock_result = ::flock(folder_, LOCK_EX)) != 0 && errno == EINTR) continue;
        if (lock_result != 0) check_lock_error(file);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    ~FolderLock() { ::close(folder_); }

  private:
    void check_lock_error(const fs::path& file) const {
        const int error = errno;
        if (error == ENOLCK || error == EOPNOTSUPP || error == ENOSYS || error == EINVAL) return;
        if (folder_ >= 0) ::close(folder_);
        throw UserError(
            fmt::format("cannot lock the folder of '{}': {}", file.string(), std::generic_category().message(error)));
    }

    int folder_;
};

}  // namespace

FrameRecord::FrameRecord(fs::path file) : file_(std::move(file)) { read(); }

void FrameRecord::read() {
    if (!fs::exists(file_)) return;
    const JsonSource source{file_.string(),
                            "move this file, or change -o: raya needs this name for the record of the frames"};
    std::map<std::uint32_t, FrameEntry> entries = read_json(json_file_text(file_, source), source, entries_of);
    for (const std::uint32_t number : added_) entries.insert_or_assign(number, entries_.at(number));
    entries_ = std::move(entries);
}

const FrameEntry* FrameRecord::find(std::uint32_t number, const std::string& settings,
                                    const std::vector<std::string>& files) const {
    const auto found = entries_.find(number);
    if (found == entries_.end()) return nullptr;
    const FrameEntry& entry = found->second;
    if (entry.settings != settings || entry.files.size() != files.size()) return nullptr;
    const bool unchanged = std::ranges::all_of(files, [&](const std::string& file) {
        const auto recorded =
            std::ranges::find(entry.files, name_of(file), &std::pair<std::string, std::string>::first);
        return recorded != entry.files.end() && hash_of_file(file) == recorded->second;
    });
    return unchanged ? &entry : nullptr;
}

const FrameEntry& FrameRecord::add(FrameEntry entry, const std::vector<std::string>& files) {
    for (const std::string& file : files) entry.files.emplace_back(name_of(file), bytes_hash(read_file(file)));
    const std::uint32_t number = entry.number;
    entries_.insert_or_assign(number, std::move(entry));
    added_.insert(number);
    if (Clock::now() - last_write_ >= 20 * write_duration_) write();
    return entries_.at(number);
}

std::string FrameRecord::name_of(const std::string& file) const {
    return fs::absolute(file).lexically_normal().lexically_proximate(
        fs::absolute(file_).parent_path().lexically_normal());
}

void FrameRecord::write() {
    const Clock::time_point start = Clock::now();
    const FolderLock lock(file_);
    read();
    Json frames = Json::array();
    for (const auto& [number, entry] : entries_) frames.push_back(json_of(entry));
    write_whole_file(file_, Json{{"kind", kKind}, {"raya", raya_version()}, {"frames", frames}}.dump(2) + "\n");
    last_write_ = Clock::now();
    write_duration_ = last_write_ - start;
}

std::string frame_record_file(const std::string& image) {
    const fs::path path = image;
    return (path.parent_path() / (path.stem().string() + "-frames.json")).string();
}

}  // namespace raya
