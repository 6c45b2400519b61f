// inject: nodes make the packets of primary rays, as long as their queues are short.
//
// One work-group is one node. Where the root makes all rays, it takes all pixels in turn and the other nodes do
// nothing. Else every node makes the rays that enter the box at one of its voxels: it looks at the window of
// pixels where they must lie, which the host has given it, and keeps those that do. Rays that miss the box belong
// to the row's node: row mod nodes. A ray that is made and thrown away is work too, and counted (RAYA_DISCARDED).
//
//     from the node's next pixel on, L x V pixels of a row at a time:
//         make their rays and find their first voxels                      (shading/camera.clh, grid/walk.clh)
//         count the node's own; where they do not all fit, keep the first that do
//         put them into the queue; the next pixel is the first that has to wait
//
// Rays are made until an eighth of the queue is in use, and never in the room that a ray's tree asks for: packets that
// arrive and packets that hits turn into find room.
#include "kernels/shading/camera.clh"
#include "kernels/torus/flight.clh"
#include "kernels/torus/pixel_rows.clh"

#define RAYA_STEP (RAYA_GROUP * RAYA_LANES)

// The primary rays of pixels first .. first + V - 1 of the row, and which of them the node makes.
typedef struct {
    ray r;
    index pixel, place;
    mask own, meets;
} primaries;

static inline primaries make_primaries(const node* n, pixel_row row, uint first, uint stride) {
    const job_words job = (job_words)n->memory;
    primaries p;
    lanes_index own, place, pixel;
    lanes_real column;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        const uint at = row.column + (first + lane) * stride;
        own.lane[lane] = first + lane < row.count ? RAYA_TRUE : 0;
        pixel.lane[lane] = row.row * job->mapping.width + at;
        column.lane[lane] = at;
    }
    p.pixel = pixel.all;
    p.r.origin = vec_all(job->eye);
    p.r.direction = primary_direction(job, num_all((float)row.row), column.all);
    p.r.limit = num_const(RAYA_FAR);
    const voxel_walk w = enter_grid(n->grid, p.r, own.truth);
    p.meets = w.voxel != RAYA_NO_VOXEL;
    place.all = p.place = pack_places(&w);
    own.truth &= (p.meets & mask_all(row.hits)) | (mask_not(p.meets) & mask_all(row.misses));
    if (!row.misses)
        for (uint lane = 0; lane < RAYA_LANES; ++lane)
            if (own.lane[lane] && !is_own(n, raya_unpack_place(place.lane[lane]))) own.lane[lane] = 0;
    p.own = own.truth;
    return p;
}

static inline void put_primary(__global raya_packet* packet, const primaries* p, uint lane) {
    lanes_index pixel, place;
    const lanes_vec o = lanes_of_vec(p->r.origin), d = lanes_of_vec(p->r.direction);
    lanes_real limit;
    pixel.all = p->pixel;
    place.all = p->place;
    limit.all = p->r.limit;
    packet->head.pixel = pixel.lane[lane];
    packet->head.state = RAYA_KIND_PRIMARY | RAYA_STATE_FRESH;
    packet->head.path = 0;
    packet->head.weight = 1.0f;
    packet->head.carries.nearest.voxel = RAYA_NO_VOXEL;
    packet->head.voxel = place.lane[lane];
    put_vec(packet->origin, &o, lane);
    put_vec(packet->direction, &d, lane);
    packet->limit = limit.lane[lane];
}

// Where a node puts its primary rays, and what its work-items share while they do.
typedef struct {
    __global raya_packet* packets;  // its queue
    uint most;                      // packets that may be in it
    shared_words shared;            // RAYA_COUNT_WORDS
    shared_words own;               // rays of each work-item, and the next pixel to look at
} injection;

// Puts the lanes' own rays, of pixels `first` to `end` - 1 of the row, into the queue from slot `at` on, as many as
// there is room for. Returns the number in the row of the first pixel that has to wait, `end` if none does.
static inline uint put_primaries(const primaries* p, const injection* to, uint at, uint first, uint end) {
    lanes_index own, meets;
    own.truth = p->own;
    meets.truth = p->meets;
    uint met = 0, made = 0, waits = end;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) {
        if (!own.lane[lane]) continue;
        if (at + made >= to->most) {
            waits = first + lane;
            break;
        }
        put_primary(to->packets + at + made, p, lane);
        ++made;
        met += meets.lane[lane] & 1u;
    }
    count_shared(to->shared, RAYA_COUNT_MADE + RAYA_KIND_PRIMARY, made);
    count_shared(to->shared, RAYA_COUNT_PROGRESS, made);
    count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_PRIMARY, made);
    count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_WALKS, met);
    return waits;
}

// How many rays of the lanes are not the node's, of the pixels before `next`: those behind are made again.
static inline uint discarded(const primaries* p, uint first, uint next) {
    lanes_index own;
    own.truth = p->own;
    uint number = 0;
    for (uint lane = 0; lane < RAYA_LANES && first + lane < next; ++lane) number += !own.lane[lane];
    return number;
}

// Makes rays of the row from its pixel `at` on until the queue has `most` packets; returns the next pixel to look at.
// Has barriers.
static inline uint make_row(const node* n, pixel_row row, uint at, uint stride, const injection* to) {
    const uint item = get_local_id(0);
    shared_words used = to->shared + RAYA_COUNT_USED, next = to->own + RAYA_GROUP;
    while (at < row.count && *used < to->most) {
        const uint first = at + item * RAYA_LANES, end = min(row.count, at + RAYA_STEP), before = *used;
        const primaries p = make_primaries(n, row, first, stride);
        to->own[item] = mask_count(p.own);
        if (item == 0) *next = end;
        node_barrier();
        uint behind = 0, all = 0;  // rays of the work-items before this one, of all
        for (uint i = 0; i < RAYA_GROUP; ++i) {
            if (i < item) behind += to->own[i];
            all += to->own[i];
        }
        const uint waits = put_primaries(&p, to, before + behind, first, end);
        if (waits < end) atomic_min(next, waits);
        node_barrier();
        at = *next;
        count_shared(to->shared, RAYA_COUNT_EVENTS + 2 * RAYA_DISCARDED, discarded(&p, first, at));
        if (item == 0) *used = min(before + all, to->most);
        node_barrier();
    }
    return at;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void inject(__global const uint* restrict memories,  // as for trace_voxel, and all that is not explained here
            __global const uint* restrict starts,
            __global const raya_run* restrict run,
            const uint first_node,
            __local uint* local_words,               // RAYA_COUNT_WORDS + L + 1, then, where RAYA_WORDS_LOCAL is 1,
                                                     // the words of a node
            __global raya_packet* restrict queues,
            __global uint* restrict status,
            __global ulong* restrict events,
            __global ulong* restrict made,
            __global ulong* restrict ended)
{
    const uint slot = node_slot(first_node), item = get_local_id(0), capacity = run->queue;
    injection to;
    to.packets = queues + (size_t)slot * capacity;
    to.shared = local_words;
    to.own = local_words + RAYA_COUNT_WORDS;
    status += (size_t)slot * RAYA_STATUS_WORDS;
    open_shared(to.shared, status[RAYA_STATUS_QUEUE]);
    const node n = open_node(memories, starts, slot, local_words + RAYA_COUNT_WORDS + RAYA_GROUP + 1);
    const uint room = raya_room_of_ray(raya_most_new_packets(((job_words)n.memory)->lights), RAYA_BOUNCES, 0);
    to.most = min(max(capacity / 8, 1u), capacity - room);
    const uint root = run->root_injects, stride = run->stride, rows = rows_of(&n, root);
    uint i = status[RAYA_STATUS_NEXT_ROW], at = status[RAYA_STATUS_NEXT_COLUMN];
    while (i < rows) {
        const pixel_row row = row_of(&n, i, stride, run->offset, root);
        at = make_row(&n, row, at, stride, &to);
        if (at < row.count) break;
        at = 0;
        ++i;
    }
    node_barrier();
    if (item) return;
    status[RAYA_STATUS_NEXT_ROW] = i;
    status[RAYA_STATUS_NEXT_COLUMN] = at;
    status[RAYA_STATUS_ROWS] = rows;
    report_counts(&n, slot, to.shared, status, events, made, ended);
}
