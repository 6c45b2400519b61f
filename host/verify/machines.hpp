// Check of the buffer copies that implement transfers.
#pragma once
#include <cstddef>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

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
