// exchange: what nodes have put into their outboxes comes into the inboxes at the other ends of their links: all boxes
// of one cargo, rays or returns, in one launch. It does what copies between the two buffers do
// (host/torus/link_exchange.cpp), where a device takes longer to begin a copy than to move a box.
//
// One work-group is one box, of link g / nodes and slot g mod nodes. Where the outbox holds packets and the inbox at
// the link's other end is empty:
//
//     work-item i copies units i, i + L, ... of header and packets, 8 words each
//     `sent` is set; else it is cleared
//
// Links that lead to another rank's device, or back to their own node, are left out: the host sends what goes over the
// former, and says so in `sent` itself.
#include "kernels/shared/loop_canary.clh"
#include "kernels/shared/traffic.h"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: work-items in the work-group of a box, 1..1024
#endif

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void exchange(__global const uint* restrict ends,      // [link][node]: slot of the node at the link's other end;
                                                       // RAYA_NO_SLOT: left out
              const uint nodes,                        // on the device
              const uint inboxes_of_link,              // on the device, of each link
              const uint capacity,                     // packets that a box holds
              const uint packet_words,                 // of one: 8 or 16
              const uint outbox_status,                // where a node's status has the counts of its outboxes,
              const uint inbox_status,                 // ... of its inboxes
              __global const uint* restrict outboxes,  // (kernels/shared/traffic.h)
              __global uint* restrict inboxes,
              __global uint* restrict sent,            // [link][node]: 1 where an outbox has been copied
              __global uint* restrict status)          // [node][RAYA_STATUS_WORDS]
{
    const uint box = get_group_id(0), link = box / nodes, slot = box % nodes, item = get_local_id(0), end = ends[box];
    if (end == RAYA_NO_SLOT) return;
    const uint packets = status[slot * RAYA_STATUS_WORDS + outbox_status + link];
    const int goes = packets > 0 && status[end * RAYA_STATUS_WORDS + inbox_status + link] == 0;
    if (item == 0) sent[box] = goes;
    if (!goes) return;
    const ulong from_at = raya_box_at(link, nodes, slot, capacity, packet_words);
    const ulong to_at = raya_box_at(link, inboxes_of_link, slot, capacity, packet_words);
    __global const uint8* const from = (__global const uint8*)(outboxes + from_at);
    __global uint8* const to = (__global uint8*)(inboxes + to_at);
    const uint units = (1 + packets) * (packet_words / 8);
    for (uint i = item; i < units; i += RAYA_GROUP) to[i] = from[i];
    if (loops_were_cut(min(units, 2u))) status[slot * RAYA_STATUS_WORDS + RAYA_STATUS_CUT] = 1;
}
