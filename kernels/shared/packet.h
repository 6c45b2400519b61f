// Packets between nodes: ray packets of 16 words and return packets of 8 words (Yoshitani & Yamazaki, Table 1 and
// protocol).
//
//   the paper's field            here
//   voxel, next voxel            voxel: only the next voxel
//   screen position *            pixel
//   kind of ray *                state: kind, level, light, flags; path: position in the pixel's ray tree
//   weight                       weight *
//   direction                    origin and direction, the same bits in all nodes, so that hits do not change
//   luminance *                  colour
//   intersection, normal, data of the object hit: not sent; a hit is shaded in the node that finds it
//   data for the search of the next voxel: not sent; every node recomputes them from ray and voxel
//
// (* also in a return packet.) A return packet is one contribution to its pixel: colour times weight. The host sorts
// the contributions of a pixel by path, level and light, which is the order of its ray tree: a ray's own contributions
// (ambient term, then each light), then those of the subtree of its reflected ray, then those of the subtree of its
// refracted ray.
#ifndef RAYA_SHARED_PACKET_H
#define RAYA_SHARED_PACKET_H
#include "kernels/shared/torus.h"

// The head of every packet. A return packet consists of the head alone. Voxels are stored as raya_pack_place(x, y, z).
typedef struct {
    raya_u32 pixel;  // row * W + column
    raya_u32 state;  // kind, flags, level and light: raya_state()
    raya_u32 path;   // path from the primary ray to this ray; bit 31 - l: 1 if the ray of level l + 1 is refracted
    float weight;    // of the ray; a return's colour is multiplied by it
    union {
        float colour[3];  // return: red, green, blue. Shadow ray: the light's contribution if nothing is hit
        struct {
            raya_u32 voxel;   // voxel of the hit; RAYA_NO_VOXEL: no hit yet
            raya_u32 object;  // scene-wide number of the object hit
        } nearest;            // the nearest hit so far of a wide ray, except shadow rays
    } carries;
    raya_u32 voxel;  // voxel in which the ray is tested next; RAYA_NO_VOXEL: the ray misses the box
} raya_head;
RAYA_SHARED_SIZE(raya_head, 4 * 8);

typedef struct {
    raya_head head;
    float origin[3];
    float direction[3];  // of length 1
    float limit;         // only hits at t < limit count; t of a shadow ray's light or of a wide ray's nearest hit
    raya_u32 start;      // the first voxel that a wide ray visited
} raya_packet;
RAYA_SHARED_SIZE(raya_packet, 4 * 16);

enum { RAYA_RETURN_WORDS = sizeof(raya_head) / 4, RAYA_PACKET_WORDS = sizeof(raya_packet) / 4 };

// Packs a voxel's place into one word: x in bits 0..9, y in 10..19, z in 20..29.
#define RAYA_MAX_PLACES 1024u
RAYA_SHARED_FUNCTION raya_u32 raya_pack_place(raya_u32 x, raya_u32 y, raya_u32 z) { return x | y << 10 | z << 20; }
RAYA_SHARED_FUNCTION raya_place raya_unpack_place(raya_u32 word) {
    raya_place p;
    p.at[0] = word & 1023u;
    p.at[1] = word >> 10 & 1023u;
    p.at[2] = word >> 20 & 1023u;
    return p;
}

enum {  // kinds of packets; 0: the slot holds no packet
    RAYA_KIND_NONE,
    RAYA_KIND_PRIMARY,
    RAYA_KIND_REFLECTED,
    RAYA_KIND_REFRACTED,
    RAYA_KIND_SHADOW,
    RAYA_KIND_RETURN,
    RAYA_KINDS
};

// State: kind in bits 0..2, flags in 3..6, level in 8..12, light in 16..31.
#define RAYA_STATE_KIND 0x7u
// A wide ray (is_wide() in kernels/grid/traversal.clh), which must be tested against all objects. It visits all voxels
// in turn, starting in the node that made it, and is shaded in the voxel of its nearest hit.
#define RAYA_STATE_WIDE 0x8u
// A wide ray that has visited all voxels and returns to the voxel of its nearest hit to be shaded.
#define RAYA_STATE_FOUND 0x10u
// This node has made or changed the packet and not sent it yet. A trace of the traffic reports such a packet as a new
// message.
#define RAYA_STATE_FRESH 0x20u
// Of a return: the model charges the return as a message. Of a shadow ray: this is the last shadow ray of the ray that
// made it, and at its end makes that ray's only charged return (raya_run.one_return_per_ray).
#define RAYA_STATE_CHARGED 0x40u
#define RAYA_STATE_LEVEL_SHIFT 8u
#define RAYA_STATE_LIGHT_SHIFT 16u
#define RAYA_MAX_LIGHTS 65535u

// Packs a state without flags. `light`: 1 + the light's number for shadow rays and their returns, else 0.
RAYA_SHARED_FUNCTION raya_u32 raya_state(raya_u32 kind, raya_u32 level, raya_u32 light) {
    return kind | level << RAYA_STATE_LEVEL_SHIFT | light << RAYA_STATE_LIGHT_SHIFT;
}
RAYA_SHARED_FUNCTION raya_u32 raya_state_kind(raya_u32 state) { return state & RAYA_STATE_KIND; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_level(raya_u32 state) { return state >> RAYA_STATE_LEVEL_SHIFT & 31u; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_light(raya_u32 state) { return state >> RAYA_STATE_LIGHT_SHIFT; }

// Returns the size of a packet in words, as the simulation moves it. The words that the model charges may differ
// (host/model/t805.hpp).
RAYA_SHARED_FUNCTION raya_u32 raya_packet_words(raya_u32 state) {
    return raya_state_kind(state) == RAYA_KIND_RETURN ? (raya_u32)RAYA_RETURN_WORDS : (raya_u32)RAYA_PACKET_WORDS;
}

// Return the path of the reflected or refracted ray that a ray with the given path and level makes.
RAYA_SHARED_FUNCTION raya_u32 raya_path_reflected(raya_u32 path) { return path; }
RAYA_SHARED_FUNCTION raya_u32 raya_path_refracted(raya_u32 path, raya_u32 level) { return path | 1u << (31u - level); }

// Returns true if the contribution with `path` and `state` precedes that with `other_path` and `other_state`, of the
// same pixel, in the order of the ray tree.
RAYA_SHARED_FUNCTION int raya_comes_before(raya_u32 path, raya_u32 state, raya_u32 other_path, raya_u32 other_state) {
    if (path != other_path) return path < other_path;
    if (raya_state_level(state) != raya_state_level(other_state))
        return raya_state_level(state) < raya_state_level(other_state);
    return raya_state_light(state) < raya_state_light(other_state);
}

#endif
