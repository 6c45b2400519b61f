// exchange: copies outboxes to the inboxes at the ends of their links. One launch copies either all outboxes of rays or
// all outboxes of returns.
//
// Work-group g copies the outbox of link g / nodes of the node in slot g mod nodes. If the outbox holds packets and the
// inbox at the end of the link is empty, the work-group sets `sent` to 1 and copies the outbox; else it sets `sent` to
// 0. Header and packets are copied in units of 8 words:
//
//     work-item i copies the units i, i + L, i + 2 L, ...
//
// The kernel skips links that lead to another rank's device or back to their own node. The host transfers the packets
// of links to other ranks and sets `sent` of these links.
#include "kernels/shared/loop_canary.clh"
#include "kernels/shared/traffic.h"

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void exchange(__global const uint* restrict ends,      // [link][node]: slot of the node at the end of the link;
                                                       // RAYA_NO_SLOT: the kernel skips the link
              const uint nodes,                        // number of nodes on the device
              const uint inboxes_of_link,              // number of inboxes on the device per link
              const uint capacity,                     // maximum number of packets in a mailbox
              const uint packet_words,                 // number of words of a packet: 8 or 16
              const uint outbox_status,                // index in a node's status of the counts of its
                                                       // outboxes (RAYA_STATUS_OUTBOX or _RETURN_OUTBOX)
              const uint inbox_status,                 // index in a node's status of the counts of its inboxes
              __global const uint* restrict outboxes,  // mailboxes (kernels/shared/traffic.h)
              __global uint* restrict inboxes,
              __global uint* restrict sent,            // [link][node]: 1 if the kernel has copied the outbox
              __global uint* restrict status)          // [node][RAYA_STATUS_WORDS]
{
    const uint outbox = get_group_id(0), link = outbox / nodes, slot = outbox % nodes, item = get_local_id(0);
    const uint end = ends[outbox];
    if (end == RAYA_NO_SLOT) return;
    const uint packets = status[slot * RAYA_STATUS_WORDS + outbox_status + link];
    const int transfers = packets > 0 && status[end * RAYA_STATUS_WORDS + inbox_status + link] == 0;
    if (item == 0) sent[outbox] = transfers;
    if (!transfers) return;
    const ulong source_at = raya_box_at(link, nodes, slot, capacity, packet_words);
    const ulong target_at = raya_box_at(link, inboxes_of_link, slot, capacity, packet_words);
    __global const uint8* const source = (__global const uint8*)(outboxes + source_at);
    __global uint8* const target = (__global uint8*)(inboxes + target_at);
    const uint units = (1 + packets) * (packet_words / 8);
    for (uint i = item; i < units; i += RAYA_GROUP) target[i] = source[i];
    if (loops_were_cut(min(units, 2u))) status[slot * RAYA_STATUS_WORDS + RAYA_STATUS_CUT] = 1;
}
