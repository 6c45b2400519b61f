// Bus and ring of the machine (Kohata & Ito 1993, section on the array).
// Buffer transfers with labels model the transfers of bus and ring; raya counts them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/array/render.hpp"
#include "host/cl/commands.hpp"
#include "host/model/t805.hpp"
#include "host/ring/mapping.hpp"

namespace raya {

/// Part of one PE's data in a buffer with the layout [PE][rows][pitch]: the words of each row from `offset` on.
/// `pitch` and `offset` are in words.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// The bus between host and PEs. PE numbers are those of the whole ring. All ranks must make the same calls. Each rank
/// counts all transfers, but its buffers hold only its own PEs.
class Bus {
  public:
    Bus(Session& session, Communication& communication, Distribution pes)
        : session_(session), communication_(communication), pes_(std::move(pes)) {}

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
    Distribution pes_;
};

/// One block in the memory of each PE, and the rotations that move all blocks. The device needs a second buffer,
/// because source and target of a copy must not overlap. A PE of the modelled machine sends and receives word by
/// word and needs only one block.
class Ring {
  public:
    /// Allocates the blocks of this rank's PEs on the device, [PE][rows][row_words], with undefined contents. All sizes
    /// must be > 0. `communication` counts the rotations of all PEs.
    Ring(Session& session, Communication& communication, Distribution pes, std::size_t rows, std::size_t row_words);

    /// Fills each PE's block from its own memory `pe_memory`, [PE][rows][memory_row_words]: copies the words of each
    /// row from `begin` on, at most row_words of them. `communication` excludes it: no data leaves a PE.
    void load(const Buffer<float>& pe_memory, std::size_t memory_row_words, std::size_t begin);

    /// Every PE sends its block to the next PE in the direction, with wrap-around at the end of the ring.
    void rotate(RingDirection direction);

    /// For each PE i, copies the block of PE (i + distance) mod P from `all_blocks` into the block of PE i.
    /// `all_blocks`: blocks that Bus::broadcast_from() has sent and counted, [PE of all ranks][rows][row_words].
    void take(const Buffer<float>& all_blocks, std::size_t distance);

    /// Current blocks of this rank's PEs, [PE][rows][row_words].
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
    Distribution pes_;  // consecutive
    std::size_t rows_, row_words_, block_words_;
    Buffer<float> front_, back_;              // current blocks; target of a rotation
    std::vector<float> outgoing_, incoming_;  // block to send to another rank; block received from another rank
};

}  // namespace raya
