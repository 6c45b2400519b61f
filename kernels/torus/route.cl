// route: rays that are in voxels of other nodes go into the outbox of the link that leads towards them; returns go into
// that of the link home, in the root to the host (Yoshitani & Yamazaki, method: the communication task).
//
// One work-group is one node. L packets at a time, in the order of the queue:
//
//     find each packet's goal: the outbox of a link, the way home, or this node's queue
//     a packet for which there is no room stays in the queue until the next superstep
//     close the gaps that were left in the queue
//
// The rules of the ways are raya_next_link's and raya_home_link's (kernels/shared/torus.h).
#include "kernels/shared/node_counts.h"
#include "kernels/torus/moves.clh"

// Where a packet of this node goes.
static inline uint goal_of(const node* n, const raya_head* packet) {
    const uint kind = raya_state_kind(packet->state);
    if (kind == RAYA_KIND_NONE) return RAYA_GONE;
    if (kind == RAYA_KIND_RETURN) return RAYA_HOME;
    if (packet->voxel == RAYA_NO_VOXEL) return RAYA_STAYS;
    const raya_place voxel = raya_unpack_place(packet->voxel);
    if (is_own(n, voxel)) return RAYA_STAYS;
    const raya_place to = holder_of(n, voxel);
    return raya_next_link(n->torus, n->number, raya_node_of(n->torus, to.at[0], to.at[1], to.at[2]));
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void route(__global const uint* restrict memories,   // as for trace_voxel
           __global const uint* restrict starts,
           __global const raya_run* restrict run,
           const uint first_node,
           __local uint* local_words,                // RAYA_ROUTE_WORDS + L, then, where RAYA_WORDS_LOCAL is 1, the
                                                     // words of a node
           __global raya_packet* restrict queues,    // [node][queue]
           __global uint* restrict outboxes,         // of rays (kernels/shared/traffic.h)
           __global uint* restrict return_outboxes,
           __global raya_head* restrict returns,     // [host]: those that have reached the root
           __global uint* restrict status,           // [node][RAYA_STATUS_WORDS]
           __global ulong* restrict ended)           // [node][RAYA_KINDS], added to
{
    const uint slot = node_slot(first_node), item = get_local_id(0), nodes = run->nodes, box = run->box;
    __local uint *used = local_words, *limit = used + RAYA_GOALS, *goals = limit + RAYA_GOALS;
    __local uint *moved = goals + RAYA_GROUP, *charged = moved + 1;
    status += (size_t)slot * RAYA_STATUS_WORDS;
    __global raya_packet* const queue = queues + (size_t)slot * run->queue;
    const uint count = status[RAYA_STATUS_QUEUE];
    const node n = open_node(memories, starts, slot, local_words + RAYA_ROUTE_WORDS + RAYA_GROUP);
    const int root = n.number == RAYA_ROOT;
    const uint home = raya_home_link(n.torus, n.number);
    const uint home_status = root ? RAYA_STATUS_HOST : RAYA_STATUS_RETURN_OUTBOX + home;
    __global uint* const home_box = return_outboxes + raya_box_at(home, nodes, slot, box, RAYA_RETURN_WORDS);
    __global raya_head* const homeward = root ? returns : returns_in(home_box);
    if (item == 0) {
        for (uint link = 0; link < RAYA_LINKS; ++link) {
            used[link] = status[RAYA_STATUS_OUTBOX + link];
            limit[link] = box;
        }
        used[RAYA_HOME] = status[home_status];
        limit[RAYA_HOME] = root ? run->host : box;
        used[RAYA_STAYS] = used[RAYA_GONE] = *moved = 0;
        *charged = status[RAYA_STATUS_RETURN_CHARGED];
    }
    for (uint first = 0; first < count; first += RAYA_GROUP) {
        const uint at = first + item;
        const raya_packet packet = queue[min(at, count - 1)];
        uint goal = at < count ? goal_of(&n, &packet.head) : RAYA_GONE;
        goals[item] = goal;
        node_barrier();
        const int fits = goal >= RAYA_STAYS || used[goal] + rank_among(goals, goal) < limit[goal];
        node_barrier();
        if (!fits) goal = RAYA_STAYS;
        goals[item] = goal;
        node_barrier();
        const uint place = goal < RAYA_GONE ? used[goal] + rank_among(goals, goal) : 0;
        // Packets that stay move to a slot that this loop has read already.
        if (goal == RAYA_STAYS) queue[place] = packet;
        if (goal == RAYA_HOME) homeward[place] = packet.head;
        if (goal == RAYA_HOME && packet.head.state & RAYA_STATE_CHARGED) shared_add(charged, 1);
        if (goal < RAYA_LINKS)
            rays_in(outboxes + raya_box_at(goal, nodes, slot, box, RAYA_PACKET_WORDS))[place] = packet;
        node_barrier();
        if (item == 0) {
            for (uint g = 0; g < RAYA_GONE; ++g) {
                const uint here = number_of(goals, g);
                used[g] += here;
                *moved += g < RAYA_STAYS ? here : 0;
            }
        }
        node_barrier();
    }
    if (item) return;
    for (uint link = 0; link < RAYA_LINKS; ++link) {
        status[RAYA_STATUS_OUTBOX + link] = used[link];
        outboxes[raya_box_at(link, nodes, slot, box, RAYA_PACKET_WORDS)] = used[link];
    }
    if (root) ended[(size_t)slot * RAYA_KINDS + RAYA_KIND_RETURN] += used[RAYA_HOME] - status[home_status];
    if (!root) home_box[0] = used[RAYA_HOME];
    status[home_status] = used[RAYA_HOME];
    status[RAYA_STATUS_RETURN_CHARGED] = root ? 0 : *charged;
    status[RAYA_STATUS_QUEUE] = used[RAYA_STAYS];
    status[RAYA_STATUS_PROGRESS] += *moved;
}
