// exchange: copies the outboxes to the inboxes at the other ends of their links, all mailboxes of rays or of returns in
// one launch. It replaces buffer copies (host/torus/link_exchange.cpp) on devices that take longer to start a copy than
// to move a mailbox.
//
// One work-group is one outbox: work-group g that of link g / nodes and slot g mod nodes. If the outbox holds packets
// and the inbox at the link's other end is empty, it sets `sent` and copies, else it clears `sent`:
//
//     work-item i copies units i, i + L, ... of header and packets, 8 words each
//
// Links that lead to another rank's device or back to their own node are skipped. The host moves the packets of the
// former and sets their `sent`.
#include "kernels/shared/loop_canary.clh"
#include "kernels/shared/traffic.h"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: work-items in the work-group of a mailbox, 1..1024
#endif

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void exchange(__global const uint* restrict ends,      // [link][node]: slot of the node at the link's other end;
                                                       // RAYA_NO_SLOT: skipped
              const uint nodes,                        // on the device
              const uint inboxes_of_link,              // on the device, for each link
              const uint capacity,                     // of a mailbox, packets
              const uint packet_words,                 // words of a packet: 8 or 16
              const uint outbox_status,                // index in a node's status of the counts of its outboxes
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
