// Launches of trace end by themselves after a bounded amount of work, and the next one goes on (kernels/ring/trace.cl):
// what a PE tells the host of it, and how many words its work-items keep.
#ifndef RAYA_SHARED_TRACE_PROGRESS_H
#define RAYA_SHARED_TRACE_PROGRESS_H
#include "kernels/shared/accel.h"
#include "kernels/shared/events.h"
#include "kernels/shared/portable.h"

// How far a PE has come in the pixels of its share.
typedef struct {
    raya_u32 next;  // number of the first pixel that nobody has taken
    raya_u32 left;  // work-items that have stopped before they were done
    raya_u32 cut;   // work-items whose loops the device has cut short (loop_canary.clh): the image is wrong
} raya_trace_progress;
RAYA_SHARED_SIZE(raya_trace_progress, 4 * 3);

// Trees that a lane walks at once: several where rays walk through voxels, on long ways and short ones, and lanes of a
// work-item would wait for one another.
#define RAYA_DEFAULT_TREES(accel, lanes) ((accel) == RAYA_ACCEL_GRID && (lanes) > 1 ? 4 : 1)

// Words that a work-item keeps, of each lane: whether there is anything; of each tree three words of its state, its
// colour, ray and events, the rays that wait, and four words and the colour of its pixel (kernels/ring/kept_trees.clh).
RAYA_SHARED_FUNCTION raya_u32 raya_kept_words(raya_u32 trees, raya_u32 bounces) {
    const raya_u32 ray = 7, colour = 3;
    return 1 + trees * (3 + colour + ray + RAYA_EVENTS + bounces * ray + 4 + colour);
}

#endif
