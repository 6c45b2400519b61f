#include "host/cli/keep_options.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "host/base/clock.hpp"
#include "host/base/say.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestS = 86'400;      // between two states
constexpr double kShareOfKeeping = 0.05;  // of the time at most goes into writing states
constexpr double kShortestBandS = 0.05, kLongestBandS = 2;

bool is_checkpoint(const std::string& file) {
    std::string begin(kStateMagic.size(), '\0');
    return fs::is_regular_file(file) && std::ifstream(file).read(begin.data(), std::ssize(begin)) &&
           begin == kStateMagic;
}

}  // namespace

void add_keep_options(CLI::App& command, KeepOptions& k) {
    const OptionGroup group(command, "Long images");
    add_file(command, FileUse::kWritten, "--keep", k.file, "FILE.rst",
             "Keep what is done in this file while a long image is rendered, so that --resume goes on with it; the "
             "file goes when all is written. Of ring machines and one process; the picture and its hash stay");
    command.add_flag("--resume", k.resume,
                     "Go on with what --keep has kept of the same render; from the start where the file is not there");
    add_value(
        command, "--keep-every", k.every_s,
        "Seconds between two states at least, 0..86400; more where writing them takes over 5 % of the time; 0: after "
        "every band of pixels")
        ->type_name("SECONDS")
        ->capture_default_str();
}

void check_keep(const CLI::App& command, const KeepOptions& k) {
    if (k.file.empty()) {
        for (const char* option : {"--resume", "--keep-every"})
            if (command.count(option) > 0)
                throw UserError(fmt::format("{} is about a state that is kept: give --keep FILE.rst as well", option));
        return;
    }
    if (is_standard_stream(k.file))
        throw UserError("--keep -: a state is written again and again, which stdout cannot hold; name a file");
    if (!(k.every_s >= 0 && k.every_s <= kLongestS))
        throw UserError(fmt::format("--keep-every {}: must be 0..{} seconds", k.every_s, kLongestS));
    if (!fs::exists(k.file)) return;
    if (!is_checkpoint(k.file))
        throw UserError(fmt::format("--keep {}: the file exists and is not a checkpoint; name another file", k.file));
    if (!k.resume)
        throw UserError(
            fmt::format("--keep {}: the file exists and holds a checkpoint; give --resume to continue from it, or name "
                        "another file",
                        k.file));
}

StateFile::StateFile(const KeepOptions& options) : options_(options) {
    keeping_.band_s = std::clamp(options.every_s / 4, kShortestBandS, kLongestBandS);
    keeping_.due = [this] { return due(); };
    keeping_.keep = [this](const RingState& state, const StateSettings& settings) { keep(state, settings); };
    keeping_.resume = [this](const StateSettings& settings, const RingState& like) { return read(settings, like); };
}

bool StateFile::due() const {
    const double since = seconds_since(kept_);
    return since >= std::max(options_.every_s, options_.every_s > 0 ? keeping_s_ / kShareOfKeeping : 0.0);
}

void StateFile::keep(const RingState& state, const StateSettings& settings) {
    const Clock::time_point start = Clock::now();
    write_whole_file(options_.file, state_bytes(state, settings));
    kept_ = Clock::now();
    keeping_s_ = std::chrono::duration<double>(kept_ - start).count();
}

std::optional<RingState> StateFile::read(const StateSettings& settings, const RingState& like) const {
    if (!options_.resume || !fs::exists(options_.file)) return {};
    try {
        const RingState state = read_state(read_file(options_.file), settings, like);
        if (!is_quiet())
            say(fmt::format("raya: {}: goes on at {:.1f} %, after {:.1f} s\n", options_.file, 100 * state.share,
                            state.seconds));
        return state;
    } catch (const UnreadableFile& why) {
        throw UserError(fmt::format("--resume: {}: {}", options_.file, why.what()));
    } catch (const UserError& why) {
        throw UserError(fmt::format("--resume: {}: {}; remove it to begin anew", options_.file, why.what()));
    }
}

void StateFile::remove() const {
    std::error_code error;  // gone already
    if (!options_.file.empty()) fs::remove(options_.file, error);
}

}  // namespace raya
