// Links of the torus: transfers packets from the outboxes of nodes to the inboxes of their neighbours. Within a device
// it uses buffer copies or a kernel, between ranks messages.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/ranks/transport.hpp"
#include "host/torus/node_share.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

/// Returns "+x", "-x", "+y", ...
std::string link_name(std::uint32_t link);

using ExchangeKernel = DescribedKernel<"torus/exchange.cl", "exchange", const Buffer<std::uint32_t>&, Uint<"nodes">,
                                       Uint<"inboxes_of_link">, Uint<"capacity">, Uint<"packet_words">,
                                       Uint<"outbox_status">, Uint<"inbox_status">, const Buffer<std::uint32_t>&,
                                       Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&>;

class LinkExchange {
  public:
    /// Kind of the packets in the mailboxes, and the words that the model charges for them.
    struct PacketClass {
        std::string label;                                        // prefix of command labels
        std::uint32_t packet_words, outbox_status, inbox_status;  // first status word of the packet counts
        std::uint32_t charged_words = packet_words;               // charged for each message
        std::optional<std::uint32_t> charged_status = {};  // status word: charged packets of the outbox; empty: all
        int tag = 0;                                       // tag of messages between ranks
    };

    /// Allocates mailboxes of `capacity` packets for every link of this rank's nodes (kernels/shared/traffic.h).
    LinkExchange(Session& session, const NodeShare& share, std::uint32_t capacity, const PacketClass& packet_class);

    /// Transfers packets within the device with `kernel`, in work-groups of `group` work-items, instead of with buffer
    /// copies, the default. `status`: device buffer with the same status words that exchange() receives; must outlive
    /// this object.
    void use_kernel(const ExchangeKernel& kernel, std::uint32_t group, Buffer<std::uint32_t>& status);
    void use_copies() { kernel_.reset(); }

    /// Empties the mailboxes and resets the counters.
    void clear();

    /// For each link with both ends on this device: if its inbox is empty, transfers all packets of its outbox. With a
    /// kernel this takes one launch, labelled "LABEL". With copies it takes one command for each link direction,
    /// labelled "LABEL +x" and so on. A direction takes several commands if an inbox in the range is not empty, or if
    /// the lengths of the outboxes differ so much that one command with the maximum length would take longer. Adds the
    /// words charged for each link to `words`, [node][link]. `status`, `words`, packets() and moved() cover all nodes
    /// of all ranks.
    void exchange(const NodeStatus& status, std::vector<std::uint64_t>& words);

    /// The transfers between ranks that belong to the same exchange(). begin_transfers() appends the messages to `out`
    /// and `in`. The caller starts these messages after wait_for_outgoing(). When they are complete, write_incoming()
    /// writes the received packets into the inboxes.
    void begin_transfers(const NodeStatus& status, std::vector<Outgoing>& out, std::vector<Incoming>& in);
    void wait_for_outgoing();
    void write_incoming();

    Buffer<std::uint32_t>& outboxes() { return outboxes_; }
    Buffer<std::uint32_t>& inboxes() { return inboxes_; }
    const Buffer<std::uint32_t>& sent_flags() const { return sent_; }  // [link][slot]: 1 if the outbox was transferred

    /// [node][link]: messages sent since clear().
    const std::vector<std::uint64_t>& packets() const { return packets_; }

    /// Packets sent over all links since clear(), charged or not.
    std::uint64_t moved() const { return moved_; }

    /// Calls `visit`, unless it is empty, with the node and the head of every packet that was put into an outbox of
    /// this rank since the last call of visit_new_packets().
    void visit_new_packets(const NodeStatus& status,
                           const std::function<void(std::uint32_t node, const raya_head& packet)>& visit);

  private:
    /// Mailboxes that one command copies: the first `packets` packets of each mailbox of slots `first` to `end` - 1.
    struct CopyRange {
        std::uint32_t first, end, packets;
    };
    void count_transfers(const NodeStatus& status, std::uint32_t link, std::vector<std::uint64_t>& words);
    void copy_mailboxes(const NodeStatus& status, std::uint32_t link);
    void launch_kernel();
    void write_sent_flags();
    std::vector<CopyRange> copy_ranges(const NodeStatus& status, std::uint32_t link) const;
    std::uint64_t copy_cost(const CopyRange& range) const;  // time, as a number of bytes that are copied in that time
    bool inbox_occupied(const NodeStatus& status, std::uint32_t link, std::uint32_t node) const;
    bool crosses_ranks(std::uint32_t link, std::uint32_t node) const;

    /// A link from this rank to another one, or from another one to this rank.
    struct RankLink {
        std::uint32_t link, node, rank;  // node: start of the link; rank: the other rank
    };

    /// Message from one rank to another: the used part of the mailboxes of one link direction between the ranks.
    struct LinkMessage {
        std::uint32_t rank = 0, link = 0;
        std::vector<std::uint32_t> nodes;    // node at the start of each link, ascending
        std::vector<std::uint32_t> packets;  // [mailbox]: number of packets
        std::size_t words = 0;               // length of the message
    };
    std::vector<RankLink> find_rank_links() const;
    LinkMessage& message_for(std::vector<LinkMessage>& messages, std::uint32_t rank, std::uint32_t link) const;
    void read_message(const LinkMessage& message, std::size_t to);

    Session& session_;
    const NodeShare& share_;
    const raya_torus torus_;
    std::uint32_t nodes_, capacity_;  // nodes_: number of nodes on this device
    PacketClass class_;
    Buffer<std::uint32_t> outboxes_, inboxes_, sent_;
    struct KernelTransfer {
        ExchangeKernel kernel;
        std::uint32_t group;
        Buffer<std::uint32_t>& status;
        Buffer<std::uint32_t> ends;  // [link][slot]: slot of the node at the other end, or RAYA_NO_SLOT
    };
    std::optional<KernelTransfer> kernel_;
    std::vector<std::uint32_t> sent_flags_, device_flags_;  // new contents of sent_, its present contents
    std::vector<std::uint32_t> visited_;                    // [link][slot]: packets of the outbox already visited
    std::vector<std::uint64_t> packets_;
    std::uint64_t moved_ = 0;
    const std::vector<RankLink> rank_links_;  // sorted by link, then by node
    std::vector<LinkMessage> outgoing_, incoming_;
    std::optional<Readback<std::uint32_t>> outgoing_words_;  // words of outgoing_, concatenated
    std::vector<std::uint32_t> incoming_words_;              // words of incoming_
    std::size_t box_words(std::uint32_t packets) const { return std::size_t{1 + packets} * class_.packet_words; }
    std::size_t outbox_at(std::uint32_t link, std::uint32_t slot) const {
        return raya_box_at(link, nodes_, slot, capacity_, class_.packet_words);
    }
    std::size_t inbox_at(std::uint32_t link, std::uint32_t inbox) const {
        return raya_box_at(link, share_.inboxes(), inbox, capacity_, class_.packet_words);
    }
};

}  // namespace raya
