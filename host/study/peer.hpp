// Other people's programs that studies hold raya against: run, and judged by how they end.
#pragma once
#include <string>
#include <vector>

#include "host/error.hpp"

namespace raya {

/// The program could not be run, or failed; what it said.
struct PeerFailure : UserError {
    using UserError::UserError;
};

/// What the program prints, which reads `input`; arguments as those of run_program(). PeerFailure.
std::string peer_output(const std::vector<std::string>& arguments, const std::string& input = {});

}  // namespace raya
