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
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxIntervalS = 86'400;
constexpr double kMaxSaveFraction = 0.05;          // maximum fraction of the run time that goes into saving
constexpr double kMinBandS = 0.05, kMaxBandS = 2;  // bounds on a band's target duration, seconds

bool is_checkpoint(const std::string& file) {
    std::string first_bytes(kStateMagic.size(), '\0');
    return fs::is_regular_file(file) && std::ifstream(file).read(first_bytes.data(), std::ssize(first_bytes)) &&
           first_bytes == kStateMagic;
}

}  // namespace

void add_checkpoint_options(CLI::App& command, CheckpointOptions& options) {
    const OptionGroup group(command, kFiles);
    add_file(command, FileUse::kWritten, "--checkpoint", options.file, "FILE.rst",
             "Save the progress of a long render to this file, for --resume; the file is removed when the render is "
             "complete. The image and its hash do not change; the number of MPI ranks may",
             "Save the progress of a long render, for --resume");
    command.add_flag("--resume", options.resume,
                     "Continue the same render from the file of --checkpoint; start anew if this file does not exist");
    add_value(
        command, "--checkpoint-every", options.every_s,
        "Minimum seconds between two checkpoints, 0..86400; raya waits longer if saving would take over 5 % of the "
        "time; 0: a checkpoint after every band of pixels, or in every superstep")
        ->type_name("SECONDS")
        ->capture_default_str();
}

void check_checkpoint_options(const CLI::App& command, const CheckpointOptions& options) {
    if (options.file.empty()) {
        for (const char* option : {"--resume", "--checkpoint-every"})
            if (command.count(option) > 0) throw UserError(fmt::format("{} requires --checkpoint FILE.rst", option));
        return;
    }
    if (is_standard_stream(options.file))
        throw UserError(
            "--checkpoint -: raya rewrites the file repeatedly, which is not possible on stdout; name a file");
    if (!(options.every_s >= 0 && options.every_s <= kMaxIntervalS))
        throw UserError(fmt::format("--checkpoint-every {}: must be 0..{} seconds", options.every_s, kMaxIntervalS));
    if (!fs::exists(options.file)) return;
    if (!is_checkpoint(options.file))
        throw UserError(
            fmt::format("--checkpoint {}: the file exists and is not a checkpoint; name another file", options.file));
    if (!options.resume)
        throw UserError(
            fmt::format("--checkpoint {}: the file exists and holds a checkpoint; add --resume to continue from it, or "
                        "name another file",
                        options.file));
}

CheckpointFile::CheckpointFile(const CheckpointOptions& options) : options_(options) {
    callbacks_.band_s = std::clamp(options.every_s / 4, kMinBandS, kMaxBandS);
    callbacks_.due = [this] { return due(); };
    callbacks_.save = [this](const std::string& bytes) { save(bytes); };
    if (options.resume) callbacks_.resume = [this](const auto& read) { load(read); };
}

bool CheckpointFile::due() {
    const double elapsed_s = seconds_since(last_save_end_);
    due_at_ = Clock::now();
    return elapsed_s >=
           std::max(options_.every_s, options_.every_s > 0 ? last_save_duration_s_ / kMaxSaveFraction : 0.0);
}

void CheckpointFile::save(const std::string& bytes) {
    write_whole_file(options_.file, bytes);
    last_save_end_ = Clock::now();
    last_save_duration_s_ = std::chrono::duration<double>(last_save_end_ - due_at_).count();
}

void CheckpointFile::load(const std::function<RenderedPart(std::string_view bytes)>& read) const {
    if (!fs::exists(options_.file)) return;
    try {
        const RenderedPart part = read(read_file(options_.file));
        if (!is_quiet())
            print_log(fmt::format("raya: {}: continuing at {:.1f} %; the runs so far took {:.1f} s\n", options_.file,
                                  100 * part.fraction, part.seconds));
    } catch (const UnreadableFile& why) {
        throw UserError(fmt::format("--resume: {}: {}", options_.file, why.what()));
    } catch (const UserError& why) {
        throw UserError(fmt::format("--resume: {}: {}; remove the file to start anew", options_.file, why.what()));
    }
}

void remove_checkpoint(const CheckpointOptions& options) {
    std::error_code error;  // ignored, because the file may not exist
    if (!options.file.empty()) fs::remove(options.file, error);
}

}  // namespace raya
