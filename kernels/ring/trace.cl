// trace: every PE traces its own pixels of the image, without communication (Kohata & Ito 1993, ray tracing, step 2).
//
// One work-group is one PE. It first takes the broadcast words into its own memory; then each of its work-items walks V ray
// trees at once, one in each lane, and a lane takes the PE's next pixel as soon as its last one is done:
//
//     copy the job's words to local memory, barrier
//     while a lane has a pixel:
//         lanes without one store what they finished, take the PE's next pixel and make its primary ray
//         test all objects for the rays of all lanes                                      (geometry/)
//         where nothing was hit add the background; else add the ambient term, put the
//         refracted ray aside, and add each light that a shadow ray reaches                (shading/)
//         go on with the reflected ray, else with the deepest waiting refracted one, else without a pixel
//
// Pixels are summed in the order of their own ray tree, so the bits do not depend on V, group size, mapping or device.
// Limits: a PE's share < 2^32 pixels; the cost of one pixel < 2^64 cycles; its events < 2^32 each.
#include "shading/shade.clh"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: work-items in a work-group, 1..64
#endif

#define RAYA_NO_PIXEL 0xffffffffu

// Where a work-item's pixels come from and where they go.
typedef struct {
    raya_mapping mapping;
    raya_share share;
    uint block;                // number in the share of the block's first pixel
    __global float* pixels;    // of the PE's block, 3 words a pixel
    __global ulong* cycles;    // of the PE's block, modelled cycles of a pixel
    ulong totals[RAYA_EVENTS]; // events of all pixels of the work-item
    lanes_index pixel;         // number of the lane's pixel in the share
    int drained;               // the PE has no more pixels: asking again would only make `next` grow
} pixel_store;

static inline void store_pixel(words scene, tree* t, pixel_store* store, lanes_vec sum, uint lane) {
    const uint k = store->pixel.lane[lane] - store->block;
    store->pixels[3 * k] = sum.x.lane[lane];
    store->pixels[3 * k + 1] = sum.y.lane[lane];
    store->pixels[3 * k + 2] = sum.z.lane[lane];
    ulong cycles = 0;
    for (uint e = 0; e < RAYA_EVENTS; ++e) {
        const uint events = t->events[e].lane[lane];
        store->totals[e] += events;
        cycles += (ulong)((job_words)scene)->cycles[e] * events;
    }
    store->cycles[k] = cycles;
}

// Starts the walk of a new pixel in the lanes `fresh`.
static inline void start_walk(words scene, tree* t, mask fresh, index row, index column) {
    const job_words job = (job_words)scene;
    const vec zero = vec_of(num_const(0.0f), num_const(0.0f), num_const(0.0f));
    const vec left = vec_mad(vec_all(job->row_step), num_from_index(row), vec_all(job->corner));
    const vec through = vec_mad(vec_all(job->column_step), num_from_index(column), left);
    set_lanes(&t->ray.origin, fresh, vec_all(job->eye));
    set_lanes(&t->ray.direction, fresh, vec_normalize(through));
    t->ray.weight.all = choose(fresh, num_const(1.0f), t->ray.weight.all);
    t->level = choose_index(fresh, (index)(0), t->level);
    t->sum = vec_choose(fresh, zero, t->sum);
    t->walking |= fresh;
    for (uint e = 0; e < RAYA_EVENTS; ++e) t->events[e].all = choose_index(fresh, (index)(0), t->events[e].all);
    count_event(t, RAYA_PRIMARY, fresh);
}

// Lanes without a pixel store the one that they finished and take the PE's next one.
static inline void take_pixels(words scene, tree* t, pixel_store* store, volatile __local uint* next, uint end) {
    lanes_index idle, fresh, row, column;
    idle.truth = mask_not(t->walking);
    fresh.all = row.all = column.all = (index)(0);
    const lanes_vec sum = lanes_of_vec(t->sum);
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!idle.lane[lane]) continue;
        if (store->pixel.lane[lane] != RAYA_NO_PIXEL) store_pixel(scene, t, store, sum, lane);
        const uint k = store->drained ? end : atomic_inc(next);
        store->drained = k >= end;
        store->pixel.lane[lane] = k < end ? k : RAYA_NO_PIXEL;
        if (k >= end) continue;
        const raya_pixel pixel = raya_pixel_of(store->mapping, store->share, k);
        row.lane[lane] = pixel.row;
        column.lane[lane] = pixel.column;
        fresh.lane[lane] = RAYA_TRUE;
    }
    if (mask_any(fresh.truth)) start_walk(scene, t, fresh.truth, row.all, column.all);
}

static inline void trace_share(words scene, pixel_store* store, volatile __local uint* next, uint end) {
    const job_words job = (job_words)scene;
    tree t;
    clear_tree(&t);
    for (;;) {
        if (mask_any(mask_not(t.walking))) take_pixels(scene, &t, store, next, end);
        if (!mask_any(t.walking)) return;
        const ray r = {vec_of_lanes(t.ray.origin), vec_of_lanes(t.ray.direction),
                       choose(t.walking, num_const(RAYA_FAR), num_const(0.0f))};
        const hit h = closest_hit(scene, r);
        count_tests(&t, job, t.walking);
        shade(scene, &t, h);
    }
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void trace(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h), the same for all PEs
           const uint word_count,                    // how many
           const uint block,                         // number in the share of the first pixel of a PE's block
           const uint capacity,                      // pixels in a block
           const uint begin,                         // pixels `begin` to `end` - 1 of each share are traced now;
           const uint end,                           // they lie in the block
           __local uint* memory,                     // word_count words, 1 where RAYA_WORDS_LOCAL is 0
           __global float* restrict pixels,          // [PE][capacity][3]: linear red, green, blue
           __global ulong* restrict cycles,          // [PE][capacity]: modelled cycles of each pixel
           __global ulong* restrict events)          // [PE][work-item][RAYA_EVENTS], added to
{
    __local uint next;
    const uint pe = get_group_id(0), item = get_local_id(0);
    if (item == 0) next = begin;
#if RAYA_WORDS_LOCAL
    for (uint i = item; i < word_count; i += RAYA_GROUP) memory[i] = broadcast[i];
    const words scene = memory;
#else
    const words scene = broadcast;
#endif
    barrier(CLK_LOCAL_MEM_FENCE);
    pixel_store store;
    store.mapping = ((job_words)scene)->mapping;
    store.share = raya_share_of(store.mapping, pe);
    store.block = block;
    store.pixels = pixels + (size_t)pe * capacity * 3;
    store.cycles = cycles + (size_t)pe * capacity;
    store.pixel.all = (index)(RAYA_NO_PIXEL);
    store.drained = 0;
    for (uint e = 0; e < RAYA_EVENTS; ++e) store.totals[e] = 0;
    trace_share(scene, &store, &next, min(end, raya_share_size(store.share)));
    __global ulong* mine = events + ((size_t)pe * RAYA_GROUP + item) * RAYA_EVENTS;
    for (uint e = 0; e < RAYA_EVENTS; ++e) mine[e] += store.totals[e];
}
