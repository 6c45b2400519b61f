// Layout of the torus's buffers: the nodes' queues, the links' mailboxes, and the status words that nodes report to the
// host.
//
//   queue    [node][capacity]: the packets in a node, from slot 0 on
//   mailbox  [link][node][1 + capacity][w]: a header, whose first word is the number of packets, then the packets of
//            w words: 16 for rays, 8 for returns. A node writes to the outbox of a link. The exchange copies the outbox
//            to the inbox at the link's other end, which the node there reads. The indices of outbox and inbox are the
//            same: `link` is the link's direction, `node` the node at its start. With several ranks, `node` is the
//            node's slot: its index among the rank's nodes. Inboxes of links that start on other ranks follow
//   status   [node][RAYA_STATUS_WORDS]
//
// Rays and returns have separate mailboxes. All returns go to the root, where the host reads them: each node moves them
// from its inboxes directly to the outbox of one link (raya_return_link()). These routes form a tree, so returns cannot
// deadlock, even if rays are stalled.
#ifndef RAYA_SHARED_TRAFFIC_H
#define RAYA_SHARED_TRAFFIC_H
#include "kernels/shared/packet.h"

enum {
    RAYA_STATUS_QUEUE = 0,      // number of packets in the queue
    RAYA_STATUS_QUEUE_MAX,      // maximum number of packets in the queue so far
    RAYA_STATUS_NEXT_ROW,       // next row of pixels to examine: an index into the node's own sequence of rows
    RAYA_STATUS_NEXT_COLUMN,    // number of pixels of that row examined so far
    RAYA_STATUS_ROWS,           // total number of rows to examine
    RAYA_STATUS_PROGRESS,       // number of packets accepted, made, tested and routed since the last read
    RAYA_STATUS_HOST,           // in the root: number of returns that the host has not read yet
    RAYA_STATUS_CYCLES,         // modelled cycles of this superstep: low and high word
    RAYA_STATUS_OUTBOX = 9,         // number of rays in the outbox of each link
    RAYA_STATUS_INBOX = 15,         // number of rays left in the inbox of each link that ends here
    RAYA_STATUS_RETURN_OUTBOX = 21, // number of returns in each link's outbox; 0 except for raya_return_link()
    RAYA_STATUS_RETURN_INBOX = 27,  // number of returns left in the inbox of each link that ends here
    RAYA_STATUS_RETURN_CHARGED = 33,// how many of RAYA_STATUS_RETURN_OUTBOX the model charges as messages
    RAYA_STATUS_LEFT,           // work that the last launch left for the next: number of packets to process or route,
                                // number of links to empty, or 1 if primary rays remain to be made
    RAYA_STATUS_KEPT,           // number of packets that `route` has examined and left in the queue in this superstep
    RAYA_STATUS_CUT,            // 1: the device has ended loops early (kernels/shared/loop_canary.clh)
    RAYA_STATUS_WORDS
};

// The work of a node on the packet in one slot of its queue. Recorded if RAYA_COSTS is 1.
typedef struct {
    raya_u32 pixel, state, path;  // of the packet before it was processed; state 0: not processed, or no packet
    raya_u32 cycles;              // modelled cycles of the packet's tests, steps, shading and new packets
} raya_processed;
RAYA_SHARED_SIZE(raya_processed, 4 * 4);

// Constants of a render, in a buffer that all nodes read.
typedef struct {
    raya_u32 nodes;           // number of nodes on the device
    raya_u32 inboxes;         // number of inboxes on the device per link; those of links that start here come first
    raya_u32 queue;           // capacity of a node's queue, packets
    raya_u32 box;             // capacity of a mailbox, packets
    raya_u32 host;            // maximum number of returns that wait for the host
    raya_u32 stride, offset;  // primary rays are made for pixels offset, offset + stride, ..., counted row by row
    raya_u32 root_injects;    // 1: the root makes all primary rays, or it is the only node; 0: every node makes its own
    // 1: only one return of each ray is charged as a message, made when its shadow rays are done; 0: all are charged
    raya_u32 one_return_per_ray;
} raya_run;
RAYA_SHARED_SIZE(raya_run, 4 * 9);

// Returns the maximum number of packets that a ray turns into, in addition to the return that takes the ray's slot: a
// shadow ray for each light, a reflected and a refracted ray.
RAYA_SHARED_FUNCTION raya_u32 raya_max_new_packets(raya_u32 lights) { return lights + 2; }

// Return the number of free slots that a node must have before it accepts or processes a ray of the given level, or a
// packet of the given state. The slots suffice for the ray's whole tree, traced depth first, if every ray of the tree
// hits something. A shadow ray turns into at most one packet, so it is processed without reserved slots, but it is
// accepted only if the slots for one hit are free. So a node by itself can finish every ray that it has accepted. Nodes
// can deadlock only by waiting for each other's links. In a deadlock the host lets them continue with fewer free slots
// for a superstep (`tight`).
RAYA_SHARED_FUNCTION raya_u32 raya_slots_for_ray(raya_u32 new_packets, raya_u32 bounces, raya_u32 level) {
    return (bounces + 1 - level) * new_packets;
}
RAYA_SHARED_FUNCTION raya_u32 raya_slots_for_packet(raya_u32 new_packets, raya_u32 bounces, raya_u32 state) {
    const raya_u32 kind = raya_state_kind(state);
    if (kind == RAYA_KIND_SHADOW) return new_packets;
    return raya_slots_for_ray(new_packets, bounces, raya_state_level(state));
}

// Returns the minimum capacity of a queue, in packets: one primary ray and the free slots that its tree needs.
RAYA_SHARED_FUNCTION raya_u32 raya_min_queue(raya_u32 lights, raya_u32 bounces) {
    return 1 + raya_slots_for_ray(raya_max_new_packets(lights), bounces, 0);
}

// Value for the slot of a node that is not on this device.
#define RAYA_NO_SLOT 0xffffffffu

// Returns the offset, in words, of a mailbox of packets of w words.
RAYA_SHARED_FUNCTION raya_u64 raya_box_at(raya_u32 link, raya_u32 nodes, raya_u32 node, raya_u32 capacity, raya_u32 w) {
    return ((raya_u64)link * nodes + node) * (1 + capacity) * w;
}

#endif
