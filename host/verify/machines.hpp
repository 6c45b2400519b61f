// Checks of transfers over the bus, the ring and links, and of the buffer copies that implement them. A model on the
// host computes the expected contents.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/verify/verdict.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Checks transfers of blocks over the bus; a block has 3 rows of `words` words. For each of five distances d, PE i
/// receives the block of PE (i + d) mod `pes`. Then each PE in turn broadcasts its block to all PEs.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words);

/// Checks 12 rotations (circular shifts over the ring) of `pes` blocks of 3 rows of `words` words, in both directions.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words);

/// A copy of blocks between two buffers in which the blocks have different layouts.
struct BlockCopy {
    Session::Blocks from, to;         // layouts in source and destination
    std::size_t block_words, blocks;  // words to copy from the start of each block; number of blocks
};

/// Size of each of the two buffers of check_copies(), in words.
inline constexpr std::size_t kCopiedWords = 4096;

/// Checks that each copy is correct and does not change the other words of the destination.
Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies);

}  // namespace raya
