// Progress of the trace kernel. A launch ends after a bounded amount of work and the next one continues
// (kernels/ring/trace.cl): what a PE reports to the host, and how many words its work-items save.
#ifndef RAYA_SHARED_TRACE_PROGRESS_H
#define RAYA_SHARED_TRACE_PROGRESS_H
#include "kernels/shared/accel.h"
#include "kernels/shared/events.h"
#include "kernels/shared/portable.h"

// Progress of a PE through the pixels of its share.
typedef struct {
    raya_u32 next;  // number of the first pixel that no work-item has taken
    raya_u32 left;  // work-items that stopped before they were done
    raya_u32 cut;   // work-items whose loops the device ended early (loop_canary.clh): the image is wrong
} raya_trace_progress;
RAYA_SHARED_SIZE(raya_trace_progress, 4 * 3);

// Ray trees that a lane traces at once: several in a grid, where the lengths of walks differ and lanes of a work-item
// would wait for one another.
#define RAYA_DEFAULT_TREES(accel, lanes) ((accel) == RAYA_ACCEL_GRID && (lanes) > 1 ? 4 : 1)

// Returns the words that a work-item saves for each lane: one that is not 0 if trees follow; for each tree three words
// of state, its colour, ray and events, its pending rays, and four words and the colour of its pixel
// (kernels/ring/saved_trees.clh).
RAYA_SHARED_FUNCTION raya_u32 raya_saved_words(raya_u32 trees, raya_u32 bounces) {
    const raya_u32 ray = 7, colour = 3;
    return 1 + trees * (3 + colour + ray + RAYA_EVENTS + bounces * ray + 4 + colour);
}

#endif
