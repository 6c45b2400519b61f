// The bus, as counted, labelled buffer transfers: host to all PEs (broadcast), all PEs to the host (gather), one PE to
// one other, and one PE to all (Kohata & Ito 1993, section on the array). It carries one transfer at a time.
#pragma once
#include <cstdint>
#include <span>

#include "host/cl/commands.hpp"
#include "host/model/communication.hpp"
#include "host/ring/pe_segment.hpp"

namespace raya {

/// Where words of one PE lie in a buffer that holds `rows` rows of `pitch` words of each: from word `offset` of each of
/// its rows on.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0, rows = 1;
};

/// PEs are numbers of the whole ring. Of several ranks all make the same transfers, `counted` is of all of them, and a
/// buffer has the PEs of the rank's own segment.
class Bus {
  public:
    Bus(Session& session, Communication& counted, std::uint32_t pes, Ranks& ranks = Ranks::alone())
        : session_(session), counted_(counted), ranks_(ranks), pes_(pes), here_(own_segment(pes, ranks)) {}

    /// The same words to every PE. `to` is what all PEs take into their memories when they start.
    void broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words);

    /// `words` of each row of one PE to another, between buffers that are not the same and have as many rows.
    void send(const Buffer<float>& own, PeWords from, Buffer<float>& blocks, PeWords to, std::size_t words);

    /// `words` of each row of one PE to every other. `heard` is what all PEs listen to: it lies on each device once,
    /// the words of every PE of the ring that spoke in its place.
    void broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words);

    /// All PEs hand over what their memories hold: one gather of the machine, in one part or more.
    void begin_gather() { counted_.gathers += 1; }

    /// A part of the blocks of all PEs to the host; to that of their rank, where there are several. `words` of it are
    /// pixels, those of all PEs; the rest is empty.
    void gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words);

  private:
    /// Of this rank's PEs, or of all of them: between buffers, and to and from the host, [row][words].
    void copy(const char* label, const Buffer<float>& own, const PeWords& from, Buffer<float>& blocks,
              const PeWords& to, std::size_t words, std::size_t first_of_blocks);
    std::vector<float> read(const char* label, const Buffer<float>& own, const PeWords& from, std::size_t words);
    void write(const char* label, Buffer<float>& blocks, const PeWords& to, std::span<const float> words,
               std::size_t first_of_blocks);

    Session& session_;
    Communication& counted_;
    Ranks& ranks_;
    std::uint32_t pes_;
    PeSegment here_;
};

}  // namespace raya
