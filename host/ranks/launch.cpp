#include "host/ranks/launch.hpp"

#include <fmt/core.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "host/base/module.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/ranks/transport.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

constexpr double kDefaultTimeoutS = 600;  // time limit of waits for other ranks; RAYA_RANK_TIMEOUT overrides it

std::optional<std::uint32_t> number_in(const char* text) {
    std::uint32_t value = 0;
    if (text == nullptr || *text == '\0') return {};
    const char* end = text + std::strlen(text);
    const auto [stop, error] = std::from_chars(text, end, value);
    return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

double rank_timeout_s() {
    const char* text = std::getenv("RAYA_RANK_TIMEOUT");
    if (text == nullptr) return kDefaultTimeoutS;
    const std::optional<std::uint32_t> seconds = number_in(text);
    if (!seconds || *seconds == 0)
        throw UserError(fmt::format("RAYA_RANK_TIMEOUT={}: must be a whole number of seconds, 1 or more", text));
    return *seconds;
}

// The deadline is necessary: MPI_Init_thread may block forever if another process ends before it calls
// MPI_Init_thread.
std::unique_ptr<Transport> open_transport(const Launch& launch) {
    const double limit_s = rank_timeout_s();
    const std::uint32_t count = launch.count.value_or(0);
    try {
        auto* const open = reinterpret_cast<OpenMpi*>(module_function(kMpiModule, kOpenMpi));
        const std::string text = fmt::format(
            "raya: rank 0 has waited {:g} s for all of {} ranks to start; remedy: look for a process that hangs or has "
            "ended, or raise the limit with RAYA_RANK_TIMEOUT=SECONDS\n",
            limit_s, count);
        const Deadline deadline(limit_s, launch.rank == 0 ? text : "", kExitDeviceError);
        return std::unique_ptr<Transport>(open(limit_s));
    } catch (const ModuleError& error) {
        throw UserError(
            fmt::format("started as one of {} processes, but raya cannot load its MPI module: {}; remedy: install "
                        "libopenmpi-dev or libmpich-dev and build again, or start raya without mpirun",
                        count, error.what()));
    }
}

std::uint32_t usable_cores() {
    cpu_set_t mask;
    CPU_ZERO(&mask);
    return ::sched_getaffinity(0, sizeof mask, &mask) == 0 ? static_cast<std::uint32_t>(CPU_COUNT(&mask)) : 1;
}

void share_cores(const Ranks& ranks) {
    const auto cores = static_cast<std::uint32_t>(::sysconf(_SC_NPROCESSORS_ONLN));
    const std::uint32_t threads = threads_of_rank(usable_cores(), cores, ranks.ranks_on_host());
    ::setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 0);
}

// Returns the version of raya and a hash of the embedded files (kernels).
std::string build_text() {
    std::size_t hash = 0;
    for (const auto& [path, text] : embedded_files()) hash = 31 * hash + std::hash<std::string>()(path + text);
    return fmt::format("{} ({:016x})", name_and_version(), hash);
}

}  // namespace

std::optional<Launch> launch_from(const std::function<const char*(const char*)>& variable) {
    struct Names {
        const char *rank, *count;
    };
    // In this order: Open MPI; MPICH, Intel MPI and Slurm's pmi2; PMIx of Slurm and others.
    constexpr Names kLaunchers[] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                    {"PMI_RANK", "PMI_SIZE"},
                                    {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}};
    for (const Names& names : kLaunchers)
        if (const auto rank = number_in(variable(names.rank))) return Launch{*rank, number_in(variable(names.count))};
    return {};
}

std::optional<Launch> find_launch() {
    return launch_from([](const char* name) -> const char* { return std::getenv(name); });
}

std::unique_ptr<Ranks> open_ranks() {
    const std::optional<Launch> launch = find_launch();
    if (!launch || launch->count == 1u) return nullptr;
    auto ranks = std::make_unique<Ranks>(open_transport(*launch));
    if (launch->count && *launch->count != ranks->count()) {
        const std::string library = ranks->library();
        ranks->close(0);
        throw UserError(fmt::format(
            "started as one of {} processes, but {}, with which raya was built, has {}; remedy: use the mpirun of that "
            "MPI",
            *launch->count, library, ranks->count()));
    }
    if (!ranks->many()) {
        ranks->close(0);
        return nullptr;
    }
    share_cores(*ranks);
    return ranks;
}

void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments) {
    std::string own = build_text();
    for (const std::string& argument : arguments) own += "\n" + argument;
    std::string first = own;
    ranks.broadcast(first);
    if (own == first) return;
    const std::string version = own.substr(0, own.find('\n')), other = first.substr(0, first.find('\n'));
    throw UserError(
        version != other
            ? fmt::format("this rank is {}, rank 0 is {}; start the same program everywhere", version, other)
            : "this rank was started with other arguments than rank 0; use the same for all ranks");
}

std::uint32_t threads_of_rank(std::uint32_t usable, std::uint32_t cores, std::uint32_t ranks_of_host) {
    if (usable < cores) return std::max(1u, usable);
    return std::max(1u, cores / ranks_of_host);
}

}  // namespace raya
