// Local memory that the work-items of a node share while they process its queue and move its packets: slots taken and
// in use, and counters.
#ifndef RAYA_SHARED_NODE_COUNTS_H
#define RAYA_SHARED_NODE_COUNTS_H
#include "kernels/shared/events.h"
#include "kernels/shared/packet.h"

enum {
    RAYA_COUNT_NEXT,      // slot of the next packet that no work-item has taken
    RAYA_COUNT_RESERVED,  // slots in use or reserved
    RAYA_COUNT_USED,      // slots in use
    RAYA_COUNT_PROGRESS,  // packets processed
    RAYA_COUNT_WORK,      // work of this launch, which ends when it reaches its limit
    RAYA_COUNT_EVENTS,    // events, low and high word of each kind
    RAYA_COUNT_MADE = RAYA_COUNT_EVENTS + 2 * RAYA_EVENTS,  // packets made, of each kind
    RAYA_COUNT_ENDED = RAYA_COUNT_MADE + RAYA_KINDS,        // packets ended, of each kind
    RAYA_COUNT_WORDS = RAYA_COUNT_ENDED + RAYA_KINDS
};

// Goals of packets that are routed: a link (0 .. RAYA_LINKS - 1), or
enum {
    RAYA_TO_ROOT = RAYA_LINKS,  // towards the root, as returns go
    RAYA_STAYS,                 // this node's queue
    RAYA_GONE,                  // none: the slot holds no packet
    RAYA_GOALS
};

// Goals of packets that have arrived over a link.
enum {
    RAYA_TAKEN,       // the queue
    RAYA_LEFT_THERE,  // the inbox: the queue has no free slots for it
    RAYA_NOTHING,     // none: the slot holds no packet
    RAYA_ACCEPT_GOALS
};

// The work of trace_voxel, in object tests of a work-item: 1 for each batch of V packets; and, for each group of them
// that it processes together in one voxel, the voxel's objects + this number.
#define RAYA_WORK_OF_PROCESSING(lights) (8 + 4 * (lights))

// Words of local memory that the L work-items of a node share, V lanes each (kernels/torus/moves.clh).
#define RAYA_VOTE_WORDS(voters) (((voters) + 31) / 32)
#define RAYA_INJECT_WORDS(group, lanes) (RAYA_COUNT_WORDS + 1 + RAYA_VOTE_WORDS((group) * (lanes)))
#define RAYA_ROUTE_WORDS(group) (RAYA_GOALS + 1 + RAYA_GOALS * RAYA_VOTE_WORDS(group))
#define RAYA_ACCEPT_WORDS(group) (1 + RAYA_ACCEPT_GOALS * RAYA_VOTE_WORDS(group))

#endif
