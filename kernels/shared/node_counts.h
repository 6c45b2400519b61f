// Layout of the local memory that the work-items of a node share while they process the node's queue and move its
// packets: counters of queue slots, packets and events.
#ifndef RAYA_SHARED_NODE_COUNTS_H
#define RAYA_SHARED_NODE_COUNTS_H
#include "kernels/shared/events.h"
#include "kernels/shared/packet.h"

enum {
    RAYA_COUNT_NEXT,      // number of packets that work-items have taken from the queue so far
    RAYA_COUNT_RESERVED,  // number of queue slots in use or reserved
    RAYA_COUNT_USED,      // number of queue slots in use
    RAYA_COUNT_PROGRESS,  // number of packets processed
    RAYA_COUNT_WORK,      // work done in this launch, in object tests; at the limit work-items take no more packets
    RAYA_COUNT_EVENTS,    // number of events of each kind: low and high word
    RAYA_COUNT_MADE = RAYA_COUNT_EVENTS + 2 * RAYA_EVENTS,  // number of packets of each kind made
    RAYA_COUNT_ENDED = RAYA_COUNT_MADE + RAYA_KINDS,        // number of packets of each kind ended
    RAYA_COUNT_WORDS = RAYA_COUNT_ENDED + RAYA_KINDS
};

// Goals of packets in the kernel `route`: the outbox of a link (0 .. RAYA_LINKS - 1), or one of the following.
enum {
    RAYA_TO_ROOT = RAYA_LINKS,  // the outbox of the link towards the root (returns)
    RAYA_STAYS,                 // this node's queue
    RAYA_GONE,                  // no goal: the slot holds no packet
    RAYA_GOALS
};

// Goals of packets in the kernel `accept`, which have arrived over a link.
enum {
    RAYA_TAKEN,       // this node's queue
    RAYA_LEFT_THERE,  // the inbox, where the packet stays: the queue has too few free slots for it
    RAYA_NOTHING,     // no goal: the slot holds no packet
    RAYA_ACCEPT_GOALS
};

// Overhead of processing packets in one voxel, in units of one object test. trace_voxel adds to RAYA_COUNT_WORK 1 for
// each batch of V packets and, for each voxel in which packets of the batch are processed together, the voxel's number
// of objects + this number.
#define RAYA_WORK_OF_PROCESSING(lights) (8 + 4 * (lights))

// Numbers of words of local memory that kernels need for the work-items of a node (kernels/torus/moves.clh). `group`:
// L, the number of work-items; `lanes`: V.
#define RAYA_VOTE_WORDS(voters) (((voters) + 31) / 32)
#define RAYA_INJECT_WORDS(group, lanes) (RAYA_COUNT_WORDS + 1 + RAYA_VOTE_WORDS((group) * (lanes)))
#define RAYA_ROUTE_WORDS(group) (RAYA_GOALS + 1 + RAYA_GOALS * RAYA_VOTE_WORDS(group))
#define RAYA_ACCEPT_WORDS(group) (1 + RAYA_ACCEPT_GOALS * RAYA_VOTE_WORDS(group))

#endif
