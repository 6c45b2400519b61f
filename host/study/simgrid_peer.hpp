// The same history by SimGrid, another simulator: what tools/simgrid's program simgrid_replay tells, where it lies
// beside the program that runs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "host/torus/async_machine.hpp"

namespace raya {

struct SimgridAnswer {
    double finish_ms = 0;
    std::uint64_t delivered = 0;
};

/// Reads what simgrid_replay prints. PeerFailure where it is nothing of the kind.
SimgridAnswer simgrid_answer(const std::string& printed);

/// Runs the program once; platform and replay lie in a folder for temporary files meanwhile. PeerFailure;
/// UserError where their files cannot be written.
SimgridAnswer ask_simgrid(const std::filesystem::path& program, const raya_torus& torus, const History& history,
                          const AsyncMachine& machine);

}  // namespace raya
