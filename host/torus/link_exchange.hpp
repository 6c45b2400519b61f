// Links of the torus: transfers packets from the outboxes of nodes to the inboxes of their neighbours, by buffer copies
// or by a kernel on the device, or by messages to the neighbour's rank.
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

/// "+x", "-x", "+y", ...
std::string link_name(std::uint32_t link);

using ExchangeKernel = DescribedKernel<"torus/exchange.cl", "exchange", const Buffer<std::uint32_t>&, Uint<"nodes">,
                                       Uint<"inboxes_of_link">, Uint<"capacity">, Uint<"packet_words">,
                                       Uint<"outbox_status">, Uint<"inbox_status">, const Buffer<std::uint32_t>&,
                                       Buffer<std::uint32_t>&, Buffer<std::uint32_t>&, Buffer<std::uint32_t>&>;

class LinkExchange {
  public:
    /// The kind of packet in the mailboxes, and how the model charges for it.
    struct PacketClass {
        std::string label;                                        // prefix of command labels
        std::uint32_t packet_words, outbox_status, inbox_status;  // status words that hold the mailboxes' counts
        std::uint32_t charged_words = packet_words;               // charged for a message
        std::optional<std::uint32_t> charged_status = {};  // status word: charged packets of the outbox, if not all
        int tag = 0;                                       // of messages between ranks
    };

    /// Mailboxes of `capacity` packets for every link of this rank's nodes (kernels/shared/traffic.h).
    LinkExchange(Session& session, const NodeShare& share, std::uint32_t capacity, const PacketClass& packet_class);

    /// Makes a kernel, in work-groups of `group`, transfer the packets that stay on the device, instead of the default,
    /// buffer copies. `status`: status words of the nodes on the device, the same as exchange() gets; must outlive
    /// this.
    void use_kernel(const ExchangeKernel& kernel, std::uint32_t group, Buffer<std::uint32_t>& status);
    void use_copies() { kernel_.reset(); }

    /// Empties the mailboxes and resets the counters.
    void clear();

    /// Transfers all packets of the outbox of each link whose inbox is empty, if both ends are on this device. With a
    /// kernel, one launch, "LABEL". With copies, one command for the links of each direction, "LABEL +x" and so on, or
    /// several where inboxes in between are not empty, or where outboxes differ so much in length that copying the
    /// longest one's length from all would take longer. Adds the words that each link is charged for to `words`,
    /// [node][link]. `status`, `words`, packets() and moved() are of all nodes of all ranks.
    void exchange(const NodeStatus& status, std::vector<std::uint64_t>& words);

    /// The transfers of the same exchange() between ranks: begin_transfers() appends the messages to `out` and `in`,
    /// which may start after wait_for_outgoing(). Once they are complete, write_incoming() writes the received packets
    /// into the inboxes.
    void begin_transfers(const NodeStatus& status, std::vector<Outgoing>& out, std::vector<Incoming>& in);
    void wait_for_outgoing();
    void write_incoming();

    Buffer<std::uint32_t>& outboxes() { return outboxes_; }
    Buffer<std::uint32_t>& inboxes() { return inboxes_; }
    const Buffer<std::uint32_t>& sent() const { return sent_; }  // [link][node]: 1 if the outbox was transferred

    /// [node][link], since clear(): messages sent.
    const std::vector<std::uint64_t>& packets() const { return packets_; }

    /// Packets sent over all links since clear(), charged or not.
    std::uint64_t moved() const { return moved_; }

    /// Calls `visit`, unless it is empty, with node and head of every packet that was put into an outbox of this rank
    /// since the last call.
    void visit_new_packets(const NodeStatus& status,
                           const std::function<void(std::uint32_t node, const raya_head& packet)>& visit);

  private:
    /// Mailboxes that one command copies: of slots `first` .. `end` - 1, the first `packets` packets of each.
    struct Span {
        std::uint32_t first, end, packets;
    };
    void send(const NodeStatus& status, std::uint32_t link, std::vector<std::uint64_t>& words);
    void copy_boxes(const NodeStatus& status, std::uint32_t link);
    void launch();
    void write_sent();
    std::vector<Span> spans(const NodeStatus& status, std::uint32_t link) const;
    std::uint64_t cost(const Span& span) const;  // time, as the number of bytes that could be copied in it
    bool inbox_full(const NodeStatus& status, std::uint32_t link, std::uint32_t node) const;  // not empty
    bool crosses_ranks(std::uint32_t link, std::uint32_t node) const;

    /// A link between this rank and another one, in either direction.
    struct Crossing {
        std::uint32_t link, node, rank;  // node: its start; rank: the other one
    };

    /// Mailboxes of one link direction between two ranks, packed into one message up to their filled length.
    struct Face {
        std::uint32_t rank = 0, link = 0;
        std::vector<std::uint32_t> nodes;    // start of each link, ascending
        std::vector<std::uint32_t> packets;  // in each mailbox
        std::size_t words = 0;               // of the message
    };
    std::vector<Crossing> find_crossings() const;
    Face& face(std::vector<Face>& faces, std::uint32_t rank, std::uint32_t link) const;
    void read_face(const Face& face, std::size_t to);

    Session& session_;
    const NodeShare& share_;
    const raya_torus torus_;
    std::uint32_t nodes_, capacity_;  // nodes: on this device
    PacketClass class_;
    Buffer<std::uint32_t> outboxes_, inboxes_, sent_;
    struct KernelMove {
        ExchangeKernel kernel;
        std::uint32_t group;
        Buffer<std::uint32_t>& status;
        Buffer<std::uint32_t> ends;  // [link][slot]: slot of the node at the other end, or RAYA_NO_SLOT
    };
    std::optional<KernelMove> kernel_;
    std::vector<std::uint32_t> sent_flags_, device_flags_;  // new and present contents of sent_
    std::vector<std::uint32_t> visited_;  // [link][node]: packets of the outbox that visit_new_packets() has visited
    std::vector<std::uint64_t> packets_;
    std::uint64_t moved_ = 0;
    const std::vector<Crossing> crossings_;  // by link, then by node
    std::vector<Face> outgoing_, incoming_;
    std::optional<Readback<std::uint32_t>> outgoing_words_;  // of outgoing_, one face after another
    std::vector<std::uint32_t> incoming_words_;              // of incoming_
    std::size_t box_words(std::uint32_t packets) const { return std::size_t{1 + packets} * class_.packet_words; }
    std::size_t outbox_at(std::uint32_t link, std::uint32_t slot) const {
        return raya_box_at(link, nodes_, slot, capacity_, class_.packet_words);
    }
    std::size_t inbox_at(std::uint32_t link, std::uint32_t inbox) const {
        return raya_box_at(link, share_.inboxes(), inbox, capacity_, class_.packet_words);
    }
};

}  // namespace raya
