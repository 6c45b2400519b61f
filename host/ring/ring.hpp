// The ring: every PE hands a block of words to its neighbour, all at once, as counted, labelled buffer copies.
#pragma once
#include <cstddef>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/machine/communication.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// One block in the memory of each PE, and the turns that move them. The device needs a second buffer, as a copy cannot
/// overlap itself; a PE of the machine sends and receives word by word and needs one.
class Ring {
  public:
    /// `pes` blocks of `block_words` words each, both > 0; what they hold at first is undefined.
    Ring(Session& session, Communication& counted, std::size_t pes, std::size_t block_words);

    /// Copies words `begin` and on of each PE's own memory, [PE][own_words], into its block: as many as fit or exist.
    /// No transfer between PEs, so it is not counted.
    void load(const Buffer<float>& own, std::size_t own_words, std::size_t begin);

    /// One rotation of all blocks, wrap-around included.
    void rotate(Turn turn);

    /// The block that each PE holds now, [PE][block_words].
    Buffer<float>& blocks() { return front_; }

  private:
    Session& session_;
    Communication& counted_;
    std::size_t pes_, block_words_;
    Buffer<float> front_, back_;
};

}  // namespace raya
