// The links of the torus: what nodes have put into their outboxes is copied into the inboxes of their neighbours, by
// copies between buffers or by a kernel, or sent there where these are on another rank.
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
    /// What the boxes are for: packets of so many words; where a node's status has its boxes' counts; the labels' first
    /// word, and what tells its messages from those of other cargo. What the model charges: words of a message, and
    /// where the status has how many of the outbox's packets are messages, if not all are.
    struct Cargo {
        std::string label;
        std::uint32_t packet_words, outbox_status, inbox_status;
        std::uint32_t charged_words = packet_words;
        std::optional<std::uint32_t> charged_status = {};
        int tag = 0;
    };

    /// Boxes of `capacity` packets for every link of the nodes that are here (kernels/shared/traffic.h).
    LinkExchange(Session& session, const NodeShare& share, std::uint32_t capacity, const Cargo& cargo);

    /// From now on a kernel moves what stays on the device, built for groups of `group` work-items. `status`: the
    /// nodes' own, which outlives this; it says what exchange() is told. At first, and after use_copies(), copies do.
    void use_kernel(const ExchangeKernel& kernel, std::uint32_t group, Buffer<std::uint32_t>& status);
    void use_copies() { kernel_.reset(); }

    /// All inboxes are empty, nothing has been sent.
    void clear();

    /// One exchange: over each link whose inbox at the other end is empty, all packets of the outbox. By a kernel that
    /// is one launch, "LABEL"; by copies, "LABEL +x" and so on, the links of one direction are one command, or several
    /// where boxes between must wait or differ so much in length that copying as much of each as the longest needs
    /// would take longer. Adds the words that each link is charged for to `words`, [node][link]. `status` and `words`
    /// are of all nodes, as what packets() and moved() say is; copied is what stays on the device.
    void exchange(const NodeStatus& status, std::vector<std::uint64_t>& words);

    /// What goes over links that lead to other ranks, or come from there, in one exchange(): adds the messages that
    /// carry it to `out` and `in`. They may go after wait_for_leaving(); when they are through, arrive() puts them into
    /// the inboxes.
    void leave(const NodeStatus& status, std::vector<Outgoing>& out, std::vector<Incoming>& in);
    void wait_for_leaving();
    void arrive();

    Buffer<std::uint32_t>& outboxes() { return outboxes_; }
    Buffer<std::uint32_t>& inboxes() { return inboxes_; }
    const Buffer<std::uint32_t>& sent() const { return sent_; }  // [link][node]: 1 where an outbox was copied or sent

    /// [node][link], since clear(): messages sent.
    const std::vector<std::uint64_t>& packets() const { return packets_; }

    /// Since clear(): packets sent over all links, messages or not.
    std::uint64_t moved() const { return moved_; }

    /// Calls `visit`, if there is one, with node and head of every packet that was put into an outbox here since the
    /// last call.
    void visit_new(const NodeStatus& status,
                   const std::function<void(std::uint32_t node, const raya_head& packet)>& visit);

  private:
    /// Boxes of neighbouring slots that one command copies: the links of nodes in `first` .. `end` - 1, as far as
    /// `packets` reach.
    struct Span {
        std::uint32_t first, end, packets;
    };
    void send(const NodeStatus& status, std::uint32_t link, std::vector<std::uint64_t>& words);
    void copy_boxes(const NodeStatus& status, std::uint32_t link);
    void launch();
    void write_sent();
    std::vector<Span> spans(const NodeStatus& status, std::uint32_t link) const;
    std::uint64_t cost(const Span& span) const;  // in bytes that could be copied in its time
    bool waits(const NodeStatus& status, std::uint32_t link, std::uint32_t node) const;  // the inbox is not empty
    bool leads_away(std::uint32_t link, std::uint32_t node) const;                       // to another rank than its own

    /// A link that leads from this rank to another one, or from there to here.
    struct Crossing {
        std::uint32_t link, node, rank;  // the node at its start; the other rank
    };

    /// The boxes of one link that go from one rank to another, one after another as far as they are filled.
    struct Face {
        std::uint32_t rank = 0, link = 0;
        std::vector<std::uint32_t> nodes;  // where the links start, ascending
        std::vector<std::uint32_t> packets;
        std::size_t words = 0;  // of all its boxes
    };
    std::vector<Crossing> find_crossings() const;
    Face& face(std::vector<Face>& faces, std::uint32_t rank, std::uint32_t link) const;
    void read_face(const Face& face, std::size_t to);

    Session& session_;
    const NodeShare& share_;
    const raya_torus torus_;
    std::uint32_t nodes_, capacity_;  // nodes: on this device
    Cargo cargo_;
    Buffer<std::uint32_t> outboxes_, inboxes_, sent_;
    struct Launched {
        ExchangeKernel kernel;
        std::uint32_t group;
        Buffer<std::uint32_t>& status;
        Buffer<std::uint32_t> ends;  // [link][slot]: slot of the node at the other end, RAYA_NO_SLOT
    };
    std::optional<Launched> kernel_;
    std::vector<std::uint32_t> sent_flags_, flags_there_;  // what is to be, and what is, in sent_
    std::vector<std::uint32_t> visited_;  // [link][node]: packets of the outbox that visit_new() has shown
    std::vector<std::uint64_t> packets_;
    std::uint64_t moved_ = 0;
    const std::vector<Crossing> crossings_;  // by link, then by node
    std::vector<Face> leaving_, coming_;
    std::optional<Landing<std::uint32_t>> left_;  // words of leaving_, one face after another
    std::vector<std::uint32_t> come_;             // of coming_
    std::size_t box_words(std::uint32_t packets) const { return std::size_t{1 + packets} * cargo_.packet_words; }
    std::size_t outbox_at(std::uint32_t link, std::uint32_t slot) const {
        return raya_box_at(link, nodes_, slot, capacity_, cargo_.packet_words);
    }
    std::size_t inbox_at(std::uint32_t link, std::uint32_t inbox) const {
        return raya_box_at(link, share_.inboxes(), inbox, capacity_, cargo_.packet_words);
    }
};

}  // namespace raya
