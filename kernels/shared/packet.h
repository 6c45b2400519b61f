// The messages between nodes: ray packets and return packets, of 16 and 8 words (Yoshitani & Yamazaki, Table 1 and
// protocol).
//
//   the paper's field            here
//   voxel, next voxel            voxel: the one that the packet goes to; the previous one is not needed
//   screen position *            pixel
//   kind of ray *                state: kind, level, light, flags; path: which ray of its pixel's tree
//   weight                       weight *
//   direction                    origin and direction: a ray keeps its bits on its way, so that its hits do not change
//   luminance *                  colour
//   intersection, normal, data of the object hit: not here; a hit is shaded where it is found
//   data for the search of the next voxel: not here; every node recomputes the same data from ray and voxel
//
// (* also in a return packet.) A return packet is one contribution to its pixel: colour times weight. The host adds the
// contributions of a pixel in the order of its ray tree, which path, level and light give: a ray's own contributions
// (ambient term, then lights in turn), then those of its reflected ray's subtree, then those of its refracted ray's.
#ifndef RAYA_SHARED_PACKET_H
#define RAYA_SHARED_PACKET_H
#include "kernels/shared/torus.h"

// The head of every packet; a return packet consists of it alone. Voxels are given by their place (raya_pack_place).
typedef struct {
    raya_u32 pixel;  // row * W + column
    raya_u32 state;  // see below
    raya_u32 path;   // bit 31 - l set: at level l the tree's path takes the refracted ray, else the reflected one
    float weight;    // of the ray; a return's colour is multiplied by it
    union {
        float colour[3];  // return: red, green, blue. Shadow ray: contribution of the light if the ray arrives
        struct {
            raya_u32 voxel;   // where it was found, RAYA_NO_VOXEL without a hit
            raya_u32 object;  // its number in the whole scene
        } nearest;            // nearest hit so far of a wide ray that is not a shadow ray
    } carries;
    raya_u32 voxel;  // of a ray: where it is or goes to; RAYA_NO_VOXEL: it never enters the box
} raya_head;
RAYA_SHARED_SIZE(raya_head, 4 * 8);

typedef struct {
    raya_head head;
    float origin[3];
    float direction[3];  // of length 1
    float limit;         // only hits below count: distance of a shadow ray's light, of a wide ray's nearest hit
    raya_u32 start;      // the first voxel that a wide ray visited
} raya_packet;
RAYA_SHARED_SIZE(raya_packet, 4 * 16);

enum { RAYA_RETURN_WORDS = sizeof(raya_head) / 4, RAYA_PACKET_WORDS = sizeof(raya_packet) / 4 };

// Packs a voxel's place into one word: x in bits 0..9, y in 10..19, z in 20..29.
#define RAYA_MOST_PLACES 1024u
RAYA_SHARED_FUNCTION raya_u32 raya_pack_place(raya_u32 x, raya_u32 y, raya_u32 z) { return x | y << 10 | z << 20; }
RAYA_SHARED_FUNCTION raya_place raya_unpack_place(raya_u32 word) {
    raya_place p;
    p.at[0] = word & 1023u;
    p.at[1] = word >> 10 & 1023u;
    p.at[2] = word >> 20 & 1023u;
    return p;
}

enum {  // kinds; 0: no packet
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
// A wide ray, to be tested against all objects (kernels/grid/walk.clh): it visits all voxels in turn, starting in the
// node that made it, and is shaded where its nearest hit was found.
#define RAYA_STATE_WIDE 0x8u
// A wide ray that has visited all voxels and returns to the voxel of its nearest hit to be shaded.
#define RAYA_STATE_FOUND 0x10u
// Made or changed by this node and not sent yet: a trace of the traffic shows it as a new message.
#define RAYA_STATE_FRESH 0x20u
// Return: the model charges it as a message; the other returns of its ray are free. Shadow ray: the last one of its
// ray, whose end makes the charged return (raya_run.return_a_ray).
#define RAYA_STATE_CHARGED 0x40u
#define RAYA_STATE_LEVEL_SHIFT 8u
#define RAYA_STATE_LIGHT_SHIFT 16u
#define RAYA_MOST_LIGHTS 65535u

// Light: for a shadow ray the light's number + 1; for a return 0 if it is an ambient term or a background, else a
// light's number + 1.
RAYA_SHARED_FUNCTION raya_u32 raya_state(raya_u32 kind, raya_u32 level, raya_u32 light) {
    return kind | level << RAYA_STATE_LEVEL_SHIFT | light << RAYA_STATE_LIGHT_SHIFT;
}
RAYA_SHARED_FUNCTION raya_u32 raya_state_kind(raya_u32 state) { return state & RAYA_STATE_KIND; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_level(raya_u32 state) { return state >> RAYA_STATE_LEVEL_SHIFT & 31u; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_light(raya_u32 state) { return state >> RAYA_STATE_LIGHT_SHIFT; }

// Returns the words of a packet that the simulation moves; host/model/t805.hpp decides what the model charges for it.
RAYA_SHARED_FUNCTION raya_u32 raya_packet_words(raya_u32 state) {
    return raya_state_kind(state) == RAYA_KIND_RETURN ? (raya_u32)RAYA_RETURN_WORDS : (raya_u32)RAYA_PACKET_WORDS;
}

// Return the path of the reflected or refracted ray, at `level` + 1, of the ray with that path and level.
RAYA_SHARED_FUNCTION raya_u32 raya_path_reflected(raya_u32 path) { return path; }
RAYA_SHARED_FUNCTION raya_u32 raya_path_refracted(raya_u32 path, raya_u32 level) { return path | 1u << (31u - level); }

// Returns true if contribution (path, level, light) of a pixel comes before another one in the order of the ray tree.
RAYA_SHARED_FUNCTION int raya_comes_before(raya_u32 path, raya_u32 state, raya_u32 other_path, raya_u32 other_state) {
    if (path != other_path) return path < other_path;
    if (raya_state_level(state) != raya_state_level(other_state))
        return raya_state_level(state) < raya_state_level(other_state);
    return raya_state_light(state) < raya_state_light(other_state);
}

#endif
