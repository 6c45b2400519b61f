// accept: removes packets that have arrived over the links from the inboxes. A ray moves to the node's queue if the
// queue has the free slots that the ray needs (raya_slots_for_packet()). A return moves to the outbox of the link
// towards the root. In the root it moves to the buffer that the host reads. A packet for which there is no free slot
// stays in its inbox. A link transfers packets only to an empty inbox.
//
// One work-group is one node. It processes one inbox after another, L packets at a time. In each superstep it starts
// with a different inbox:
//
//     for each link, from `turn` mod 6 on, until `work` batches of L packets are done:
//         move the rays that fit to the end of the queue, close the gaps in the inbox           (accept_rays)
//         move the returns that fit to the outbox towards the root, close the gaps in the inbox (forward_returns)
//         store in the node's status how many rays and how many returns stay in the inboxes
//
// The next launch (`resume` = 1) continues with the remaining inboxes.
#include "kernels/torus/moves.clh"

// The queue of the node, to which accept appends rays.
typedef struct {
    __global raya_packet* packets;
    uint used, capacity;  // number of packets in the queue; maximum number of packets in the queue
    uint new_packets;     // raya_max_new_packets() of the scene
    uint tight;           // 1: one free slot suffices for any ray
} ray_queue;

// Moves the rays that fit from an inbox to the queue, and the remaining rays to the front of the inbox. Returns the
// number of remaining rays. All work-items must call accept_rays(), because it has barriers.
static inline uint accept_rays(__global uint* inbox, ray_queue* queue, vote_words votes) {
    __global raya_packet* const rays = rays_in(inbox);
    const uint item = get_local_id(0), waiting = inbox[0];
    uint taken = 0, left = 0;
    for (uint first = 0; first < waiting; first += RAYA_GROUP) {
        const uint slot = first + item;
        ray_words packet = load_ray(rays + min(slot, waiting - 1));
        const uint free_slots =
            queue->tight ? 0 : raya_slots_for_packet(queue->new_packets, RAYA_BOUNCES, state_of(packet.lo));
        const int fits = queue->used + taken + item + 1 + free_slots <= queue->capacity;
        const uint goal = slot >= waiting ? RAYA_NOTHING : fits ? RAYA_TAKEN : RAYA_LEFT_THERE;
        vote(votes, goal);
        node_barrier();
        const uint position = votes_before(votes, goal);
        // The packet may overwrite its new slot, because this or an earlier iteration has read that slot.
        if (goal == RAYA_LEFT_THERE) store_ray(rays + left + position, packet);
        packet.lo = without_flag(packet.lo, RAYA_STATE_FRESH);
        if (goal == RAYA_TAKEN) store_ray(queue->packets + queue->used + taken + position, packet);
        taken += votes_for(votes, RAYA_TAKEN, goal);
        left += votes_for(votes, RAYA_LEFT_THERE, goal);
        node_barrier();
        clear_votes(votes, RAYA_ACCEPT_GOALS);
        node_barrier();
    }
    queue->used += taken;
    return left;
}

// Moves as many returns as fit from an inbox to `to` (an outbox's packets or the host's buffer), which has space for
// `capacity` returns and holds `used`. Moves the remaining returns to the front of the inbox, and sets `left`
// to their number. Adds to `charged` the number of moved returns that the model charges as messages. Returns the number
// of moved returns. All work-items must call forward_returns(), because it has barriers.
static inline uint forward_returns(__global uint* inbox, __global raya_head* to, uint used, uint capacity, uint* left,
                                volatile __local uint* charged) {
    __global raya_head* const returns = returns_in(inbox);
    const uint item = get_local_id(0), waiting = inbox[0], moves = min(waiting, capacity - used);
    *left = waiting - moves;
    for (uint i = item; i < moves; i += RAYA_GROUP) {
        const head_words packet = load_head(returns + i);
        store_head(to + used + i, without_flag(packet, RAYA_STATE_FRESH));
        if (state_of(packet) & RAYA_STATE_CHARGED) shared_add(charged, 1);
    }
    for (uint first = 0; moves > 0 && first < *left; first += RAYA_GROUP) {
        const uint i = first + item;
        const head_words packet = load_head(returns + moves + min(i, *left - 1));
        node_barrier();
        if (i < *left) store_head(returns + i, packet);
        node_barrier();
    }
    return moves;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void accept(__global const uint* restrict memories,     // the words of all nodes (kernels/shared/node.h)
            __global const uint* restrict starts,       // [nodes + 1]: offset of each node's words
            __global const raya_run* restrict run,
            const uint tight,                           // 1: one free slot suffices for any ray
            const uint turn,                            // number of the superstep; selects the first link
            const uint first_node,                      // slot of the node that is work-group 0
            __global const uint* restrict inbox_slots,  // [link][node]: inbox of the link that ends at the node
            __global const uint* restrict sent,         // [link][node]: 1 if the outbox of rays has been copied
            __global const uint* restrict return_sent,  // [link][node]: 1 if the outbox of returns has been copied
            const uint work,                            // maximum work of a node in a launch, batches of L packets, > 0
            const uint resume,                          // 1: continues where the last launch ended
            __local uint* local_words,                  // RAYA_ACCEPT_WORDS
            __global raya_packet* queues,               // [node][queue]
            __global uint* inboxes,                     // of rays (kernels/shared/traffic.h)
            __global uint* return_inboxes,
            __global uint* return_outboxes,
            __global raya_head* returns,                // [run->host]: returns that have reached the root
            __global uint* status,                      // [node][RAYA_STATUS_WORDS]
            __global ulong* ended)                      // [node][RAYA_KINDS]: number of packets ended so far
{
    const uint slot = node_slot(first_node), item = get_local_id(0), nodes = run->nodes, box = run->box;
    __global const raya_node* const header = (__global const raya_node*)(memories + starts[slot]);
    const int root = header->number == RAYA_ROOT;
    const uint root_link = raya_return_link(header->torus, header->number);
    __global uint* const root_outbox = return_outboxes + raya_box_at(root_link, nodes, slot, box, RAYA_RETURN_WORDS);
    __global raya_head* const return_target = root ? returns : returns_in(root_outbox);
    status += (size_t)slot * RAYA_STATUS_WORDS;
    if (resume && !status[RAYA_STATUS_LEFT]) return;
    const uint before = status[RAYA_STATUS_QUEUE], done = resume ? RAYA_LINKS - status[RAYA_STATUS_LEFT] : 0;
    ray_queue queue = {queues + (size_t)slot * run->queue, before, run->queue,
                        raya_max_new_packets(header->job.lights), tight};
    // 1: the returns now in the outbox have been copied over the link or, in the root, read by the host.
    const int already_sent = !resume && (root || return_sent[(size_t)root_link * nodes + slot]);
    const uint returns_status = root ? RAYA_STATUS_HOST : RAYA_STATUS_RETURN_OUTBOX + root_link;
    const uint returns_before = already_sent ? 0 : status[returns_status];
    uint returns_used = returns_before, spent = 0, i = done;
    volatile __local uint* const charged = local_words;
    const vote_words votes = charged + 1;
    clear_votes(votes, RAYA_ACCEPT_GOALS);
    if (item == 0) *charged = already_sent ? 0 : status[RAYA_STATUS_RETURN_CHARGED];
    node_barrier();
    for (; i < RAYA_LINKS && spent < work; ++i) {
        const uint link = (i + turn) % RAYA_LINKS;
        const uint inbox_slot = inbox_slots[(size_t)link * nodes + slot];
        __global uint* inbox = inboxes + raya_box_at(link, run->inboxes, inbox_slot, box, RAYA_PACKET_WORDS);
        __global uint* return_inbox =
            return_inboxes + raya_box_at(link, run->inboxes, inbox_slot, box, RAYA_RETURN_WORDS);
        spent += 1 + (inbox[0] + return_inbox[0]) / RAYA_GROUP;
        const uint left = accept_rays(inbox, &queue, votes);
        uint returns_left;
        returns_used += forward_returns(return_inbox, return_target, returns_used, root ? run->host : box,
                                        &returns_left, charged);
        node_barrier();
        if (item) continue;
        inbox[0] = left;
        return_inbox[0] = returns_left;
        status[RAYA_STATUS_INBOX + link] = left;
        status[RAYA_STATUS_RETURN_INBOX + link] = returns_left;
        if (sent[(size_t)link * nodes + slot]) status[RAYA_STATUS_OUTBOX + link] = 0;
    }
    if (loops_were_cut(min(run->queue, 2u))) status[RAYA_STATUS_CUT] = 1;
    if (item) return;
    if (root) ended[(size_t)slot * RAYA_KINDS + RAYA_KIND_RETURN] += returns_used - returns_before;
    else status[RAYA_STATUS_RETURN_CHARGED] = *charged;
    status[returns_status] = returns_used;
    status[RAYA_STATUS_QUEUE] = queue.used;
    status[RAYA_STATUS_QUEUE_MAX] = max(status[RAYA_STATUS_QUEUE_MAX], queue.used);
    status[RAYA_STATUS_LEFT] = RAYA_LINKS - i;
    // The host has read the status before the superstep's first launch of accept, so progress and cycles restart at 0.
    const uint progress = resume ? status[RAYA_STATUS_PROGRESS] : 0;
    status[RAYA_STATUS_PROGRESS] = progress + queue.used - before + returns_used - returns_before;
    status[RAYA_STATUS_CYCLES] = status[RAYA_STATUS_CYCLES + 1] = 0;
}
