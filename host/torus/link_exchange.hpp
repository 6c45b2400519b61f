// Links of the torus. They transfer packets from the outboxes of nodes to the inboxes of neighbouring nodes: within a
// device by a kernel, between ranks by messages.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/array/checkpoints.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/ranks/transport.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

using ExchangeKernel = DescribedKernel<"torus/exchange.cl", "exchange", const Buffer<std::uint32_t>&, Uint<"nodes">,
                                       Uint<"inboxes_of_link">, Uint<"capacity">, Uint<"packet_words">,
                                       Uint<"outbox_status">, Uint<"inbox_status">, const Buffer<std::uint32_t>&,
                                       Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&>;

/// Mailboxes of one class of packets (rays or returns), and their transfers over all links.
class LinkExchange {
  public:
    /// Class of packets that one LinkExchange transfers, and number of words that the model charges for them.
    struct PacketClass {
        std::string label;            // prefix of command labels
        std::uint32_t packet_words;   // number of words in a packet
        std::uint32_t outbox_status;  // first of RAYA_LINKS status words: numbers of packets in the outboxes
        std::uint32_t inbox_status;   // first of RAYA_LINKS status words: numbers of packets in the inboxes
        std::uint32_t charged_words = packet_words;        // number of words charged for each message
        std::optional<std::uint32_t> charged_status = {};  // status word: number of charged packets; empty: all packets
        int tag = 0;                                       // tag of messages between ranks
    };

    /// Allocates mailboxes of `capacity` packets for every link of this rank's nodes (kernels/shared/traffic.h).
    /// `group_size`: number of work-items that copy a mailbox. `status`: device buffer with the same status words that
    /// exchange() receives; must outlive this object.
    LinkExchange(Session& session, const NodeDistribution& distribution, std::uint32_t capacity,
                 const PacketClass& packet_class, const ExchangeKernel& kernel, std::uint32_t group_size,
                 Buffer<std::uint32_t>& status);

    /// Empties the mailboxes and resets the counters.
    void clear();

    /// For each link with both ends on this device, transfers all packets of the outbox if the inbox is empty, in one
    /// launch, labelled PacketClass::label. Adds the number of words charged for each link to `words`, [node][link].
    /// `status`, `words` and messages() cover all nodes of all ranks.
    void exchange(const NodeStatus& status, std::vector<std::uint64_t>& words);

    /// Transfers between ranks, in the same superstep as an exchange(). begin_transfers() reads the packets and appends
    /// the messages to `out` and `in`. After the caller has waited for the messages, write_incoming() writes the
    /// received packets into the inboxes.
    void begin_transfers(const NodeStatus& status, std::vector<OutgoingMessage>& out, std::vector<IncomingMessage>& in);
    void write_incoming();

    Buffer<std::uint32_t>& outboxes() { return outboxes_; }
    Buffer<std::uint32_t>& inboxes() { return inboxes_; }
    /// [link][slot]: 1 if the outbox was transferred.
    const Buffer<std::uint32_t>& sent_flags() const { return flag_buffer_; }

    /// [node][RAYA_LINKS]: number of charged packets since clear(), for the nodes of all ranks.
    const std::vector<std::uint64_t>& messages() const { return messages_; }

    /// Numbers of packets that this rank's nodes have sent and received since clear(), without those before a resume.
    std::uint64_t sent_packets() const { return sent_packets_; }
    std::uint64_t received_packets() const { return received_packets_; }

    /// Saves or restores counts and packets of the mailboxes. `status`: that of all nodes. Restore after clear().
    void visit_state(RenderState& state, const NodeStatus& status);

    /// Calls `visit` with the node and the head of every packet that was put into an outbox of
    /// this rank since the last call of visit_new_packets().
    void visit_new_packets(const NodeStatus& status,
                           const std::function<void(std::uint32_t node, const raya_head& packet)>& visit);

  private:
    bool transfers(const NodeStatus& status, std::uint32_t link, std::uint32_t sender) const;

    /// Message between this rank and another rank: some outboxes of one link direction.
    struct LinkMessage {
        // (node of the outbox, number of packets in it), in ascending order of the nodes
        std::vector<std::pair<std::uint32_t, std::uint32_t>> boxes;
        std::size_t words = 0;  // number of words in the message
    };
    using LinkMessages = std::map<std::pair<std::uint32_t, std::uint32_t>, LinkMessage>;  // by other rank and direction

    Session& session_;
    const NodeDistribution& distribution_;
    const raya_torus torus_;
    std::uint32_t nodes_, capacity_;  // number of nodes of this rank; capacity of a mailbox, packets
    PacketClass class_;
    Buffer<std::uint32_t> outboxes_, inboxes_, flag_buffer_;
    ExchangeKernel kernel_;
    std::uint32_t group_size_;
    Buffer<std::uint32_t>& status_;
    Buffer<std::uint32_t> end_slots_;        // [link][slot]: slot of the node at the link's end, or RAYA_NO_SLOT
    std::vector<std::uint32_t> sent_flags_;  // contents of flag_buffer_ after an exchange()
    std::vector<std::uint32_t> visited_;     // [link][slot]: number of packets in the outbox already visited
    std::vector<std::uint64_t> messages_;
    std::uint64_t sent_packets_ = 0, received_packets_ = 0;
    LinkMessages outgoing_, incoming_;
    std::optional<Readback<std::uint32_t>> outgoing_words_;  // words of the messages outgoing_, concatenated
    std::vector<std::uint32_t> incoming_words_;              // words of the messages incoming_, concatenated
    std::size_t box_words(std::uint32_t packets) const { return std::size_t{1 + packets} * class_.packet_words; }
    std::size_t outbox_at(std::uint32_t link, std::uint32_t slot) const {
        return raya_box_at(link, nodes_, slot, capacity_, class_.packet_words);
    }
    std::size_t inbox_at(std::uint32_t link, std::uint32_t inbox) const {
        return raya_box_at(link, distribution_.inboxes(), inbox, capacity_, class_.packet_words);
    }
};

}  // namespace raya
