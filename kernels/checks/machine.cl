// Checks of integer computations: owners of pixels, routes on the torus, transfers through local memory. The host
// computes the same results with the same headers and compares them exactly.
#include "kernels/shared/neighbours.h"
#include "kernels/shared/node_counts.h"
#include "kernels/shared/share_pixels.h"
#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

// Finds the owner of each pixel and the pixel's index in the owner's share, and converts the index back to a pixel. One
// work-item per pixel.
__kernel void find_owners(__global const raya_mapping* restrict mappings,  // [case]
                          __global const raya_pixel* restrict pixels,      // [case]
                          const uint cases,                                // number of cases
                          __global uint* restrict results)                 // [case][7]: owner; size of its share;
                                                                           // the pixel's index in the share; row and
                                                                           // column of the pixel with that index; sides
                                                                           // with a neighbour (bit s: side s); size of
                                                                           // the share of PE i mod P in case i
{
    const uint i = get_global_id(0);
    if (i >= cases) return;
    const raya_mapping m = mappings[i];
    const raya_pixel pixel = pixels[i];
    __global uint* to = results + i * 7;
    const uint owner = raya_owner(m, pixel.row, pixel.column);
    const raya_share share = raya_share_of(m, owner);
    const uint number = raya_index_of(m, share, pixel);
    const raya_pixel back = raya_pixel_of(m, share, number);
    uint sides = 0;
    for (uint side = 0; side < RAYA_SIDES; ++side) sides |= (uint)(raya_has_neighbour(m, pixel, side) != 0) << side;
    to[0] = owner;
    to[1] = raya_share_size(share);
    to[2] = number;
    to[3] = back.row;
    to[4] = back.column;
    to[5] = sides;
    to[6] = raya_share_size(raya_share_of(m, i % m.pes));
}

// For a node, finds the first link of a ray packet's route to the destination, the first link of a return packet's
// route, the number of nodes, the node at the place of this node, and the node at the end of each link. One work-item
// per case.
__kernel void find_routes(__global const raya_torus* restrict toruses,  // [case]
                          __global const uint* restrict nodes,          // [case][2]: node of the packet, destination
                          const uint cases,                             // number of cases
                          __global uint* restrict results)              // [case][4 + RAYA_LINKS]: raya_next_link(),
                                                                        // raya_return_link(), raya_nodes(),
                                                                        // raya_node_of(), raya_link_end() per link
{
    const uint i = get_global_id(0);
    if (i >= cases) return;
    const raya_torus t = toruses[i];
    const uint node = nodes[2 * i];
    __global uint* to = results + i * (4 + RAYA_LINKS);
    to[0] = raya_next_link(t, node, nodes[2 * i + 1]);
    to[1] = raya_return_link(t, node);
    to[2] = raya_nodes(t);
    const raya_place place = raya_node_place(t, node);
    to[3] = raya_node_of(t, place.at[0], place.at[1], place.at[2]);
    for (uint link = 0; link < RAYA_LINKS; ++link) to[4 + link] = raya_link_end(t, node, link);
}

// Computes the words of packets and the sizes of queues and local memory. One work-item per case.
__kernel void find_packet_words(__global const uint* restrict inputs,  // [case][6]: place x, y, z; state of a packet;
                                                                       // number of lights; bounces, >= the packet's
                                                                       // level
                                const uint cases,                      // number of cases
                                __global uint* restrict results)  // [case][8]: packed place; level and light of the
                                                                  // state; maximum number of new packets; slots for
                                                                  // the packet; work of processing; words of local
                                                                  // memory of `inject` and `route`
{
    const uint i = get_global_id(0);
    if (i >= cases) return;
    __global const uint* from = inputs + i * 6;
    __global uint* to = results + i * 8;
    const uint state = from[3], lights = from[4], bounces = from[5], new_packets = raya_max_new_packets(lights);
    to[0] = raya_pack_place(from[0], from[1], from[2]);
    to[1] = raya_state_level(state);
    to[2] = raya_state_light(state);
    to[3] = new_packets;
    to[4] = raya_slots_for_packet(new_packets, bounces, state);
    to[5] = RAYA_WORK_OF_PROCESSING(lights);
    to[6] = RAYA_INJECT_WORDS(1 + from[0], 1 + from[1] % 16);
    to[7] = RAYA_ROUTE_WORDS(1 + from[0]);
}

// Exercises local memory, barriers and atomics as the trace kernel uses them. Every work-group copies its words to
// local memory. It reverses their order and adds 1 to each word, `repeats` times, and writes the words to `output`.
// Then its work-items draw the numbers 0 .. words - 1 from `counter`.
__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1))) void reverse_words(
    __global const uint* restrict input,  // [group][words]
    const uint words,                     // number of words of a work-group
    const uint repeats,
    __local uint* buffers,           // [2][words]
    __local uint* counter,           // [1]
    __global uint* restrict output,  // [group][words]
    __global uint* restrict draws)   // [group][words]: the kernel adds 1 to a number's element each
                                     // time that the number is drawn
{
    const uint group = get_group_id(0);
    if (get_local_id(0) == 0) *counter = 0;
    for (uint w = get_local_id(0); w < words; w += RAYA_GROUP) buffers[w] = input[group * words + w];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = 0; i < repeats; ++i) {
        __local const uint* source = buffers + i % 2 * words;
        __local uint* target = buffers + (i + 1) % 2 * words;
        for (uint w = get_local_id(0); w < words; w += RAYA_GROUP) target[w] = source[words - 1 - w] + 1;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    for (uint w = get_local_id(0); w < words; w += RAYA_GROUP)
        output[group * words + w] = buffers[repeats % 2 * words + w];
    for (uint n = atomic_inc(counter); n < words; n = atomic_inc(counter)) draws[group * words + n] += 1;
}
