// Queues, mailboxes of links, and the status words by which a node reports to the host.
//
//   queue    [node][capacity]: packets that wait in the node, from the first slot on
//   mailbox  [link][node][1 + capacity][w]: a header, whose first word is the number of packets, then the packets, of
//            w = 16 words for rays and 8 for returns. A node fills its outbox; it is copied to the inbox at the other
//            end of the link, which the node there empties. Both are numbered by the link's direction and the node at
//            its start. Where nodes are divided over ranks, `node` is a node's slot on its rank's device, and inboxes of
//            links that start on other ranks follow those slots
//   status   [node][RAYA_STATUS_WORDS]
//
// Rays and returns have separate mailboxes. All returns go to the root: each node moves them from its inboxes straight
// to the outbox of one link (raya_return_link), and the host takes those that reach the root. These routes form a tree,
// so returns cannot deadlock, whatever rays do.
#ifndef RAYA_SHARED_TRAFFIC_H
#define RAYA_SHARED_TRAFFIC_H
#include "kernels/shared/packet.h"

enum {
    RAYA_STATUS_QUEUE = 0,      // packets in the queue
    RAYA_STATUS_QUEUE_MAX,      // maximum so far
    RAYA_STATUS_NEXT_ROW,       // next row of pixels to examine, counted from 0 in the node's own order
    RAYA_STATUS_NEXT_COLUMN,    // pixels of that row examined so far
    RAYA_STATUS_ROWS,           // rows to examine in all
    RAYA_STATUS_PROGRESS,       // packets accepted, made, tested and routed since the host last read the status
    RAYA_STATUS_HOST,           // returns that wait for the host, in the root
    RAYA_STATUS_CYCLES,         // modelled cycles of the superstep, low and high word
    RAYA_STATUS_OUTBOX = 9,         // rays in the outbox of each link
    RAYA_STATUS_INBOX = 15,         // rays left in the inbox of each link that leads here
    RAYA_STATUS_RETURN_OUTBOX = 21, // returns in the outbox of each link; 0 except for raya_return_link
    RAYA_STATUS_RETURN_INBOX = 27,  // returns left in the inbox of each link that leads here
    RAYA_STATUS_RETURN_CHARGED = 33,// returns in the outbox of raya_return_link that the model charges as messages
    RAYA_STATUS_LEFT,           // work that the last launch left for the next one: packets to process or to route,
                                // links to empty; 1 where primary rays are still to be made
    RAYA_STATUS_KEPT,           // packets that stay in the queue, of those that the superstep's launches have routed
    RAYA_STATUS_CUT,            // 1: the device has ended loops early (kernels/shared/loop_canary.clh)
    RAYA_STATUS_WORDS
};

// The work of a node on the packet in one slot of its queue, recorded where RAYA_COSTS is 1.
typedef struct {
    raya_u32 pixel, state, path;  // of the packet before; state 0: not processed, or no packet
    raya_u32 cycles;              // modelled cycles of its tests, steps, shading and new packets
} raya_processed;
RAYA_SHARED_SIZE(raya_processed, 4 * 4);

// Constants of a render, in a buffer that all nodes read.
typedef struct {
    raya_u32 nodes;           // on the device
    raya_u32 inboxes;         // on the device, for each link: links that start here, then those from other ranks
    raya_u32 queue;           // capacity of a node's queue, packets
    raya_u32 box;             // capacity of a mailbox, packets
    raya_u32 host;            // maximum number of returns that wait for the host
    raya_u32 stride, offset;  // primary rays are those of the pixels offset, offset + stride, ..., counted row by row
    raya_u32 root_injects;    // 1: the root makes all primary rays, or it is the only node; 0: every node makes its own
    raya_u32 return_a_ray;    // 1: one return of each ray is a message, made when its shadow rays are done; 0: all are
} raya_run;
RAYA_SHARED_SIZE(raya_run, 4 * 9);

// Returns how many packets a ray may turn into, except for the one that takes its slot: a shadow ray or a return for
// each light, a reflected and a refracted ray.
RAYA_SHARED_FUNCTION raya_u32 raya_max_new_packets(raya_u32 lights) { return lights + 2; }

// Return the free slots that a ray of a level, or a packet, needs before a node accepts or processes it: those of its
// whole tree, traced depth first, if every ray of it hits. A shadow ray turns into at most one packet and is processed
// without reserved slots; to be accepted it must leave slots for one hit. So a node alone can finish every ray that it
// has accepted, and only nodes that wait for each other's links can deadlock. Then the host lets nodes continue with
// fewer free slots for a superstep (`tight`).
RAYA_SHARED_FUNCTION raya_u32 raya_slots_for_ray(raya_u32 new_packets, raya_u32 bounces, raya_u32 level) {
    return (bounces + 1 - level) * new_packets;
}
RAYA_SHARED_FUNCTION raya_u32 raya_slots_for_packet(raya_u32 new_packets, raya_u32 bounces, raya_u32 state) {
    const raya_u32 kind = raya_state_kind(state);
    if (kind == RAYA_KIND_SHADOW) return new_packets;
    return raya_slots_for_ray(new_packets, bounces, raya_state_level(state));
}

// Returns the minimum capacity of a queue: one primary ray and the slots of its tree.
RAYA_SHARED_FUNCTION raya_u32 raya_min_queue(raya_u32 lights, raya_u32 bounces) {
    return 1 + raya_slots_for_ray(raya_max_new_packets(lights), bounces, 0);
}

// Stands for the slot of a node that is not on the device.
#define RAYA_NO_SLOT 0xffffffffu

// Returns the word where a mailbox of packets of w words starts.
RAYA_SHARED_FUNCTION raya_u64 raya_box_at(raya_u32 link, raya_u32 nodes, raya_u32 node, raya_u32 capacity, raya_u32 w) {
    return ((raya_u64)link * nodes + node) * (1 + capacity) * w;
}

#endif
