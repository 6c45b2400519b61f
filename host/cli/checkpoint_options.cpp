#include "host/cli/checkpoint_options.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "host/base/clock.hpp"
#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxIntervalS = 86'400;
constexpr double kMaxSavingShare = 0.05;  // saving takes at most this share of the render's time
constexpr double kMinBandS = 0.05, kMaxBandS = 2;

bool is_checkpoint(const std::string& file) {
    std::string begin(kStateMagic.size(), '\0');
    return fs::is_regular_file(file) && std::ifstream(file).read(begin.data(), std::ssize(begin)) &&
           begin == kStateMagic;
}

}  // namespace

void add_checkpoint_options(CLI::App& command, CheckpointOptions& k) {
    const OptionGroup group(command, "Checkpoints");
    add_file(command, FileUse::kWritten, "--checkpoint", k.file, "FILE.rst",
             "Save the progress of a long render to this file, for --resume; the file is removed when the render is "
             "complete. For ring machines and one process; the image and its hash do not change");
    command.add_flag("--resume", k.resume,
                     "Continue the same render from the file of --checkpoint; start anew if there is no file");
    add_value(
        command, "--checkpoint-every", k.every_s,
        "Minimum seconds between two checkpoints, 0..86400; more if saving takes over 5 % of the time; 0: after every "
        "band of pixels")
        ->type_name("SECONDS")
        ->capture_default_str();
}

void check_checkpoint_options(const CLI::App& command, const CheckpointOptions& k) {
    if (k.file.empty()) {
        for (const char* option : {"--resume", "--checkpoint-every"})
            if (command.count(option) > 0) throw UserError(fmt::format("{} requires --checkpoint FILE.rst", option));
        return;
    }
    if (is_standard_stream(k.file))
        throw UserError("--checkpoint -: the file is rewritten repeatedly, not possible on stdout; name a file");
    if (!(k.every_s >= 0 && k.every_s <= kMaxIntervalS))
        throw UserError(fmt::format("--checkpoint-every {}: must be 0..{} seconds", k.every_s, kMaxIntervalS));
    if (!fs::exists(k.file)) return;
    if (!is_checkpoint(k.file))
        throw UserError(
            fmt::format("--checkpoint {}: the file exists and is not a checkpoint; name another file", k.file));
    if (!k.resume)
        throw UserError(
            fmt::format("--checkpoint {}: the file exists and holds a checkpoint; add --resume to continue from it, or "
                        "name another file",
                        k.file));
}

CheckpointFile::CheckpointFile(const CheckpointOptions& options) : options_(options) {
    hooks_.band_s = std::clamp(options.every_s / 4, kMinBandS, kMaxBandS);
    hooks_.due = [this] { return due(); };
    hooks_.save = [this](const RingState& state, const StateSettings& settings) { save(state, settings); };
    hooks_.resume = [this](const StateSettings& settings, const RingState& shape) { return load(settings, shape); };
}

bool CheckpointFile::due() const {
    const double since = seconds_since(saved_);
    return since >= std::max(options_.every_s, options_.every_s > 0 ? save_s_ / kMaxSavingShare : 0.0);
}

void CheckpointFile::save(const RingState& state, const StateSettings& settings) {
    const Clock::time_point start = Clock::now();
    write_whole_file(options_.file, state_bytes(state, settings));
    saved_ = Clock::now();
    save_s_ = std::chrono::duration<double>(saved_ - start).count();
}

std::optional<RingState> CheckpointFile::load(const StateSettings& settings, const RingState& shape) const {
    if (!options_.resume || !fs::exists(options_.file)) return {};
    try {
        const RingState state = read_state(read_file(options_.file), settings, shape);
        if (!is_quiet())
            print_log(fmt::format("raya: {}: continuing at {:.1f} %, after {:.1f} s\n", options_.file,
                                  100 * state.share, state.seconds));
        return state;
    } catch (const UnreadableFile& why) {
        throw UserError(fmt::format("--resume: {}: {}", options_.file, why.what()));
    } catch (const UserError& why) {
        throw UserError(fmt::format("--resume: {}: {}; remove the file to start anew", options_.file, why.what()));
    }
}

void CheckpointFile::remove() const {
    std::error_code error;  // ignored, because the file may not exist
    if (!options_.file.empty()) fs::remove(options_.file, error);
}

}  // namespace raya
