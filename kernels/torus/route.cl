// route: moves packets from the queue to the outboxes (the communication task in Yoshitani & Yamazaki). A ray
// whose next voxel belongs to another node moves to the outbox of the next link on its route. A return moves to the
// outbox of the link towards the root. In the root it moves to the buffer that the host reads.
//
// One work-group is one node. L packets at a time, in the order of the queue:
//
//     find each packet's goal (torus/moves.clh); if the goal is a full outbox, the packet stays in the queue
//     move the packets to their goals; close the gaps in the queue
//
// A launch ends after `work` batches of L packets. The next launch (`resume` = 1) continues with the remaining packets.
// Packets that stay in the queue move to its front; the last launch sets the queue's new length.
//
// Routes are those of raya_next_link() and raya_return_link() (kernels/shared/torus.h).
#include "kernels/torus/moves.clh"

// Returns the goal of a packet in this node's queue (kernels/shared/node_counts.h).
static inline uint goal_of(const node* n, head_words packet) {
    const uint kind = raya_state_kind(state_of(packet));
    if (kind == RAYA_KIND_NONE) return RAYA_GONE;
    if (kind == RAYA_KIND_RETURN) return RAYA_TO_ROOT;
    if (voxel_of(packet) == RAYA_NO_VOXEL) return RAYA_STAYS;
    const raya_place voxel = raya_unpack_place(voxel_of(packet));
    if (holds_voxel(n, voxel)) return RAYA_STAYS;
    const raya_place to = holder_of(n, voxel);
    return raya_next_link(n->torus, n->number, raya_node_of(n->torus, to.at[0], to.at[1], to.at[2]));
}

// Adds the votes of L packets to `used`, [goal]: number of used slots. A packet's vote for a full outbox remains set
// although the packet stays in the queue. So a count may exceed the outbox's capacity, and the caller must limit it.
static inline void count_votes(volatile __local uint* used, vote_words votes, uint goal) {
#if RAYA_GROUP == 1
    ++used[goal];
#else
    for (uint g = get_local_id(0); g < RAYA_GOALS; g += RAYA_GROUP) used[g] += votes_for(votes, g, goal);
#endif
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void route(__global const uint* restrict memories,   // as in trace_voxel
           __global const uint* restrict starts,
           __global const raya_run* restrict run,
           const uint first_node,
           const uint work,                          // maximum work of a node in a launch, batches of L packets, > 0
           const uint resume,                        // 1: continues where the last launch ended
           __local uint* local_words,                // RAYA_ROUTE_WORDS words, followed by the words of a node
                                                     // if RAYA_WORDS_LOCAL is 1
           __global raya_packet* queues,             // [node][queue]
           __global uint* outboxes,                  // of rays (kernels/shared/traffic.h)
           __global uint* return_outboxes,
           __global raya_head* returns,              // [run->host]: returns that have reached the root
           __global uint* status,                    // [node][RAYA_STATUS_WORDS]
           __global ulong* ended)                    // [node][RAYA_KINDS]: number of packets ended so far
{
    const uint slot = node_slot(first_node), item = get_local_id(0), nodes = run->nodes, box = run->box;
    volatile __local uint *const used = local_words, *const charged = used + RAYA_GOALS;
    const vote_words votes = charged + 1;
    clear_votes(votes, RAYA_GOALS);
    status += (size_t)slot * RAYA_STATUS_WORDS;
    if (resume && !status[RAYA_STATUS_LEFT]) return;
    __global raya_packet* const queue = queues + (size_t)slot * run->queue;
    const uint count = status[RAYA_STATUS_QUEUE], start = resume ? count - status[RAYA_STATUS_LEFT] : 0;
    const uint end = work < (count - start) / RAYA_GROUP ? start + work * RAYA_GROUP : count;
    const node n = load_node(memories, starts, slot, local_words + RAYA_ROUTE_WORDS(RAYA_GROUP));
    const int root = n.number == RAYA_ROOT;
    const uint root_link = raya_return_link(n.torus, n.number);
    const uint returns_status = root ? RAYA_STATUS_HOST : RAYA_STATUS_RETURN_OUTBOX + root_link;
    const uint returns_before = status[returns_status], returns_limit = root ? run->host : box;
    __global uint* const root_outbox = return_outboxes + raya_box_at(root_link, nodes, slot, box, RAYA_RETURN_WORDS);
    __global raya_head* const return_target = root ? returns : returns_in(root_outbox);
    if (item == 0) {
        for (uint link = 0; link < RAYA_LINKS; ++link) used[link] = status[RAYA_STATUS_OUTBOX + link];
        used[RAYA_TO_ROOT] = returns_before;
        used[RAYA_STAYS] = resume ? status[RAYA_STATUS_KEPT] : 0;
        used[RAYA_GONE] = 0;
        *charged = status[RAYA_STATUS_RETURN_CHARGED];
    }
    node_barrier();
    for (uint first = start; first < end; first += RAYA_GROUP) {
        const uint at = first + item;
        const ray_words packet = load_ray(queue + min(at, end - 1));
        uint goal = at < end ? goal_of(&n, packet.lo) : RAYA_GONE;
        vote(votes, goal);
        node_barrier();
        const uint limit = goal < RAYA_TO_ROOT ? box : goal == RAYA_TO_ROOT ? returns_limit : UINT_MAX;
        if (used[goal] + votes_before(votes, goal) >= limit) goal = RAYA_STAYS;
        node_barrier();
        vote(votes, goal);
        node_barrier();
        const uint to = used[goal] + votes_before(votes, goal);
        // The packet may overwrite slot `to` of the queue, because this or an earlier iteration has read that slot.
        if (goal == RAYA_STAYS) store_ray(queue + to, packet);
        if (goal == RAYA_TO_ROOT) store_head(return_target + to, packet.lo);
        if (goal == RAYA_TO_ROOT && state_of(packet.lo) & RAYA_STATE_CHARGED) shared_add(charged, 1);
        if (goal < RAYA_LINKS)
            store_ray(rays_in(outboxes + raya_box_at(goal, nodes, slot, box, RAYA_PACKET_WORDS)) + to, packet);
        node_barrier();
        count_votes(used, votes, goal);
        node_barrier();
        clear_votes(votes, RAYA_GOALS);
        node_barrier();
    }
    if (loops_were_cut(min(run->queue, 2u))) status[RAYA_STATUS_CUT] = 1;
    if (item) return;
    const uint returns_used = min(used[RAYA_TO_ROOT], returns_limit);
    uint moved = returns_used - returns_before;
    for (uint link = 0; link < RAYA_LINKS; ++link) {
        const uint link_used = min(used[link], box);
        moved += link_used - status[RAYA_STATUS_OUTBOX + link];
        status[RAYA_STATUS_OUTBOX + link] = link_used;
        outboxes[raya_box_at(link, nodes, slot, box, RAYA_PACKET_WORDS)] = link_used;
    }
    if (root) ended[(size_t)slot * RAYA_KINDS + RAYA_KIND_RETURN] += returns_used - returns_before;
    if (!root) root_outbox[0] = returns_used;
    status[returns_status] = returns_used;
    status[RAYA_STATUS_RETURN_CHARGED] = root ? 0 : *charged;
    status[RAYA_STATUS_LEFT] = count - end;
    status[RAYA_STATUS_KEPT] = used[RAYA_STAYS];
    if (end == count) status[RAYA_STATUS_QUEUE] = used[RAYA_STAYS];
    status[RAYA_STATUS_PROGRESS] += moved;
}
