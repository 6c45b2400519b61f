// The bus, as counted, labelled buffer transfers: host to all PEs (broadcast), all PEs to the host (gather), one PE to
// one other, and one PE to all (Kohata & Ito 1993, section on the array). It carries one transfer at a time.
#pragma once
#include <cstdint>
#include <span>

#include "host/cl/commands.hpp"
#include "host/machine/communication.hpp"

namespace raya {

/// Where words of one PE lie in a buffer that holds `pitch` words of each: from word `offset` of its own on.
struct PeWords {
    std::size_t pe = 0, pitch = 0, offset = 0;

    std::size_t at() const { return pe * pitch + offset; }
};

class Bus {
  public:
    Bus(Session& session, Communication& counted) : session_(session), counted_(counted) {}

    /// The same words to every PE. `to` is what all PEs take into their memories when they start.
    void broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words) {
        session_.write("bus.broadcast", to, words);
        counted_.broadcasts += 1;
        counted_.broadcast_words += words.size();
    }

    /// `words` of one PE to another, between buffers that are not the same.
    void send(const Buffer<float>& own, PeWords from, Buffer<float>& blocks, PeWords to, std::size_t words) {
        session_.copy("bus.send", own, from.at(), blocks, to.at(), words);
        counted_.transfers += 1;
        counted_.transfer_words += words;
    }

    /// `words` of one PE to every other. `heard` is what all PEs listen to: it lies on the device once, the words of
    /// each PE that spoke in its place.
    void broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words) {
        session_.copy("bus.broadcast_from", own, from.at(), heard, to.at(), words);
        counted_.pe_broadcasts += 1;
        counted_.pe_broadcast_words += words;
    }

    /// All PEs hand over what their memories hold: one gather of the machine, in one part or more.
    void begin_gather() { counted_.gathers += 1; }

    /// A part of the blocks of all PEs to the host. `words` of it are pixels; the rest is empty.
    void gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words) {
        session_.read("bus.gather", blocks, to);
        counted_.gather_words += words;
    }

  private:
    Session& session_;
    Communication& counted_;
};

}  // namespace raya
