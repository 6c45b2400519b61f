// Words on their way: bus, ring and links, and the copies that they are made of, each against a model on the host.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/verify/verdict.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Words that are broadcast, and others that are gathered.
Verdict check_bus(Session& session);

/// Blocks of so many words from every PE to another one, at five distances, and from each PE to all.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words);

/// 12 rotations, in both directions, of P blocks of so many words.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words);

/// Some nodes' outboxes filled, one exchange, all inboxes compared, and which boxes are said to have been sent.
/// `every`: a box in so many has packets. By the kernel that `kernels` builds; without them by copies.
Verdict check_links(Session& session, const raya_torus& torus, std::uint32_t every, Kernels* kernels = nullptr);

/// `count` words of each of `blocks` blocks, from one pitch to another.
struct BlockCopy {
    Session::Blocks from, to;
    std::size_t count, blocks;
};

/// Words below this number are copied to words below it.
inline constexpr std::size_t kCopiedWords = 4096;

/// Copies within kCopiedWords; all other words stay as they were.
Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies);

}  // namespace raya
