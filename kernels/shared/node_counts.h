// What the work-items of a node share in local memory while they treat its queue and move its packets: slots taken
// and in use, and what is counted.
#ifndef RAYA_SHARED_NODE_COUNTS_H
#define RAYA_SHARED_NODE_COUNTS_H
#include "kernels/shared/events.h"
#include "kernels/shared/packet.h"

enum {
    RAYA_COUNT_NEXT,      // slot of the next packet that nobody has taken
    RAYA_COUNT_RESERVED,  // slots in use or reserved
    RAYA_COUNT_USED,      // slots in use
    RAYA_COUNT_PROGRESS,  // packets treated
    RAYA_COUNT_WORK,      // of this launch, by which it knows when to end
    RAYA_COUNT_EVENTS,    // events, low and high word of each kind
    RAYA_COUNT_MADE = RAYA_COUNT_EVENTS + 2 * RAYA_EVENTS,  // packets made, of each kind
    RAYA_COUNT_ENDED = RAYA_COUNT_MADE + RAYA_KINDS,        // packets ended
    RAYA_COUNT_WORDS = RAYA_COUNT_ENDED + RAYA_KINDS
};

// Where packets go that are routed: over a link, or
enum {
    RAYA_HOME = RAYA_LINKS,  // the way of returns
    RAYA_STAYS,              // this node's queue
    RAYA_GONE,               // nowhere: there is no packet
    RAYA_GOALS
};

// Where packets go that have come over a link.
enum {
    RAYA_TAKEN,       // into the queue
    RAYA_LEFT_THERE,  // nowhere: there is no room
    RAYA_NOTHING,     // there is no packet
    RAYA_ACCEPT_GOALS
};

// What trace_voxel counts as work, in tests of an object for a work-item's lanes: 1 for each batch of V packets, and
// for those of them that are treated together in one voxel the objects there, and this for all else.
#define RAYA_WORK_OF_TREATING(lights) (8 + 4 * (lights))

// Words of local memory that the L work-items of a node share, V lanes each (kernels/torus/moves.clh).
#define RAYA_VOTE_WORDS(voters) (((voters) + 31) / 32)
#define RAYA_INJECT_WORDS(group, lanes) (RAYA_COUNT_WORDS + 1 + RAYA_VOTE_WORDS((group) * (lanes)))
#define RAYA_ROUTE_WORDS(group) (RAYA_GOALS + 1 + RAYA_GOALS * RAYA_VOTE_WORDS(group))
#define RAYA_ACCEPT_WORDS(group) (1 + RAYA_ACCEPT_GOALS * RAYA_VOTE_WORDS(group))

#endif
