#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/parallel.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ranks/transport.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

constexpr double kDefaultTimeoutS = 600;  // time limit of each wait for other ranks, unless RAYA_RANK_TIMEOUT is set

double rank_timeout_s() {
    const std::string text = environment_value("RAYA_RANK_TIMEOUT");
    if (text.empty()) return kDefaultTimeoutS;
    const auto seconds = parsed_number<std::uint32_t>(text);
    if (!seconds || *seconds == 0)
        throw UserError(fmt::format("RAYA_RANK_TIMEOUT={}: must be a whole number of seconds, 1 or more", text));
    return *seconds;
}

// Loads raya_mpi.so and starts MPI. The deadline ends this process if MPI_Init_thread blocks forever, which may happen
// if another process ends before its own call of MPI_Init_thread.
std::unique_ptr<Transport> open_transport(const Launch& launch) {
    const double limit_s = rank_timeout_s();
    const std::string processes =
        launch.count ? std::to_string(*launch.count) : "several";  // some launchers do not set the number
    try {
        auto* const make_transport =
            reinterpret_cast<MakeMpiTransport*>(module_function(kMpiModule, kMakeMpiTransport));
        const std::string timeout_message = fmt::format(
            "raya: rank 0 has waited {:g} s for the start of {} ranks; remedy: look for a process that hangs or has "
            "ended, or raise the limit with RAYA_RANK_TIMEOUT=SECONDS\n",
            limit_s, processes);
        const std::jthread limit = deadline(limit_s, launch.rank == 0 ? timeout_message : "", kExitDeviceError);
        return std::unique_ptr<Transport>(make_transport(limit_s));
    } catch (const ModuleError& error) {
        throw UserError(
            fmt::format("started as one of {} processes, but raya cannot load its MPI module: {}; remedy: install "
                        "libopenmpi-dev or libmpich-dev and build again, or start raya without mpirun",
                        processes, error.what()));
    }
}

void limit_pocl_threads(const Ranks& ranks) {
    const auto host_cores = static_cast<std::uint32_t>(::sysconf(_SC_NPROCESSORS_ONLN));
    const std::uint32_t threads = threads_of_rank(core_count(), host_cores, ranks.ranks_on_host());
    ::setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 0);
}

// Returns text that identifies this build: the version of raya and a hash of the embedded files (kernels).
std::string build_id() {
    std::size_t hash = 0;
    for (const auto& [path, text] : embedded_files()) hash = 31 * hash + std::hash<std::string>()(path + text);
    return fmt::format("{} ({:016x})", name_and_version(), hash);
}

}  // namespace

std::optional<Launch> find_launch() {
    // Variables of rank and count. First entry: Open MPI. Second: MPICH, Intel MPI and Slurm's pmi2. Third: PMIx (Slurm
    // and others).
    constexpr std::pair<const char*, const char*> kLaunchers[] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                                                  {"PMI_RANK", "PMI_SIZE"},
                                                                  {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}};
    for (const auto& [rank_name, count_name] : kLaunchers)
        if (const auto rank = parsed_number<std::uint32_t>(environment_value(rank_name)))
            return Launch{*rank, parsed_number<std::uint32_t>(environment_value(count_name))};
    return {};
}

std::unique_ptr<Ranks> open_ranks() {
    const std::optional<Launch> launch = find_launch();
    if (!launch || launch->count == 1u) return nullptr;
    auto ranks = std::make_unique<Ranks>(open_transport(*launch));
    if (launch->count && *launch->count != ranks->count()) {
        const std::string library = ranks->library();
        ranks->close(0);
        throw UserError(
            fmt::format("started as one of {} processes, but as one of {} according to {}, with which raya was built; "
                        "remedy: use the mpirun of that MPI library",
                        *launch->count, ranks->count(), library));
    }
    if (!ranks->has_several()) {
        ranks->close(0);
        return nullptr;
    }
    limit_pocl_threads(*ranks);
    return ranks;
}

void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments) {
    std::string own_text = build_id();
    for (const std::string& argument : arguments) own_text += "\n" + argument;
    std::string rank_0_text = own_text;
    ranks.broadcast(rank_0_text);
    if (own_text == rank_0_text) return;
    const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
    const std::string own_version = first_line(own_text), rank_0_version = first_line(rank_0_text);
    throw UserError(own_version != rank_0_version
                        ? fmt::format("this rank runs {}, rank 0 runs {}; start the same program in all ranks",
                                      own_version, rank_0_version)
                        : "this rank was started with other arguments than rank 0; use the same for all ranks");
}

std::uint32_t threads_of_rank(std::uint32_t usable_cores, std::uint32_t host_cores, std::uint32_t ranks_of_host) {
    if (usable_cores < host_cores) return std::max(1u, usable_cores);
    return std::max(1u, host_cores / ranks_of_host);
}

}  // namespace raya
