// Command lines of mpirun for tests, with a fault on one rank.
#pragma once
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "tests/cli/refusals.hpp"
#include "tests/ranks/run_ranks.hpp"

namespace raya {

inline Arguments launch_arguments(const Mpi& mpi, std::uint32_t ranks, const Arguments& program_arguments) {
    Arguments arguments = {"-n", std::to_string(ranks), mpi.program};
    arguments.insert(arguments.end(), program_arguments.begin(), program_arguments.end());
    return arguments;
}

/// A shell script that runs a program. On one rank it evaluates a shell command before it runs the program.
class RankScript {
  public:
    RankScript() {
        std::ofstream(script_) << "#!/bin/sh\nonly_rank=$1; command=$2; shift 2\n"
                                  "[ \"${OMPI_COMM_WORLD_RANK:-$PMI_RANK}\" = \"$only_rank\" ] && eval \"$command\"\n"
                                  "exec \"$@\"\n";
        ::chmod(script_.c_str(), 0755);
    }

    Arguments arguments(const Mpi& mpi, std::uint32_t ranks, std::uint32_t rank, const std::string& command,
                        const Arguments& program_arguments) const {
        Arguments launched = {"-n", std::to_string(ranks), script_, std::to_string(rank), command, mpi.program};
        launched.insert(launched.end(), program_arguments.begin(), program_arguments.end());
        return launched;
    }

  private:
    ScratchFolder folder_;
    std::string script_ = folder_ / "one_rank.sh";
};

/// Returns the shell command that preloads a library of faults.
inline std::string preload_command(const std::string& library, const std::string& variable, const std::string& value) {
    return "export LD_PRELOAD=" + library + " " + variable + "='" + value + "'";
}

}  // namespace raya
