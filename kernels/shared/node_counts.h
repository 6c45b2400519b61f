// What the work-items of a node share in local memory while they treat its queue: slots taken
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
#define RAYA_ROUTE_WORDS (2 * RAYA_GOALS + 2)  // that route shares, beside one for each work-item

#endif
