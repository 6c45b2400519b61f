// trace_voxel: every node tests each ray packet in its queue against the objects of the voxel that the ray is in
// (Yoshitani & Yamazaki, section on the method).
//
// One work-group is one node. Its work-items take V packets of the queue at a time, one in each lane:
//
//     for each voxel of this node that packets of the lanes are in:
//         reserve slots for the new packets that each of these packets may turn into (raya_slots_for_ray()); a packet
//             without enough free slots waits for the next superstep
//         test the rays of these lanes against the voxel's objects                        (geometry/)
//         a ray is done if its nearest hit lies before its exit from the voxel, or if it leaves the box. With a hit it
//             turns into a return packet and the packets of its secondary rays (torus/shade_packets.clh). Without a
//             hit it turns into a return packet with the background
//         a shadow ray ends at any hit; at its light it turns into a return packet. If raya_run.one_return_per_ray is
//             1, the last shadow ray of a ray always turns into a return packet
//         all remaining rays move to the next voxel                                           (grid/traversal.clh)
//
// Wide rays (is_wide() in kernels/grid/traversal.clh) must be tested against all objects. They visit all voxels in the
// order of voxel numbers. Their packets record the voxel of the nearest hit. At the end the packets return to that
// voxel, where the hit is shaded.
//
// A node that has done its `work` takes no more packets. The remaining packets are in the queue's first slots, because
// the node takes packets from the end of the queue. The next launch (`resume` = 1) processes them. Dividing the work
// among launches does not change the result.
//
// Limits: number of packets in a queue < 2^31; number of events of one kind, per node and superstep, < 2^64; if
// RAYA_COSTS is 1, cycles per packet and launch < 2^32.
#include "kernels/shared/loop_canary.clh"
#include "kernels/torus/outcome.clh"
#include "kernels/torus/shade_packets.clh"

// Reserves slots for the packets that the packets of the lanes m may turn into. Returns the lanes for which there were
// enough free slots. Sets `reserved` to the number of slots reserved. Shadow rays need no slots.
static inline mask reserve_slots(const node* n, const packet_batch* f, mask m, uint* reserved) {
    lanes_index chosen = {.truth = m & mask_not(is_shadow(f))};
    const lanes_index level = {levels_of(f)};
    const uint packets_per_hit = raya_max_new_packets(((job_words)n->memory)->lights);
    shared_words used_slots = &f->shared[RAYA_COUNT_RESERVED];
    *reserved = 0;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!chosen.lane[lane]) continue;
        const uint needed_slots =
            f->tight ? packets_per_hit : raya_slots_for_ray(packets_per_hit, RAYA_BOUNCES, level.lane[lane]);
        chosen.lane[lane] = 0;
        if (*used_slots + needed_slots > f->capacity) continue;
        if (shared_add(used_slots, packets_per_hit) + needed_slots > f->capacity) {
            shared_add(used_slots, -packets_per_hit);
            continue;
        }
        chosen.lane[lane] = RAYA_TRUE;
        *reserved += packets_per_hit;
    }
    return m & (is_shadow(f) | chosen.truth);
}

static inline void count_tests_of(packet_batch* f, uint event, mask m, uint objects) {
    count_events(f, event, mask_count(m) * objects);
    add_cost(f, event, m, objects);
}

static inline void count_tests(packet_batch* f, mask m, objects_words all) {
#define RAYA_COUNT_TESTS(kind, kinds, KIND) count_tests_of(f, RAYA_##KIND##_TESTS, m, all->kinds);
    RAYA_OBJECT_LIST(RAYA_COUNT_TESTS)
}

// Sets the next voxel of the packets of the lanes m to `packed_voxel`.
static inline void move_packets(packet_batch* f, mask m, index packed_voxel) {
    const lanes_index chosen = {.truth = m}, to = {packed_voxel};
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!chosen.lane[lane]) continue;
        own_slot(f, lane)->head.voxel = to.lane[lane];
        own_slot(f, lane)->head.state |= RAYA_STATE_FRESH;
    }
}

// Processes the packets of the lanes m. Their rays are in the voxel `packed_voxel` of this node, or outside the box if
// `packed_voxel` is RAYA_NO_VOXEL.
static inline void process_packets(const node* n, packet_batch* f, mask m, uint packed_voxel) {
    const uint before = f->appended;
    uint reserved;
    m = reserve_slots(n, f, m, &reserved);
    if (!mask_any(m)) return;
#if RAYA_COSTS
    f->processed.truth |= m;
#endif
    const int outside = packed_voxel == RAYA_NO_VOXEL;
    const voxel_words voxel = own_voxel(n, outside ? n->place : raya_unpack_place(packed_voxel));
    const objects_words all = outside ? &((job_words)n->memory)->objects : &voxel->objects;
    const ray r = {vec_of_lanes(f->origin), vec_of_lanes(f->direction),
                   choose(m, choose(is_shadow(f), f->limit.all, num_const(RAYA_FAR)), num_all(0.0f))};
    const hit h = closest_hit(n->memory, all, r, 0);
    count_tests(f, m, all);
    count_shared(f->shared, RAYA_COUNT_WORK,
                 raya_first_object(*all, RAYA_OBJECT_KINDS) + RAYA_WORK_OF_PROCESSING(((job_words)n->memory)->lights));
    count_shared(f->shared, RAYA_COUNT_PROGRESS, mask_count(m));
    if (!outside) count_event(f, RAYA_STEPS, m & mask_not(has_flag(f, RAYA_STATE_FOUND)));
    const mask wide = m & has_flag(f, RAYA_STATE_WIDE);
    outcome o = walk_outcome(n, f, r, m & mask_not(wide), packed_voxel, h);
    if (mask_any(wide)) o = merge_outcomes(o, tour_outcome(n, f, voxel, wide, packed_voxel, h), wide);
    move_packets(f, o.moves, o.packed_voxel);
    const vec background = vec_all(((job_words)n->memory)->background);
    if (mask_any(o.missed))
        put_return_packets(f, o.missed, background, f->weight.all, (index)(0), (index)(RAYA_STATE_CHARGED));
    end_shadow_rays(f, o.arrived, o.stopped);
    if (mask_any(o.struck)) shade_packets(n, all, f, o.struck, h);
    end_packets(f, o.struck | o.missed | o.stopped | o.arrived);
    if (reserved) shared_add(&f->shared[RAYA_COUNT_RESERVED], f->appended - before - reserved);
}

#if RAYA_COSTS
// Records the costs of the batch's packets, which are in the slots f->first .. end - 1.
static inline void record_costs(const packet_batch* f, uint end, __global raya_processed* processed) {
    for (uint lane = 0; lane < RAYA_LANES && f->first + lane < end; ++lane) {
        __global raya_processed* t = processed + f->first + lane;
        t->pixel = f->pixel.lane[lane];
        t->state = f->processed.lane[lane] ? f->state.lane[lane] : RAYA_KIND_NONE;
        t->path = f->path.lane[lane];
        t->cycles = f->cycles.lane[lane];
    }
}
#endif

// Processes the packets in the queue's slots first .. end - 1, at most V slots. Skips packets whose next voxel belongs
// to another node.
RAYA_KERNEL_BODY void process_slots(const node* n, packet_batch* f, uint first, uint end) {
    load_batch(f, first, end);
    const index kind = kinds_of(f);
    lanes_index waiting = {.truth = (kind != (index)(RAYA_KIND_NONE)) & (kind != (index)(RAYA_KIND_RETURN))};
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!waiting.lane[lane]) continue;
        const uint packed_voxel = f->voxel.lane[lane];
        const mask in_voxel = waiting.truth & (f->voxel.all == (index)(packed_voxel));
        waiting.truth &= mask_not(in_voxel);
        if (packed_voxel == RAYA_NO_VOXEL || holds_voxel(n, raya_unpack_place(packed_voxel)))
            process_packets(n, f, in_voxel, packed_voxel);
    }
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void trace_voxel(__global const uint* restrict memories,  // the words of all nodes (kernels/shared/node.h)
                 __global const uint* restrict starts,    // [nodes + 1]: offset of each node's words
                 __global const raya_run* restrict run,   // (kernels/shared/traffic.h)
                 const uint first_node,                   // slot of the node that is work-group 0
                 const uint tight,                        // 1: a ray needs free slots for one hit, not for its tree
                 const uint work,                         // maximum RAYA_COUNT_WORK of a node in a launch, > 0
                 const uint resume,                       // 1: continues where the last launch ended
                 __local uint* local_words,               // RAYA_COUNT_WORDS words, followed by the words of a
                                                          // node if RAYA_WORDS_LOCAL is 1
                 __global raya_packet* queues,            // [node][queue]
                 __global uint* status,                   // [node][RAYA_STATUS_WORDS]
                 __global ulong* events,                  // [node][RAYA_EVENTS]: number of events so far
                 __global ulong* made,                    // [node][RAYA_KINDS]: number of packets made so far
                 __global ulong* ended,                   // [node][RAYA_KINDS]: number of packets ended so far
                 __global raya_processed* processed)      // [node][queue]; unused if RAYA_COSTS is 0
{
    const uint slot = node_slot(first_node), item = get_local_id(0);
    status += (size_t)slot * RAYA_STATUS_WORDS;
    const uint count = status[resume ? RAYA_STATUS_LEFT : RAYA_STATUS_QUEUE];
    if (resume && count == 0) return;
    packet_batch f;
    f.queue = queues + (size_t)slot * run->queue;
    f.capacity = run->queue;
    f.tight = tight;
    f.charged = run->one_return_per_ray ? 0 : RAYA_STATE_CHARGED;
    f.shared = local_words;
    init_shared(f.shared, status[RAYA_STATUS_QUEUE]);
    const node n = load_node(memories, starts, slot, local_words + RAYA_COUNT_WORDS);
#if RAYA_COSTS
    f.job = (job_words)n.memory;
    processed += (size_t)slot * run->queue;
#endif
    while (shared_add(&f.shared[RAYA_COUNT_WORK], 0) < work) {
        // Takes packets from the end of the queue, because the newest packets are there. They include the deepest rays,
        // whose trees need the fewest slots.
        const uint taken = shared_add(&f.shared[RAYA_COUNT_NEXT], RAYA_LANES);
        if (taken >= count) break;
        count_shared(f.shared, RAYA_COUNT_WORK, 1);
        const uint end = count - taken;
        process_slots(&n, &f, end > RAYA_LANES ? end - RAYA_LANES : 0, end);
#if RAYA_COSTS
        record_costs(&f, end, processed);
#endif
    }
    if (loops_were_cut(min(f.capacity, 2u))) status[RAYA_STATUS_CUT] = 1;
    node_barrier();
    if (item) return;
    status[RAYA_STATUS_LEFT] = count - min(count, (uint)f.shared[RAYA_COUNT_NEXT]);
    report_counts(&n, slot, f.shared, status, events, made, ended);
}
