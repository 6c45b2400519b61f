#include "host/base/checkpoint.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>

#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::size_t kHashDigits = 32;

// Throws UserError for the first setting that differs. Hashes are last, so that a named option is reported if possible.
void check_settings(const std::map<std::string, std::string>& saved_settings, const StateSettings& settings) {
    for (const auto& [name, value] : settings) {
        if (!saved_settings.contains(name)) throw UserError(fmt::format("damaged header: '{}' is missing", name));
        const std::string& saved = saved_settings.at(name);
        if (saved == value) continue;
        if (name.starts_with("another")) throw UserError("was rendered with " + name);
        if (value == "yes" || value == "no")
            throw UserError(fmt::format("was rendered {} {}", value == "yes" ? "without" : "with", name));
        throw UserError(fmt::format("was rendered with {} {:.80}, not {}", name, saved, value));
    }
}

}  // namespace

CheckpointWriter::CheckpointWriter(const StateSettings& settings, const RenderedPart& part) : bytes_(kStateMagic) {
    Json header = {{"of", Json::object()}, {"fraction", part.fraction}, {"seconds", part.seconds}};
    for (const auto& [name, value] : settings) header["of"][name] = value;
    bytes_ += json_dump(header) + "\n";
}

void CheckpointWriter::put_numbers(std::span<const std::byte> numbers, std::size_t number_bytes) {
    const std::size_t begin = bytes_.size();
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size());
    convert_little_endian(std::as_writable_bytes(std::span(bytes_).subspan(begin)), number_bytes);
}

std::string CheckpointWriter::finish() {
    bytes_ += bytes_hash(bytes_);
    return std::move(bytes_);
}

CheckpointReader::CheckpointReader(std::string_view bytes, const StateSettings& settings) : bytes_(bytes) {
    if (!bytes.starts_with(kStateMagic)) throw UserError("not a checkpoint of this version of raya");
    if (bytes.size() < kStateMagic.size() + kHashDigits ||
        bytes_hash(bytes.substr(0, bytes.size() - kHashDigits)) != bytes.substr(bytes.size() - kHashDigits))
        throw UserError("damaged");
    bytes_ = bytes.substr(kStateMagic.size(), bytes.size() - kStateMagic.size() - kHashDigits);
    const std::size_t end = bytes_.find('\n');
    const auto saved_settings =
        read_json(std::string(bytes_.substr(0, end)), {"damaged header"}, [&](const Json& header) {
            part_ = {header.at("fraction").get<double>(), header.at("seconds").get<double>()};
            std::map<std::string, std::string> settings_of_header;
            for (const auto& [name, value] : header.at("of").items())
                settings_of_header[name] = value.get<std::string>();
            return settings_of_header;
        });
    bytes_.remove_prefix(end == std::string_view::npos ? bytes_.size() : end + 1);
    check_settings(saved_settings, settings);
}

void CheckpointReader::check_end() const {
    if (!bytes_.empty()) throw UserError("damaged");
}

std::uint64_t CheckpointReader::take_count(std::size_t value_bytes, std::optional<std::uint64_t> expected) {
    std::uint64_t count = 0;
    take_numbers(std::as_writable_bytes(std::span(&count, 1)), sizeof count);
    if (count > bytes_.size() / value_bytes || (expected && count != *expected)) throw UserError("damaged");
    return count;
}

void CheckpointReader::take_numbers(std::span<std::byte> numbers, std::size_t number_bytes) {
    if (numbers.size() > bytes_.size()) throw UserError("damaged");
    std::ranges::copy(std::as_bytes(std::span(bytes_.substr(0, numbers.size()))), numbers.begin());
    convert_little_endian(numbers, number_bytes);
    bytes_.remove_prefix(numbers.size());
}

namespace fs = std::filesystem;
namespace {

constexpr double kMaxSaveFraction = 0.05;          // maximum fraction of the run time that goes into saving
constexpr double kMinBandS = 0.05, kMaxBandS = 2;  // bounds on a band's target duration, seconds

bool is_checkpoint(const std::string& file) {
    std::string line;
    return fs::is_regular_file(file) && std::getline(std::ifstream(file), line) && line + '\n' == kStateMagic;
}

void load(const std::string& file, const std::function<RenderedPart(std::string_view bytes)>& read) {
    try {
        const RenderedPart part = read(read_file(file));
        if (!is_quiet())
            print_log(fmt::format("raya: {}: continuing at {:.1f} %; the runs so far took {:.1f} s\n", file,
                                  100 * part.fraction, part.seconds));
    } catch (const UnreadableFile& why) {
        throw UserError(fmt::format("--resume: {}: {}", file, why.what()));
    } catch (const UserError& why) {
        throw UserError(fmt::format("--resume: {}: {}; remove the file to start anew", file, why.what()));
    }
}

}  // namespace

void check_checkpoint_options(const CheckpointOptions& options) {
    if (options.file.empty()) return;
    const auto refuse = [&](const char* why) {
        throw UserError(fmt::format("--checkpoint {}: {}", options.file, why));
    };
    if (is_standard_stream(options.file)) refuse("raya rewrites the file repeatedly; name a file");
    if (!fs::exists(options.file)) return;
    if (!is_checkpoint(options.file)) refuse("the file exists and is not a checkpoint; name another file");
    if (!options.resume)
        refuse("the file exists and holds a checkpoint; add --resume to continue from it, or name another file");
}

std::unique_ptr<const Checkpointing> checkpointing_of(const CheckpointOptions& options) {
    if (options.file.empty()) return nullptr;
    struct LastSave {
        Clock::time_point due = Clock::now(), end = due;  // start and end of collecting and writing the state
    };
    auto checkpointing = std::make_unique<Checkpointing>();
    checkpointing->band_s = std::clamp(options.every_s / 4, kMinBandS, kMaxBandS);
    const auto last = std::make_shared<LastSave>();
    checkpointing->due = [last, every_s = options.every_s] {
        const std::chrono::duration<double> saving = last->end - last->due;
        const double min_s = every_s > 0 ? std::max(every_s, saving.count() / kMaxSaveFraction) : 0;
        if (seconds_since(last->end) < min_s) return false;
        last->due = Clock::now();
        return true;
    };
    checkpointing->save = [last, file = options.file](const std::string& bytes) {
        write_whole_file(file, bytes);
        last->end = Clock::now();
    };
    if (options.resume)
        checkpointing->resume = [file = options.file](const auto& read) {
            if (fs::exists(file)) load(file, read);
        };
    return checkpointing;
}

void remove_checkpoint(const CheckpointOptions& options) {
    std::error_code error;  // ignored, because the file may not exist
    if (!options.file.empty()) fs::remove(options.file, error);
}

}  // namespace raya
