// Checks of transfers: bus, ring, links, and the buffer copies that implement them, each against a model on the host.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/verify/verdict.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Checks one broadcast and one gather.
Verdict check_bus(Session& session);

/// Checks blocks of `words` words from every PE to another PE, at five distances, and from each PE to all.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words);

/// Checks 12 rotations, in both directions, of `pes` blocks of `words` words.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words);

/// Fills some outboxes, exchanges once, and compares all inboxes and the flags of sent boxes. `every`: one box in this
/// many has packets. `kernels`: exchange with the kernel that it builds; null: with copies.
Verdict check_links(Session& session, const raya_torus& torus, std::uint32_t every, Kernels* kernels = nullptr);

/// Copy of `count` words of each of `blocks` blocks, between layouts of different pitch.
struct BlockCopy {
    Session::Blocks from, to;
    std::size_t count, blocks;
};

/// Size in words of check_copies()' two buffers.
inline constexpr std::size_t kCopiedWords = 4096;

/// Checks each copy; the remaining words of the destination must not change.
Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies);

}  // namespace raya
