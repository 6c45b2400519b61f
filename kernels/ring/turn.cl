// Rays meet objects that rotate on the ring, for scenes that do not fit a PE. Every PE holds one part of the objects at
// a time (kernels/shared/part.h) and keeps its rays. A turn:
//
//     advance: adds the lights that the last hits' shadow rays have reached, and the background or the ambient term of
//              the current rays' hits; makes the next rays and the shadow rays of the hits; takes new sample points
//     for each of G parts:
//         meet: tests the rays in flight against the part that the PE holds
//         the ring passes every part to the next PE                                       (host/ring/turns.cpp)
//
// After G steps each ray has met every object once. The shadow rays of a hit are in flight together with the next ray
// of its tree. The contributions to a sample point are those of `trace`, in the same order, and of hits at the same
// distance the lowest object number wins, whatever the order of the parts. So images and counts are those of `trace`.
//
// One work-group is one PE. Its work-items share the slots of trees in flight, V at a time.
#include "kernels/ring/flight.clh"
#include "kernels/ring/points.clh"
#include "kernels/shared/loop_canary.clh"

typedef RAYA_WORDS_SPACE raya_part* part_words;

// Cursor at the slots first .. first + V - 1 of this work-group's PE.
static inline save_cursor open_flight(__global uint* state, uint stride, uint first, int restores) {
    const size_t words = raya_flight_words(RAYA_BOUNCES) + RAYA_EVENTS;
    const save_cursor k = {state + get_group_id(0) * words * stride + first, stride, restores};
    return k;
}

// Resolves the last turn's hits of one batch of slots and starts their next rays. `in_use`: lanes that are slots.
// Returns the lanes that have rays. Adds modelled cycles to *cycles.
static inline mask advance_rays(words scene, pixel_store* store, volatile __local uint* next, flight* f, mask in_use,
                                ulong* cycles) {
    const job_words job = (job_words)scene;
    const words lights = scene + job->lights_at;
    tree* t = &f->t;
    const ulong before = cycles_of_trees(job, t);
    for (uint l = 0; l < job->lights && mask_any(f->met.struck); ++l) {
        const vec arm = arm_to_light(&f->met.lit, lights + l * RAYA_LIGHT_WORDS);
        const mask faces = faces_light(&f->met.lit, f->met.struck, arm);
        const ray r = shadow_ray(&f->met.lit, faces, arm);
        const mask blocked = (f->blocked.all & (index)(1u << l)) != (index)(0);
        const hit h = {r.limit, choose_index(blocked, (index)(0), (index)(RAYA_NO_OBJECT))};
        add_light(t, &f->met, lights + l * RAYA_LIGHT_WORDS, faces, r.direction, h);
    }
    f->met.struck = t->active & (f->found.object != RAYA_NO_OBJECT);
    add_radiance(t, t->active & mask_not(f->met.struck), vec_all(job->background), t->ray.weight.all);
    if (mask_any(f->met.struck)) {
        const vec d = vec_of_lanes(t->ray.direction);
        set_points(job, &f->place, vec_mad(d, f->found.distance, vec_of_lanes(t->ray.origin)));
        shade_hits(job, t, &f->met, &f->place, f->place.surface.colour);
    }
    advance_tree(t, &f->met);
    mask waiting = mask_all(0);
    for (uint l = 0; l < job->lights && mask_any(f->met.struck); ++l) {
        mask faces;
        beam_to(t, &f->met, lights + l * RAYA_LIGHT_WORDS, &faces);
        waiting |= faces;
    }
    *cycles += cycles_of_trees(job, t) - before;
    const mask idle = in_use & mask_not(t->active | waiting);
    if (mask_any(idle)) next_points(scene, t, store, &f->pixels, next, idle);
    *cycles += (ulong)mask_count(idle & t->active) * job->cycles[RAYA_PRIMARY];
    f->found.distance = num_const(RAYA_FAR);
    f->found.object = (index)(RAYA_NO_OBJECT);
    f->blocked.all = (index)(0);
    return t->active | waiting;
}

RAYA_KERNEL_BODY uint advance_slots(words scene, pixel_store* store, volatile __local uint* next, uint fresh,
                                    uint slots, uint stride, __global uint* state, ulong* cycles) {
    mask any = mask_all(0);
    for (uint first = get_local_id(0) * RAYA_LANES; first < slots; first += RAYA_GROUP * RAYA_LANES) {
        flight f;
        transfer_flight(open_flight(state, stride, first, 1), &f);
        if (fresh) f.pixels.pixel.all = (index)(RAYA_NO_PIXEL);
#if RAYA_LANES == 1
        const mask in_use = mask_all(1);
#else
        const mask in_use = RAYA_LANE_NUMBERS + first < slots;
#endif
        any |= advance_rays(scene, store, next, &f, in_use, cycles);
        transfer_flight(open_flight(state, stride, first, 0), &f);
    }
    return mask_any(any) ? 1 : 0;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void advance(__global const uint* restrict broadcast,  // the job's header and lights
             const uint word_count,                    // number of these words
             const uint window_start,                  // as in ring/trace.cl
             const uint capacity,
             const uint end,
             const uint points,
             const uint first_pe,
             const uint slots,                         // number of ray trees in flight of a PE
             const uint stride,                        // slots, padded to a multiple of 16
             const uint fresh,                         // 1: no trees are in flight yet
             __global const uchar* restrict marks,
             __local raya_trace_progress* shared,
             __local uint4* memory,                    // word_count words, in whole uint4, if RAYA_WORDS_LOCAL is 1
             __global float* restrict pixels,
             __global ulong* restrict cycles,
             __global ulong* restrict events,
             __global raya_trace_progress* progress,   // [PE]: `left` on return: number of work-items with rays
             __global uint* restrict state,            // trees in flight (ring/flight.clh)
             __global ulong* restrict spent)           // [step][PE][work-item]: modelled cycles; this launch is step 0
{
    volatile __local raya_trace_progress* mine = shared;
    const uint group = get_group_id(0), item = get_local_id(0);
    if (item == 0) {
        mine->next = progress[group].next;
        mine->left = 0;
        mine->cut = progress[group].cut;  // of the last turn
    }
    const words scene = load_words(broadcast, word_count, (__local uint*)memory);
    const uint used_slots = fresh || progress[group].left ? slots : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    pixel_store store;
    open_store(&store, (job_words)scene, first_pe, window_start, capacity, end, pixels, marks, cycles);
    store.points = points;
    store.marks_left = 0xffffffffu;
    ulong used = 0;
    if (advance_slots(scene, &store, &mine->next, fresh, used_slots, stride, state, &used)) atomic_inc(&mine->left);
    spent[group * RAYA_GROUP + item] = used;
    if (loops_were_cut(min(word_count, 2u))) atomic_inc(&mine->cut);
    close_store(&store, mine, events, progress);
}

// Counts the tests of the rays in the lanes `m` against the part's objects. Adds their modelled cycles to *cycles.
static inline void count_part_tests(job_words job, tree* t, mask m, objects_words all, ulong* cycles) {
    ulong of_a_ray = job->cycles[RAYA_RESUMED];
#define RAYA_COUNT_PART(kind, kinds, KIND)                 \
    count_events(t, RAYA_##KIND##_TESTS, m, all->kinds);   \
    of_a_ray += (ulong)job->cycles[RAYA_##KIND##_TESTS] * all->kinds;
    RAYA_OBJECT_LIST(RAYA_COUNT_PART)
    count_event(t, RAYA_RESUMED, m);
    *cycles += of_a_ray * mask_count(m);
}

// Tests the current rays of one batch of slots against the part.
static inline void meet_current_rays(job_words job, words part, flight* f, ulong* cycles) {
    const objects_words all = &((part_words)part)->objects;
    const ray r = followed_ray(&f->t);
    const hit h = closest_hit(part, all, r, 0);
    count_part_tests(job, &f->t, f->t.active, all, cycles);
    const index number = h.object + ((part_words)part)->first;
    const mask tie = (h.distance == f->found.distance) & (number < f->found.object);
    const mask nearest = f->t.active & (h.object != RAYA_NO_OBJECT) & ((h.distance < f->found.distance) | tie);
    if (!mask_any(nearest)) return;
    const hit_place p = find_place(job, part, all, nearest, h, r.origin, r.direction);
    f->found = nearer(f->found, nearest, h.distance, 0);
    f->found.object = choose_index(nearest, number, f->found.object);
    choose_place(&f->place, nearest, &p, surface_colour(part, nearest, &p));
}

// Tests the shadow rays of the last hits of one batch of slots.
static inline void meet_shadow_rays(words scene, words part, flight* f, ulong* cycles) {
    const job_words job = (job_words)scene;
    const objects_words all = &((part_words)part)->objects;
    for (uint l = 0; l < job->lights; ++l) {
        const vec arm = arm_to_light(&f->met.lit, scene + job->lights_at + l * RAYA_LIGHT_WORDS);
        const mask faces = faces_light(&f->met.lit, f->met.struck, arm);
        const index bit = (index)(1u << l);
        const mask open = faces & ((f->blocked.all & bit) == (index)(0));
        count_part_tests(job, &f->t, faces, all, cycles);
        if (!mask_any(open)) continue;
        const hit h = closest_hit(part, all, shadow_ray(&f->met.lit, open, arm), 1);
        f->blocked.all |= choose_index(open & (h.object != RAYA_NO_OBJECT), bit, (index)(0));
    }
}

RAYA_KERNEL_BODY void meet_slots(words scene, words part, uint slots, uint stride, __global uint* state,
                                 ulong* cycles) {
    for (uint first = get_local_id(0) * RAYA_LANES; first < slots; first += RAYA_GROUP * RAYA_LANES) {
        flight f;
        save_cursor from = open_flight(state, stride, first, 1);
        transfer_rays(&from, &f);
        if (!mask_any(f.t.active | f.met.struck)) continue;
        save_cursor to = from;
        to.restores = 0;
        transfer_found(&from, &f);
        if (mask_any(f.t.active)) meet_current_rays((job_words)scene, part, &f, cycles);
        if (mask_any(f.met.struck)) meet_shadow_rays(scene, part, &f, cycles);
        transfer_found(&to, &f);
    }
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void meet(__global const uint* restrict broadcast,  // the job's header and lights
          const uint word_count,                    // number of these words
          __global const uint* restrict parts,      // [PE][part_words_count]: the part that each PE holds
          const uint part_words_count,              // number of words of the largest part
          const uint slots,
          const uint stride,
          const uint step,                          // number of this launch in the turn, from 1 on
          __local uint4* memory,                    // word_count + part_words_count words, in whole uint4, if
                                                    // RAYA_WORDS_LOCAL is 1
          __global raya_trace_progress* progress,   // `left`: 0 if the PE has no rays
          __global uint* restrict state,
          __global ulong* restrict spent)           // [step][PE][work-item]: modelled cycles
{
    const uint group = get_group_id(0), item = get_local_id(0);
    __global const uint* const my_part = parts + (size_t)group * part_words_count;
    const raya_objects objects = ((__global const raya_part*)my_part)->objects;
    const int needed = progress[group].left > 0 && raya_first_object(objects, RAYA_OBJECT_KINDS) > 0;
    const words scene = load_words(broadcast, needed ? word_count : 0, (__local uint*)memory);
    const words part = load_words(my_part, needed ? part_words_count : 0, (__local uint*)memory + word_count);
    barrier(CLK_LOCAL_MEM_FENCE);
    ulong used = 0;
    meet_slots(scene, part, needed ? slots : 0, stride, state, &used);
    spent[((size_t)step * get_num_groups(0) + group) * RAYA_GROUP + item] = used;
    if (loops_were_cut(min(word_count, 2u))) atomic_inc(&progress[group].cut);
}
