#include "host/study/peer.hpp"

#include <filesystem>
#include <system_error>

#include "host/base/program.hpp"

namespace raya {
namespace {

ProgramRun run_of(const std::vector<std::string>& arguments, const std::string& input) {
    try {
        return run_program(arguments, input);
    } catch (const std::system_error& error) {
        throw PeerFailure(error.what());
    }
}

}  // namespace

std::string peer_output(const std::vector<std::string>& arguments, const std::string& input) {
    const ProgramRun run = run_of(arguments, input);
    if (run.succeeded()) return run.out;
    const std::string name = std::filesystem::path(arguments.front()).filename().string() + ": ";
    if (run.not_started != 0) throw PeerFailure(name + std::generic_category().message(run.not_started));
    const std::string words = last_line(run.err);
    throw PeerFailure(words.empty() ? name + ending_text(run.status) : words);
}

}  // namespace raya
