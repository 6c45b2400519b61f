// accept: rays that have come over the links go into the queue of their node, as far as there is room (raya_room_of_packet); returns go straight into the
// outbox of the link home, in the root to the host. What has no room stays in the inbox, and nothing more comes over that link
// until it is empty.
//
// One work-group is one node. The inboxes are looked through one after another, another one first in every superstep; of each, L packets at a time.
#include "kernels/torus/moves.clh"

#define RAYA_TAKEN 0u  // goals
#define RAYA_LEFT_THERE 1u
#define RAYA_NOTHING 2u

// Takes what has room out of an inbox; gives how many packets. `left` of them stay, at its front. Has barriers.
static inline uint empty_inbox(__global uint* inbox, __global uint* queue, uint used, uint capacity, uint new_packets,
                               uint tight, __local uint* goals, uint* left) {
    const uint item = get_local_id(0), waiting = inbox[0];
    uint taken = 0;
    *left = 0;
    for (uint first = 0; first < waiting; first += RAYA_GROUP) {
        const uint slot = first + item;
        uint16 packet = packet_at(inbox, 1 + min(slot, waiting - 1));
        const uint room = tight ? 0 : raya_room_of_packet(new_packets, RAYA_BOUNCES, packet.s1);
        const int fits = used + taken + item + 1 + room <= capacity;
        const uint goal = slot >= waiting ? RAYA_NOTHING : fits ? RAYA_TAKEN : RAYA_LEFT_THERE;
        goals[item] = goal;
        node_barrier();
        const uint rank = rank_among(goals, goal);
        // What stays moves to a slot that this loop has read already.
        if (goal == RAYA_LEFT_THERE) put_packet(packet, inbox, 1 + *left + rank);
        packet.s1 &= ~RAYA_STATE_FRESH;
        if (goal == RAYA_TAKEN) put_packet(packet, queue, used + taken + rank);
        taken += number_of(goals, RAYA_TAKEN);
        *left += number_of(goals, RAYA_LEFT_THERE);
        node_barrier();
    }
    return taken;
}

// Passes as many of an inbox's returns on as `to` has room for, of `capacity` when `used` are there; gives how many. The others stay, at the inbox's front.
static inline uint pass_returns(__global uint* inbox, __global uint* to, uint used, uint capacity, uint* left) {
    const uint item = get_local_id(0), waiting = inbox[0], moves = min(waiting, capacity - used);
    *left = waiting - moves;
    for (uint i = item; i < moves; i += RAYA_GROUP) {
        uint8 packet = vload8(1 + i, inbox);
        packet.s1 &= ~RAYA_STATE_FRESH;
        vstore8(packet, used + i, to);
    }
    for (uint first = 0; moves > 0 && first < *left; first += RAYA_GROUP) {
        const uint i = first + item;
        const uint8 packet = vload8(1 + moves + min(i, *left - 1), inbox);
        node_barrier();
        if (i < *left) vstore8(packet, 1 + i, inbox);
        node_barrier();
    }
    return moves;
}

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void accept(__global const uint* restrict memories,     // nodes' words, one after another (kernels/shared/node.h)
            __global const uint* restrict starts,       // [node]: where its words start
            const uint capacity,                        // packets that a queue holds
            const uint box,                             // packets that a box holds
            const uint host_capacity,                   // returns that wait for the host at most
            const uint new_packets,                     // that a hit may turn into (raya_most_new_packets)
            const uint tight,                           // 1: any free slot will do
            const uint turn,                            // number of the superstep: which link comes first
            __global const uint* restrict sent,         // [link][node]: 1 where the outbox of rays of the node has been copied
            __global const uint* restrict return_sent,  // [link][node]: ... of returns
            __local uint* goals,                        // L words
            __global uint* restrict queues,             // [node][capacity][16]
            __global uint* restrict inboxes,            // of rays (kernels/shared/traffic.h)
            __global uint* restrict return_inboxes,
            __global uint* restrict return_outboxes,
            __global uint* restrict returns,            // [host_capacity][8]: those that have reached the root
            __global uint* restrict status,             // [node][RAYA_STATUS_WORDS]
            __global ulong* restrict ended)             // [node][RAYA_KINDS], added to
{
    const uint number = get_group_id(0), item = get_local_id(0), nodes = get_num_groups(0);
    const int root = number == RAYA_ROOT;
    const raya_torus torus = ((__global const raya_node*)(memories + starts[number]))->torus;
    const uint home = raya_home_link(torus, number);
    __global uint* home_box = root ? returns : return_outboxes + raya_box_at(home, nodes, number, box, RAYA_RETURN_WORDS);
    __global uint* queue = queues + (size_t)number * capacity * RAYA_PACKET_WORDS;
    status += (size_t)number * RAYA_STATUS_WORDS;
    const uint before = status[RAYA_STATUS_QUEUE];
    // The host has taken what was there, or copied it.
    const uint homeward = root || return_sent[(size_t)home * nodes + number] ? 0 : status[RAYA_STATUS_RETURN_OUTBOX + home];
    uint used = before, home_used = homeward;
    for (uint i = 0; i < RAYA_LINKS; ++i) {
        const uint link = (i + turn) % RAYA_LINKS;
        const uint start = raya_link_end(torus, number, link ^ 1);  // of the link that leads here
        __global uint* inbox = inboxes + raya_box_at(link, nodes, start, box, RAYA_PACKET_WORDS);
        __global uint* return_inbox = return_inboxes + raya_box_at(link, nodes, start, box, RAYA_RETURN_WORDS);
        uint left, returns_left;
        used += empty_inbox(inbox, queue, used, capacity, new_packets, tight, goals, &left);
        home_used += pass_returns(return_inbox, root ? home_box : home_box + RAYA_RETURN_WORDS, home_used, root ? host_capacity : box, &returns_left);
        node_barrier();
        if (item) continue;
        inbox[0] = left;
        return_inbox[0] = returns_left;
        status[RAYA_STATUS_INBOX + link] = left;
        status[RAYA_STATUS_RETURN_INBOX + link] = returns_left;
        if (sent[(size_t)link * nodes + number]) status[RAYA_STATUS_OUTBOX + link] = 0;
    }
    if (item) return;
    if (root) {
        status[RAYA_STATUS_HOST] = home_used;
        ended[RAYA_ROOT * RAYA_KINDS + RAYA_KIND_RETURN] += home_used;
    } else {
        status[RAYA_STATUS_RETURN_OUTBOX + home] = home_used;
    }
    status[RAYA_STATUS_QUEUE] = used;
    status[RAYA_STATUS_QUEUE_MAX] = max(status[RAYA_STATUS_QUEUE_MAX], used);
    // The host has looked before this kernel: what is counted from here on is for its next look.
    status[RAYA_STATUS_PROGRESS] = used - before + home_used - homeward;
    status[RAYA_STATUS_CYCLES] = status[RAYA_STATUS_CYCLES + 1] = 0;
}
