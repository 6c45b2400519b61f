// Queues, boxes and the few words by which a node tells the host how it stands.
//
//   queue   [node][capacity]: packets that wait in the node, from the first slot on
//   box     [link][node][1 + capacity][w]: a header, whose first word is the number of packets, then the packets, of
//           w = 16 words for rays and 8 for returns. An outbox is filled by its node and copied into the inbox at the
//           other end of the link, which the node there empties; both are numbered by the link's direction and the node
//           at its start. Where nodes are divided over ranks, `node` is a node's slot on its rank's device, and inboxes
//           of links that start on other ranks come behind those slots
//   status  [node][RAYA_STATUS_WORDS]
//
// Rays and returns have boxes of their own. Returns all go to the root, each node's by its one link home, from inbox
// to outbox without a queue; those ways are a tree, and the host takes what comes to its root. So returns never
// stand still, whatever rays do.
#ifndef RAYA_SHARED_TRAFFIC_H
#define RAYA_SHARED_TRAFFIC_H
#include "kernels/shared/packet.h"

enum {
    RAYA_STATUS_QUEUE = 0,      // packets in the queue
    RAYA_STATUS_QUEUE_MAX,      // most there ever were
    RAYA_STATUS_NEXT_ROW,       // row of pixels that the node looks at next, counted from 0 in its own order
    RAYA_STATUS_NEXT_COLUMN,    // how many pixels of that row it has looked at
    RAYA_STATUS_ROWS,           // how many rows it looks at in all
    RAYA_STATUS_PROGRESS,       // what was done since the host last looked: packets accepted, made, tested, routed
    RAYA_STATUS_HOST,           // returns that wait for the host, in the root
    RAYA_STATUS_CYCLES,         // modelled cycles of the superstep, low and high word
    RAYA_STATUS_OUTBOX = 9,         // rays in the outbox of each link
    RAYA_STATUS_INBOX = 15,         // rays left in the inbox of each link that leads here
    RAYA_STATUS_RETURN_OUTBOX = 21, // returns in the outbox of each link; other links than the one home stay empty
    RAYA_STATUS_RETURN_INBOX = 27,  // returns left in the inbox of each link that leads here
    RAYA_STATUS_RETURN_CHARGED = 33,// returns in the outbox of the link home that are messages of their own
    RAYA_STATUS_LEFT,           // what the step's last launch has left for the next one: packets to treat or to route,
                                // links to look at; 1 where primary rays are still to be made
    RAYA_STATUS_KEPT,           // packets that stay in the queue, of those that the step's launches have routed
    RAYA_STATUS_CUT,            // 1: the device has ended loops early (kernels/shared/loop_canary.clh)
    RAYA_STATUS_WORDS
};

// What a node did for the packet in one slot of its queue, where kernels are asked to tell (RAYA_COSTS).
typedef struct {
    raya_u32 pixel, state, path;  // of the packet as it was before; state 0: it waits, or there was none
    raya_u32 cycles;              // modelled: its tests and steps, its shading, what it turned into
} raya_treated;
RAYA_SHARED_SIZE(raya_treated, 4 * 4);

// What stays the same through a render, and the nodes read from a buffer.
typedef struct {
    raya_u32 nodes;           // on the device
    raya_u32 inboxes;         // on the device, of each link: of links that start here, then of those from other ranks
    raya_u32 queue;           // packets that a node's queue holds
    raya_u32 box;             // packets that a box holds
    raya_u32 host;            // returns that wait for the host at most
    raya_u32 stride, offset;  // primary rays are those of the pixels offset, offset + stride, ..., counted row by row
    raya_u32 root_injects;    // 1: the root makes all primary rays, or there is no other node; 0: every node its own
    raya_u32 return_a_ray;    // 1: one return of each ray is a message, made when its shadow rays are done; 0: all are
} raya_run;
RAYA_SHARED_SIZE(raya_run, 4 * 9);

// Packets that a ray may turn into beside the one that takes its slot: shadow rays (lights or a return for
// each) and two rays that follow.
RAYA_SHARED_FUNCTION raya_u32 raya_most_new_packets(raya_u32 lights) { return lights + 2; }

// Free slots that a ray of a level asks for before it is accepted or treated: what its tree needs, walked depth
// first, if every ray of it hits. Shadow rays turn into one packet at most, and are treated without more room; to be
// accepted they leave room for one hit. So a ray that was let in can always be brought to its end by the node alone,
// and only nodes that wait for each other's links can stand still. When they do, the host lets them go on with less
// room for a superstep (`tight`).
RAYA_SHARED_FUNCTION raya_u32 raya_room_of_ray(raya_u32 new_packets, raya_u32 bounces, raya_u32 level) {
    return (bounces + 1 - level) * new_packets;
}
RAYA_SHARED_FUNCTION raya_u32 raya_room_of_packet(raya_u32 new_packets, raya_u32 bounces, raya_u32 state) {
    const raya_u32 kind = raya_state_kind(state);
    if (kind == RAYA_KIND_SHADOW) return new_packets;
    return raya_room_of_ray(new_packets, bounces, raya_state_level(state));
}

// The shortest queue that can work: room for one primary ray and all its tree.
RAYA_SHARED_FUNCTION raya_u32 raya_shortest_queue(raya_u32 lights, raya_u32 bounces) {
    return 1 + raya_room_of_ray(raya_most_new_packets(lights), bounces, 0);
}

// In place of the slot of a node that is not on the device.
#define RAYA_NO_SLOT 0xffffffffu

// The word where a box of packets of w words starts.
RAYA_SHARED_FUNCTION raya_u64 raya_box_at(raya_u32 link, raya_u32 nodes, raya_u32 node, raya_u32 capacity, raya_u32 w) {
    return ((raya_u64)link * nodes + node) * (1 + capacity) * w;
}

#endif
