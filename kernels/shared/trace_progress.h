// Progress of the trace kernel (kernels/ring/trace.cl). A launch ends after a bounded amount of work, and the next
// launch continues. This header defines the progress that a PE reports to the host and the size of the state that its
// work-items save.
#ifndef RAYA_SHARED_TRACE_PROGRESS_H
#define RAYA_SHARED_TRACE_PROGRESS_H
#include "kernels/shared/events.h"
#include "kernels/shared/portable.h"

// Progress of a PE through the pixels of its share.
typedef struct {
    raya_u32 next;  // index in the share of the first pixel that no work-item has taken yet
    raya_u32 left;  // number of work-items that have work left
    raya_u32 cut;   // number of work-items whose loops the device ended early (loop_canary.clh); must be 0
} raya_trace_progress;
RAYA_SHARED_SIZE(raya_trace_progress, 4 * 3);

// Returns the maximum number of words that a work-item saves for each lane (kernels/ring/saved_trees.clh): one word
// that is not 0 if a tree follows; then three words of state, its colour, current ray, event counts and pending rays,
// and four words and the colour of its pixel.
RAYA_SHARED_FUNCTION raya_u32 raya_saved_words(raya_u32 bounces) {
    const raya_u32 ray = 7, colour = 3;
    return 1 + 3 + colour + ray + RAYA_EVENTS + bounces * ray + 4 + colour;
}

#endif
