// trace: every PE traces sample points of its own pixels, without communication (Kohata & Ito 1993, ray tracing, step
// 2, and supersampling).
//
// One work-group is one PE. It copies the broadcast words to its local memory. Then each of its work-items traces V ray
// trees at once, one in each lane. A lane whose tree is done takes the next point of its pixel or, after the last
// point, the PE's next pixel:
//
//     copy the job's words to local memory, barrier
//     while a lane has a pixel:
//         a lane whose tree is done adds the tree's sum to its pixel; after the last point the lane stores the pixel
//             and takes the PE's next one; then it makes the primary ray of the next point (ring/points.clh)
//         test all objects for the rays of all lanes                                       (geometry/)
//         add the background if nothing was hit; else add the ambient term, push the refracted ray on the stack, and
//             add each light that a shadow ray reaches                                     (shading/)
//         continue with the reflected ray, else with the deepest refracted ray on the stack; else the tree is done
//         if a lane has done its work, save the trees for the next launch and end this one (ring/saved_trees.clh)
//
// The contributions to a point are added in the order of its ray tree, and the points of a pixel in their order. So the
// image's bits do not depend on V, group size, mapping or device.
//
// Limits: a PE's share < 2^32 pixels; modelled cycles of one pixel < 2^64; events of each kind of one pixel < 2^32.
#include "kernels/geometry/ray.clh"
#include "kernels/ring/points.clh"
#include "kernels/ring/saved_trees.clh"
#include "kernels/shading/shade.clh"
#include "kernels/shared/loop_canary.clh"

// Traces the trees until no pixels are left or a lane has done `work` tests and steps. Returns 1 if trees are
// unfinished or the PE has pixels that no work-item has taken; else 0.
static inline int trace_trees(words scene, pixel_store* store, tree* t, tree_pixels* pixels,
                              volatile __local uint* next, uint work) {
    ray_pool pool;
    open_pool(&pool);
    // The minimum number of idle lanes that take new points. If all start together, their rays remain similar.
    const uint refill = RAYA_MAKES_PACKETS ? RAYA_LANES : 1;
    for (;;) {
        const uint idle = popcount(mask_bits(mask_not(t->active)));
        if (idle >= refill) next_points(scene, t, store, pixels, next, mask_not(t->active));
        if (!mask_any(t->active)) return !store->drained;
        if (mask_any(pool.spent >= (index)(work))) return 1;
        follow_trees(scene, t, &pool);
    }
}

// Calls trace_trees() and returns its result. If `resumes` is 1, first restores the trees that the last launch saved
// (`last_state`). Saves unfinished trees to `new_state`.
RAYA_KERNEL_BODY int trace_share(words scene, pixel_store* store, volatile __local uint* next, uint work,
                                 save_cursor last_state, save_cursor new_state, int resumes) {
    tree t;
    tree_pixels pixels;
    index left = (index)(0);
    if (resumes) transfer_index(&last_state, &left);
    clear_tree(&t);
    clear_pixels(&pixels);
    if (mask_any(left != (index)(0))) transfer_trees(last_state, &t, &pixels);
    left = (index)(trace_trees(scene, store, &t, &pixels, next, work));
    transfer_index(&new_state, &left);
    if (!mask_any(left != (index)(0))) return 0;
    transfer_trees(new_state, &t, &pixels);
    return 1;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void trace(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h), the same for all PEs
           const uint word_count,                    // number of these words
           const uint window_start,                  // index in each share of the window's first pixel
           const uint capacity,                      // maximum number of pixels in the window of a PE
           const uint end,                           // index in each share, one past the last pixel to trace, which
                                                     // lies in the window
           const uint points,                        // RAYA_POINTS_*: which sample points are traced
           const uint first_pe,                      // number of the PE that is work-group 0
           const uint work,                          // maximum work of a launch: number of tests and steps of a lane's
                                                     // rays, and of marks that a work-item examines
           __global const uchar* restrict marks,     // [PE][capacity]: not 0 if the pixel is supersampled; unused with
                                                     // RAYA_POINTS_OWN
           __local raya_trace_progress* shared,      // [1]: shared by the work-items of a PE
           __local uint4* memory,                    // word_count words, in whole uint4, if RAYA_WORDS_LOCAL is 1
           __global float* restrict pixels,          // [PE][3][capacity]: linear rgb; also read in supersampling
           __global ulong* restrict cycles,          // [PE][capacity]: modelled cycles of the pixels of this pass
           __global ulong* restrict events,          // [PE][work-item][RAYA_EVENTS]: number of events so far
           __global raya_trace_progress* progress,           // [PE]: on entry the progress before this launch, on
                                                             // return that after it
           __global uint* restrict saved)            // state of unfinished trees (kernels/ring/saved_trees.clh)
{
    // A kernel argument, not a __local variable of the kernel: PoCL 3.1 lost pixels when the address of a __local
    // variable was passed to a function that is not inlined.
    volatile __local raya_trace_progress* mine = shared;
    const uint group = get_group_id(0), item = get_local_id(0);
    const int resumes = progress[group].left > 0;
    if (item == 0) {
        mine->next = progress[group].next;
        mine->left = mine->cut = 0;
    }
    const words scene = load_words(broadcast, word_count, (__local uint*)memory);
    barrier(CLK_LOCAL_MEM_FENCE);
    pixel_store store;
    open_store(&store, (job_words)scene, first_pe, window_start, capacity, end, pixels, marks, cycles);
    store.points = points;
    store.marks_left = work;
    const save_cursor last_state = open_save_cursor(saved, 1), new_state = open_save_cursor(saved, 0);
    if (trace_share(scene, &store, &mine->next, work, last_state, new_state, resumes)) atomic_inc(&mine->left);
    if (loops_were_cut(min(word_count, 2u))) atomic_inc(&mine->cut);
    close_store(&store, mine, events, progress);
}
