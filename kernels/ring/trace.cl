// trace: every PE traces points of its own pixels, without communication (Kohata & Ito 1993, ray
// tracing, step 2, and supersampling).
//
// One work-group is one PE. It first takes the broadcast words into its own memory; then each of its work-items
// walks V ray trees at once, one in each lane, and a lane takes the pixel's next point, or the PE's next pixel, as
// soon as its last walk is done:
//
//     copy the job's words to local memory, barrier
//     while a lane has a pixel:
//         lanes without a walk add what they saw to their pixel; where that was its last point they store it and take
//         the PE's next pixel; they make the primary ray of the next point                (ring/pixel_store.clh)
//         test all objects for the rays of all lanes                                      (geometry/)
//         where nothing was hit add the background; else add the ambient term, put the
//         refracted ray aside, and add each light that a shadow ray reaches                (shading/)
//         go on with the reflected ray, else with the deepest waiting refracted one, else without a walk
//         end the launch where a lane has spent its work, and keep the trees for the next one  (ring/kept_trees.clh)
//
// A point's colour is summed in the order of its own ray tree, a pixel's in the order of its points, so the bits do
// not depend on V, group size, mapping or device.
// Limits: a PE's share < 2^32 pixels; the cost of one pixel < 2^64 cycles; its events < 2^32 each.
#include "kernels/ring/kept_trees.clh"
#include "kernels/shading/camera.clh"
#include "kernels/shading/shade.clh"
#include "kernels/shared/loop_canary.clh"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: work-items in a work-group, 1..1024
#endif

// Starts the walk of a point in the lanes `fresh`, `row` down and `column` to the right of the first pixel's own.
static inline void start_walk(words scene, tree* t, mask fresh, real row, real column) {
    const job_words job = (job_words)scene;
    const vec zero = vec_of(num_const(0.0f), num_const(0.0f), num_const(0.0f));
    set_lanes(&t->ray.origin, fresh, vec_all(job->eye));
    set_lanes(&t->ray.direction, fresh, primary_direction(job, row, column));
    t->ray.weight.all = choose(fresh, num_const(1.0f), t->ray.weight.all);
    t->level = choose_index(fresh, (index)(0), t->level);
    t->sum = vec_choose(fresh, zero, t->sum);
    t->walking |= fresh;
    count_event(t, RAYA_PRIMARY, fresh);
}

// Lanes whose walk is done go on to the next point of their pixel, or store it and take the PE's next one.
static inline void next_points(words scene, tree* t, pixel_store* store, tree_pixels* p, volatile __local uint* next) {
    const mask idle = mask_not(t->walking), traced = idle & (p->pixel.all != RAYA_NO_PIXEL);
    add_points(t, store, p, traced);
    p->point.all = choose_index(traced, p->point.all + 1u, p->point.all);
    const mask done = traced & (p->point.all == raya_points(store->points));
    if (mask_any(done)) store_pixels((job_words)scene, t, store, p, done);
    take_pixels(store, p, next, done | (idle & mask_not(traced)));
    const mask fresh = idle & (p->pixel.all != RAYA_NO_PIXEL);
    if (!mask_any(fresh)) return;
    start_walk(scene, t, fresh, point_rows(store, p), point_columns(store, p));
}

// Follows the trees to their ends, or until a lane has spent its `work`. Returns whether anything is left to do.
static inline int trace_trees(words scene, pixel_store* store, tree* trees, tree_pixels* pixels,
                              volatile __local uint* next, uint work) {
    ray_pool pool;
    open_pool(&pool);
    for (;;) {
        int walking = 0;
        for (uint i = 0; i < RAYA_TREES; ++i) {
            if (mask_any(mask_not(trees[i].walking))) next_points(scene, &trees[i], store, &pixels[i], next);
            walking |= mask_any(trees[i].walking);
        }
        if (!walking) return !store->drained;
        if (mask_any(pool.spent >= (index)(work))) return 1;
        follow_trees(scene, trees, &pool);
    }
}

// As trace_trees(); where it `goes_on`, it takes the trees that the last launch has kept from `taken`, and it puts those
// that are left into `put`.
RAYA_KERNEL_BODY int trace_share(words scene, pixel_store* store, volatile __local uint* next, uint work, keeper taken,
                                 keeper put, int goes_on) {
    tree trees[RAYA_TREES];
    tree_pixels pixels[RAYA_TREES];
    index left = (index)(0);
    if (goes_on) keep_index(&taken, &left);
    for (uint i = 0; i < RAYA_TREES; ++i) {
        clear_tree(&trees[i]);
        clear_pixels(&pixels[i]);
    }
    if (mask_any(left != (index)(0))) keep_trees(taken, trees, pixels);
    left = (index)(trace_trees(scene, store, trees, pixels, next, work));
    keep_index(&put, &left);
    if (!mask_any(left != (index)(0))) return 0;
    keep_trees(put, trees, pixels);
    return 1;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void trace(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h), the same for all PEs
           const uint word_count,                    // how many
           const uint block,                         // number in the share of the first pixel of a PE's block
           const uint capacity,                      // pixels in a block
           const uint end,                           // pixels of each share up to `end` - 1 are traced; they lie in the
                                                     // block
           const uint points,                        // RAYA_POINTS_*: which points of them
           const uint first_pe,                      // number of the PE that is work-group 0
           const uint work,                          // tests and steps of a lane's rays after which the launch ends, or
                                                     // pixels looked at for their marks
           __global const uchar* restrict marks,     // [PE][capacity]: not 0 where a pixel gets new points; of no use
                                                     // for RAYA_POINTS_OWN
           __local raya_trace_progress* shared,      // by the work-items of a PE
           __local uint4* memory,                    // where RAYA_WORDS_LOCAL is 1, word_count words, in whole rows
           __global float* restrict pixels,          // [PE][3][capacity]: linear rgb; read where points are new
           __global ulong* restrict cycles,          // [PE][capacity]: modelled cycles of the pixels traced now
           __global ulong* restrict events,          // [PE][work-item][RAYA_EVENTS], added to
           __global raya_trace_progress* restrict progress,  // [PE]: of the last launch, then of this one
           __global uint* restrict kept)             // what work-items go on with (kernels/ring/kept_trees.clh)
{
    // An argument, not a __local variable: with PoCL 3.1 pixels were lost where a function that
    // took its address was not inlined.
    volatile __local raya_trace_progress* mine = shared;
    const uint group = get_group_id(0), item = get_local_id(0);
    const int goes_on = progress[group].left > 0;
    if (item == 0) {
        mine->next = progress[group].next;
        mine->left = mine->cut = 0;
    }
#if RAYA_WORDS_LOCAL
    __local uint* const own = (__local uint*)memory;
    for (uint i = item; i < word_count; i += RAYA_GROUP) own[i] = broadcast[i];
    const words scene = own;
#else
    const words scene = broadcast;
#endif
    barrier(CLK_LOCAL_MEM_FENCE);
    pixel_store store;
    store.mapping = ((job_words)scene)->mapping;
    store.share = raya_share_of(store.mapping, first_pe + group);
    store.block = block;
    store.end = min(end, raya_share_size(store.share));
    store.points = points;
    store.looks = work;
    store.plane = capacity;
    store.pixels = pixels + (size_t)group * capacity * 3;
    store.marks = marks + (size_t)group * capacity;
    store.cycles = cycles + (size_t)group * capacity;
    open_store(&store);
    const keeper taken = open_keeper(kept, 1), put = open_keeper(kept, 0);
    if (trace_share(scene, &store, &mine->next, work, taken, put, goes_on)) atomic_inc(&mine->left);
    __global ulong* counted = events + ((size_t)group * RAYA_GROUP + item) * RAYA_EVENTS;
    for (uint e = 0; e < RAYA_EVENTS; ++e) counted[e] += sum_of(store.totals[e]);
    if (loops_were_cut(min(word_count, 2u))) atomic_inc(&mine->cut);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);  // all have seen whether they go on
    if (item) return;
    progress[group].next = min((uint)mine->next, store.end);
    progress[group].left = mine->left;
    progress[group].cut = mine->cut;
}
