// This program once more, on ranks: what `mpirun -n R raya ...` prints.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"

namespace raya {

/// The ranks could not be started, or failed; what they said, one line.
struct RanksFailure : UserError {
    using UserError::UserError;
};

/// How ranks are started. RAYA_MPIRUN is a user's own way, words with blanks between them, as "mpirun --hostfile
/// hosts"; without it "mpirun --bind-to none". Open MPI is told by variables that it may start more ranks than a host
/// has processors, and, where root starts them, that root may.
class Mpirun {
  public:
    /// `words`: RAYA_MPIRUN's, null where it is not set; `program`: what the ranks are.
    Mpirun(const char* words, std::string program);

    /// By the environment, of this program.
    static Mpirun of_this_program();

    /// What is wanting: the launcher, or MPI in this build, with the remedy; empty: nothing.
    std::string lack() const;

    /// Whole command line of `ranks` ranks of the program; `threads`: of each rank's CPU device, where they are not
    /// chosen by what a host has.
    std::vector<std::string> command(std::uint32_t ranks, std::optional<std::uint32_t> threads,
                                     const std::vector<std::string>& arguments) const;

    /// Runs it to its end and returns what it prints. RanksFailure.
    std::string run(std::uint32_t ranks, std::optional<std::uint32_t> threads,
                    const std::vector<std::string>& arguments) const;

  private:
    std::vector<std::string> words_;
    std::string program_;
};

/// Of what ranks and their launcher have said, the line that tells: raya's own, else the last.
std::string telling_line(const std::string& said);

}  // namespace raya
