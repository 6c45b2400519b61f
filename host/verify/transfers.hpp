// Checks of transfers over the bus, the ring and links, and of the buffer copies that implement them. A model on the
// host computes the expected contents.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/verify/verdict.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Checks one broadcast and one gather over the bus.
Verdict check_bus(Session& session);

/// Checks that blocks of `words` words arrive when every PE sends one to the PE at a given distance, for five
/// distances, and when each PE in turn broadcasts one to all PEs.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words);

/// Checks 12 rotations (circular shifts over the ring) of `pes` blocks of `words` words, in both directions.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words);

/// Fills one of every `every` outboxes with packets, exchanges once, and compares all inboxes and the flags of
/// transferred outboxes. `kernels`: exchange with the kernel built from these; null: exchange with buffer copies.
Verdict check_links(Session& session, const raya_torus& torus, std::uint32_t every, Kernels* kernels = nullptr);

/// Copy of the first `count` words of each of `blocks` blocks, between two layouts of blocks with different strides.
struct BlockCopy {
    Session::Blocks from, to;
    std::size_t count, blocks;
};

/// Size of each of the two buffers of check_copies(), in words.
inline constexpr std::size_t kCopiedWords = 4096;

/// Checks each copy, and that the remaining words of the destination do not change.
Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies);

}  // namespace raya
