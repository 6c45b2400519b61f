// The bus: host to all PEs (broadcast) and all PEs to the host (gather), as counted, labelled buffer transfers.
#pragma once
#include <cstdint>
#include <span>

#include "host/cl/commands.hpp"
#include "host/machine/communication.hpp"

namespace raya {

class Bus {
  public:
    Bus(Session& session, Communication& counted) : session_(session), counted_(counted) {}

    /// The same words to every PE. `to` is what all PEs take into their memories when they start.
    void broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words) {
        session_.write("bus.broadcast", to, words);
        counted_.broadcasts += 1;
        counted_.broadcast_words += words.size();
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
