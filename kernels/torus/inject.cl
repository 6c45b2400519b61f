// inject: nodes make the packets of primary rays.
//
// One work-group is one node. If the root makes all primary rays, it processes all pixels and the remaining nodes do
// nothing. If all nodes make primary rays, a ray that enters the box belongs to the node that holds the ray's first
// voxel. A ray that misses the box belongs to node (row mod number of nodes). A node makes the rays of all pixels in
// its window and in its rows (torus/primaries.clh), and discards rays that belong to other nodes. Making a discarded
// ray takes time, so the kernel counts discarded rays (RAYA_DISCARDED).
//
//     from the node's next pixel on, L x V pixels of a row at a time:
//         make their rays and find their first voxels                      (geometry/ray.clh, grid/traversal.clh)
//         append the rays that belong to the node to the queue, as many as fit
//         the next pixel is the first whose ray did not fit
//
// A node makes rays until an eighth of its queue is in use, so that slots remain free for arriving packets and for
// packets of secondary rays. It always leaves as many slots free as the tree of one ray needs. A launch also ends when
// a node has done its `work`. The next launch (`resume` = 1) continues at the next pixel.
#include "kernels/torus/moves.clh"
#include "kernels/torus/primaries.clh"

#define RAYA_STEP (RAYA_GROUP * RAYA_LANES)

// The queue to which a node appends primary rays, and the state that its work-items share.
typedef struct {
    __global raya_packet* packets;  // the queue
    uint max_packets;               // the node appends rays until the queue holds this many packets
    shared_words shared;            // RAYA_COUNT_WORDS
    shared_words next;              // [1]: next pixel of the row
    vote_words own_bits;            // a bit for each ray, 1 if it belongs to the node; lane l of item i: bit i V + l
    uint work, spent;               // maximum work of a node in the launch; work done so far. Unit: a batch of up to
                                    // L V pixels, or a row
} injection;

// Appends the lanes' rays that belong to the node to the queue, from slot `at` on, as many as fit. Lane l has pixel
// first + l of the row. Returns the index in the row of the first pixel whose ray did not fit; `end` if all rays fit.
static inline uint put_primaries(const primaries* p, const injection* to, uint at, uint first, uint end) {
    const lanes_index own_rays = {.truth = p->own_rays}, meets = {.truth = p->meets};
    uint met = 0, made = 0, first_waiting = end;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!own_rays.lane[lane]) continue;
        if (at + made >= to->max_packets) {
            first_waiting = first + lane;
            break;
        }
        put_primary(to->packets + at + made, p, lane);
        ++made;
        met += meets.lane[lane] & 1u;
    }
    count_shared(to->shared, RAYA_COUNT_USED, made);
    count_shared(to->shared, RAYA_COUNT_MADE + RAYA_KIND_PRIMARY, made);
    count_shared(to->shared, RAYA_COUNT_PROGRESS, made);
    count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_PRIMARY, made);
    count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_WALKS, met);
    return first_waiting;
}

// Returns how many of the lanes' rays belong to other nodes. Counts only rays of pixels before `next`, because the node
// will make the rays of later pixels again.
static inline uint number_of_discarded(const primaries* p, uint first, uint next) {
    const lanes_index own_rays = {.truth = p->own_rays};
    uint number = 0;
    for (uint lane = 0; lane < RAYA_LANES && first + lane < next; ++lane) number += !own_rays.lane[lane];
    return number;
}

// Makes the rays of the row from its pixel `at` on until the queue has `max_packets` packets or the node has done its
// work. Returns the index of the next pixel. All work-items must call make_row(), because it has barriers.
static inline uint make_row(const node* n, pixel_row row, uint at, uint stride, injection* to) {
    const uint item = get_local_id(0);
    shared_words used = to->shared + RAYA_COUNT_USED, next = to->next;
    for (; at < row.count && *used < to->max_packets && to->spent < to->work; ++to->spent) {
        const uint first = at + item * RAYA_LANES, end = min(row.count, at + RAYA_STEP), before = *used;
        const primaries p = make_primaries(n, row, first, stride);
        set_bits(to->own_bits, item * RAYA_LANES, mask_bits(p.own_rays));
        if (item == 0) *next = end;
        node_barrier();
        const uint slot = before + bits_before(to->own_bits, item * RAYA_LANES);
        const uint first_waiting = put_primaries(&p, to, slot, first, end);
        if (first_waiting < end) atomic_min(next, first_waiting);
        node_barrier();
        at = *next;
        count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_DISCARDED, number_of_discarded(&p, first, at));
        clear_bits(to->own_bits, RAYA_VOTE_WORDS(RAYA_STEP));
        node_barrier();
    }
    return at;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void inject(__global const uint* restrict memories,  // for parameters without a comment see trace_voxel
            __global const uint* restrict starts,
            __global const raya_run* restrict run,
            const uint first_node,
            const uint work,                         // as in `injection`, > 0
            const uint resume,
            __local uint* local_words,               // RAYA_INJECT_WORDS words, followed by the words of a node
                                                     // if RAYA_WORDS_LOCAL is 1
            __global raya_packet* queues,
            __global uint* status,
            __global ulong* events,
            __global ulong* made,
            __global ulong* ended)
{
    const uint slot = node_slot(first_node), item = get_local_id(0), capacity = run->queue;
    injection to;
    to.packets = queues + (size_t)slot * capacity;
    to.shared = local_words;
    to.next = local_words + RAYA_COUNT_WORDS;
    to.own_bits = to.next + 1;
    to.work = work;
    to.spent = 0;
    status += (size_t)slot * RAYA_STATUS_WORDS;
    if (resume && !status[RAYA_STATUS_LEFT]) return;
    init_shared(to.shared, status[RAYA_STATUS_QUEUE]);
    clear_bits(to.own_bits, RAYA_VOTE_WORDS(RAYA_STEP));
    const node n = load_node(memories, starts, slot, local_words + RAYA_INJECT_WORDS(RAYA_GROUP, RAYA_LANES));
    const uint tree_slots = raya_slots_for_ray(raya_max_new_packets(((job_words)n.memory)->lights), RAYA_BOUNCES, 0);
    to.max_packets = min(max(capacity / 8, 1u), capacity - tree_slots);
    const uint root = run->root_injects, stride = run->stride, rows = rows_of(&n, root);
    uint i = status[RAYA_STATUS_NEXT_ROW], at = status[RAYA_STATUS_NEXT_COLUMN];
    for (; i < rows && to.spent < work; ++to.spent) {
        const pixel_row row = row_of(&n, i, stride, run->offset, root);
        at = make_row(&n, row, at, stride, &to);
        if (at < row.count) break;
        at = 0;
        ++i;
    }
    if (loops_were_cut(min(capacity, 2u))) status[RAYA_STATUS_CUT] = 1;
    node_barrier();
    if (item) return;
    status[RAYA_STATUS_LEFT] = i < rows && to.spent >= work;
    status[RAYA_STATUS_NEXT_ROW] = i;
    status[RAYA_STATUS_NEXT_COLUMN] = at;
    status[RAYA_STATUS_ROWS] = rows;
    report_counts(&n, slot, to.shared, status, events, made, ended);
}
