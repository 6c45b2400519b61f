// Bus and ring of the machine (Kohata & Ito 1993, section on the array), and the distribution of PEs over ranks.
// Buffer transfers with labels model the transfers of bus and ring; raya counts them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/time_model.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/route.hpp"

namespace raya {

/// The consecutive PEs that a rank models. The sizes of segments differ by at most one PE.
struct PeSegment {
    std::uint32_t first = 0, count = 0;
};

/// Returns the segment of a rank. Requires pes >= ranks.
inline PeSegment segment_of(std::uint32_t pes, std::uint32_t ranks, std::uint32_t rank) {
    const auto begin = [&](std::uint64_t r) { return static_cast<std::uint32_t>(r * pes / ranks); };
    return {begin(rank), begin(rank + 1) - begin(rank)};
}

/// Returns the rank that models a PE.
inline std::uint32_t rank_of_pe(std::uint32_t pes, std::uint32_t ranks, std::uint64_t pe) {
    return static_cast<std::uint32_t>(((pe + 1) * ranks - 1) / pes);
}

/// Returns the segment of this rank.
inline PeSegment own_segment(std::uint32_t pes, const Ranks& ranks) {
    return segment_of(pes, ranks.count(), ranks.rank());
}

/// Part of one PE's data in a buffer with the layout [PE][rows][pitch]: the words of each row from `offset` on.
/// `pitch` and `offset` are in words.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// The bus between host and PEs. PE numbers are those of the whole ring. All ranks must make the same calls. Each rank
/// counts all transfers, but its buffers hold only the PEs of its own segment.
class Bus {
  public:
    Bus(Session& session, Communication& communication, std::uint32_t pes, Ranks& ranks = Ranks::single())
        : session_(session),
          communication_(communication),
          ranks_(ranks),
          pes_(pes),
          segment_(own_segment(pes, ranks)) {}

    /// Sends words from the host to all PEs, by writing them to the device buffer `target`. The PEs copy the words
    /// into their memories at the start of a kernel.
    void broadcast(Buffer<std::uint32_t>& target, std::span<const std::uint32_t> words);

    /// Sends `words` words of each row from one PE (`source`, in `pe_memory`) to another (`target`, in `blocks`). The
    /// buffers must be different, and source.rows must equal target.rows.
    void send(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& blocks, PeWords target, std::size_t words);

    /// Broadcasts `words` words of each row of one PE to all other PEs. Each device has one buffer `all_blocks`, with
    /// space for the words of every PE of the ring.
    void broadcast_from(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& all_blocks, PeWords target,
                        std::size_t words);

    /// Counts one gather. Several calls of gather() may read its data.
    void begin_gather() { communication_.gathers += 1; }

    /// Reads the blocks of this rank's PEs into `target`, and counts `words` words: those of the pixels in the blocks
    /// of all ranks, without padding.
    void gather(const Buffer<float>& blocks, std::span<float> target, std::uint64_t words);

  private:
    /// copy() copies between device buffers. read() and write() transfer [row][words] to and from the host.
    /// `first_block_pe`: number of the first PE whose words are in `blocks`.
    void copy(const char* label, const Buffer<float>& pe_memory, const PeWords& source, Buffer<float>& blocks,
              const PeWords& target, std::size_t words, std::size_t first_block_pe);
    std::vector<float> read(const char* label, const Buffer<float>& pe_memory, const PeWords& source,
                            std::size_t words);
    void write(const char* label, Buffer<float>& blocks, const PeWords& target, std::span<const float> words,
               std::size_t first_block_pe);

    Session& session_;
    Communication& communication_;
    Ranks& ranks_;
    std::uint32_t pes_;
    PeSegment segment_;
};

/// One block in the memory of each PE, and the rotations that move all blocks. The device needs a second buffer,
/// because source and target of a copy must not overlap. A PE of the modelled machine sends and receives word by
/// word and needs only one block.
class Ring {
  public:
    /// Allocates the blocks of this rank's segment on the device, [PE][rows][row_words], with undefined contents.
    /// `pes`: number of PEs of the whole ring. All sizes must be > 0. `communication` counts the rotations of all PEs.
    Ring(Session& session, Communication& communication, std::uint32_t pes, std::size_t rows, std::size_t row_words,
         Ranks& ranks = Ranks::single());

    /// Fills each PE's block from its own memory `pe_memory`, [PE][rows][memory_row_words]: copies the words of each
    /// row from `begin` on, at most row_words of them. `communication` excludes it: no data leaves a PE.
    void load(const Buffer<float>& pe_memory, std::size_t memory_row_words, std::size_t begin);

    /// Every PE sends its block to the next PE in the direction, with wrap-around at the end of the ring.
    void rotate(RingDirection direction);

    /// For each PE i, copies the block of PE (i + distance) mod P from `all_blocks` into the block of PE i.
    /// `all_blocks`: blocks that Bus::broadcast_from() has sent and counted, [PE of all ranks][rows][row_words].
    void take(const Buffer<float>& all_blocks, std::size_t distance);

    /// Current blocks of the PEs of this rank's segment, [PE][rows][row_words].
    Buffer<float>& blocks() { return front_; }

  private:
    void rotate_within_rank(RingDirection direction);
    void send_block(RingDirection direction);
    void receive_block(RingDirection direction);
    /// Copies `blocks` blocks. `first_source`, `first_target`: indices of the first block in each buffer.
    void move(const char* label, const Buffer<float>& source, std::size_t first_source, Buffer<float>& target,
              std::size_t first_target, std::size_t blocks);

    Session& session_;
    Communication& communication_;
    Ranks& ranks_;
    PeSegment segment_;
    std::size_t pes_, rows_, row_words_, block_words_;
    Buffer<float> front_, back_;              // current blocks; target of a rotation
    std::vector<float> outgoing_, incoming_;  // block to send to another rank; block received from another rank
};

}  // namespace raya
