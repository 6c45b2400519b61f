// Links of the torus. They transfer packets from the outboxes of nodes to the inboxes of neighbouring nodes: within a
// device by a kernel, between ranks by messages.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/array/checkpoints.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/ranks/transport.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

/// Returns the direction of a link: "+x", "-x", "+y", ...
std::string link_name(std::uint32_t link);

using ExchangeKernel = DescribedKernel<"torus/exchange.cl", "exchange", const Buffer<std::uint32_t>&, Uint<"nodes">,
                                       Uint<"inboxes_of_link">, Uint<"capacity">, Uint<"packet_words">,
                                       Uint<"outbox_status">, Uint<"inbox_status">, const Buffer<std::uint32_t>&,
                                       Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&>;

/// Counts of the links of all nodes, [node][RAYA_LINKS].
struct LinkCounts {
    std::vector<std::uint64_t> messages;  // numbers of charged packets
    std::vector<std::uint64_t> packets;   // numbers of packets, including those that are not charged
};

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
    /// `status`, `words` and counts() cover all nodes of all ranks.
    void exchange(const NodeStatus& status, std::vector<std::uint64_t>& words);

    /// Transfers between ranks, in the same superstep as an exchange(). begin_transfers() appends the messages to `out`
    /// and `in`. The caller must call wait_for_outgoing(), start the messages and wait for them. Then write_incoming()
    /// writes the received packets into the inboxes.
    void begin_transfers(const NodeStatus& status, std::vector<OutgoingMessage>& out, std::vector<IncomingMessage>& in);
    void wait_for_outgoing();
    void write_incoming();

    Buffer<std::uint32_t>& outboxes() { return outboxes_; }
    Buffer<std::uint32_t>& inboxes() { return inboxes_; }
    /// [link][slot]: 1 if the outbox was transferred.
    const Buffer<std::uint32_t>& sent_flags() const { return flag_buffer_; }

    /// Counts since clear().
    const LinkCounts& counts() const { return counts_; }

    /// Return the numbers of packets that this rank's nodes have sent and received since clear().
    std::uint64_t sent_packets() const;
    std::uint64_t received_packets() const;

    /// Saves or restores counts and packets of the mailboxes. `status`: that of all nodes. Restore after clear().
    void visit_state(RenderState& state, const NodeStatus& status);

    /// Calls `visit`, unless it is empty, with the node and the head of every packet that was put into an outbox of
    /// this rank since the last call of visit_new_packets().
    void visit_new_packets(const NodeStatus& status,
                           const std::function<void(std::uint32_t node, const raya_head& packet)>& visit);

  private:
    void count_transfers(const NodeStatus& status, std::uint32_t link, std::vector<std::uint64_t>& words);
    void launch_kernel();
    void write_sent_flags();
    bool inbox_occupied(const NodeStatus& status, std::uint32_t link, std::uint32_t sender) const;
    bool crosses_ranks(std::uint32_t link, std::uint32_t sender) const;

    /// A link between this rank and another rank, in either direction.
    struct RankLink {
        std::uint32_t link, sender, rank;  // direction; node at the start of the link; the other rank
    };

    /// Message between this rank and another rank. It contains the outboxes of one link direction.
    struct LinkMessage {
        std::uint32_t rank = 0, link = 0;    // the other rank; direction
        std::vector<std::uint32_t> senders;  // nodes whose outboxes are in the message, ascending
        std::vector<std::uint32_t> packets;  // [index in `senders`]: number of packets in the outbox
        std::size_t words = 0;               // number of words in the message
    };
    std::vector<RankLink> find_rank_links() const;
    LinkMessage& message_for(std::vector<LinkMessage>& messages, std::uint32_t rank, std::uint32_t link) const;
    void read_message(const LinkMessage& message, std::size_t first_word);

    Session& session_;
    const NodeDistribution& distribution_;
    const raya_torus torus_;
    std::uint32_t nodes_, capacity_;  // number of nodes of this rank; capacity of a mailbox, packets
    PacketClass class_;
    Buffer<std::uint32_t> outboxes_, inboxes_, flag_buffer_;
    ExchangeKernel kernel_;
    std::uint32_t group_size_;
    Buffer<std::uint32_t>& status_;
    Buffer<std::uint32_t> end_slots_;          // [link][slot]: slot of the node at the link's end, or RAYA_NO_SLOT
    std::vector<std::uint32_t> sent_flags_;    // next contents of flag_buffer_
    std::vector<std::uint32_t> device_flags_;  // present contents of flag_buffer_
    std::vector<std::uint32_t> visited_;       // [link][slot]: number of packets in the outbox already visited
    LinkCounts counts_;
    const std::vector<RankLink> rank_links_;  // sorted by link, then by sender
    std::vector<LinkMessage> outgoing_, incoming_;
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
