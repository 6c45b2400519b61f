#include "host/ranks/mpirun.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "host/base/module.hpp"
#include "host/base/program.hpp"
#include "host/ranks/mpi_module.hpp"

namespace raya {
namespace {

constexpr const char* kVariable = "RAYA_MPIRUN";

ProgramRun run_of(const std::vector<std::string>& command) {
    try {
        return run_program(command);
    } catch (const std::system_error& error) {
        throw RanksFailure(error.what());
    }
}

// Ranks are bound to no processor, unless words of the user's own say so: PoCL's threads take what is free.
std::vector<std::string> words_of(const char* text) {
    std::istringstream words(text != nullptr ? text : "mpirun --bind-to none");
    std::vector<std::string> all;
    for (std::string word; words >> word;) all.push_back(word);
    if (all.empty())
        throw UserError(fmt::format("{}: must name a launcher, as mpirun --hostfile hosts; or unset it", kVariable));
    return all;
}

}  // namespace

Mpirun::Mpirun(const char* words, std::string program) : words_(words_of(words)), program_(std::move(program)) {}

Mpirun Mpirun::of_this_program() {
    return {std::getenv(kVariable), std::filesystem::read_symlink("/proc/self/exe").string()};
}

std::string Mpirun::lack() const {
    try {
        module_function(kMpiModule, kOpenMpi);
    } catch (const ModuleError& error) {
        return fmt::format(
            "this raya cannot load its MPI part: {}; remedy: install libopenmpi-dev and openmpi-bin, or libmpich-dev "
            "and mpich, and build again",
            error.what());
    }
    const ProgramRun run = run_of({words_.front(), "--version"});
    if (run.not_started == 0) return "";
    return fmt::format(
        "cannot start {}: {}; remedy: install openmpi-bin or mpich, of the MPI that raya was built with, or name "
        "another launcher in {}",
        words_.front(), std::generic_category().message(run.not_started), kVariable);
}

std::vector<std::string> Mpirun::command(std::uint32_t ranks, std::optional<std::uint32_t> threads,
                                         const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = {"env", "OMPI_MCA_rmaps_base_oversubscribe=1"};
    if (::geteuid() == 0) all.insert(all.end(), {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"});
    all.insert(all.end(), words_.begin(), words_.end());
    all.insert(all.end(), {"-n", std::to_string(ranks)});
    if (threads) all.insert(all.end(), {"env", fmt::format("POCL_MAX_PTHREAD_COUNT={}", *threads)});
    all.push_back(program_);
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

std::string Mpirun::run(std::uint32_t ranks, std::optional<std::uint32_t> threads,
                        const std::vector<std::string>& arguments) const {
    const ProgramRun run = run_of(command(ranks, threads, arguments));
    if (run.succeeded()) return run.out;
    std::string words = telling_line(run.err);
    if (words.empty())
        words = run.not_started != 0 ? std::generic_category().message(run.not_started) : ending_text(run.status);
    throw RanksFailure(fmt::format("{} {}: {}", ranks, ranks == 1 ? "rank" : "ranks", words));
}

std::string telling_line(const std::string& said) {
    const std::string own = "raya: ";
    std::istringstream lines(said);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(own) && !line.starts_with(own + "warning: ") && !line.starts_with(own + "compiling "))
            return line.substr(own.size());
    return last_line(said);
}

}  // namespace raya
