// What travels between nodes: ray packets and return packets, 16 and 8 words (Yoshitani & Yamazaki, Table 1 and
// protocol).
//
//   the paper's field            here
//   voxel, next voxel            voxel: the one that the packet goes to; what it was in before is not needed
//   screen position *            pixel
//   kind of ray *                state: kind, level, light, flags; path: which ray of its pixel's tree
//   weight                       weight *
//   direction                    origin and direction: a ray must not change on its way, or its hits would
//   luminance *                  colour
//   intersection, normal, data of the object hit: not here; a hit is shaded where it is found
//   data for the search of the next voxel: not here; made anew from ray and voxel, the same in every node
//
// (* also in a return packet.) A return packet is one contribution to its pixel: colour times weight. The host adds
// those of a pixel in the order of its ray tree, which path, level and light tell: a ray's own contributions (ambient
// term, then lights in turn), then those of all that follows its reflected ray, then its refracted ray.
#ifndef RAYA_SHARED_PACKET_H
#define RAYA_SHARED_PACKET_H
#include "kernels/shared/torus.h"

// How every packet begins; a return packet is no more than that. A voxel is named by its place (raya_pack_place).
typedef struct {
    raya_u32 pixel;  // row * W + column
    raya_u32 state;  // see below
    raya_u32 path;   // bit 31 - l set: at level l the tree's path takes the refracted ray, else the reflected one
    float weight;    // of the ray; of a return: what its colour is multiplied by
    union {
        float colour[3];  // return: red, green, blue. Shadow ray: what the light adds if the ray arrives
        struct {
            raya_u32 voxel;   // where it was found, RAYA_NO_VOXEL without one
            raya_u32 object;  // its number in the whole scene
        } nearest;            // the nearest hit so far of a wide ray that is no shadow ray
    } carries;
    raya_u32 voxel;  // of a ray: where it goes to or is; RAYA_NO_VOXEL: it will never enter the box
} raya_head;
RAYA_SHARED_SIZE(raya_head, 4 * 8);

typedef struct {
    raya_head head;
    float origin[3];
    float direction[3];  // of length 1
    float limit;         // hits count below: a shadow ray's distance to its light, a wide ray's to its nearest hit
    raya_u32 start;      // of a wide ray: the voxel that it visited first
} raya_packet;
RAYA_SHARED_SIZE(raya_packet, 4 * 16);

enum { RAYA_RETURN_WORDS = sizeof(raya_head) / 4, RAYA_PACKET_WORDS = sizeof(raya_packet) / 4 };

// A voxel's place in one word: x in bits 0..9, y in 10..19, z in 20..29.
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
// Must be tested against all objects (kernels/grid/walk.clh): visits all voxels in turn, from one of the node where it
// was made on, and is shaded where its nearest hit was found.
#define RAYA_STATE_WIDE 0x8u
// A wide ray that has visited all voxels and goes to be shaded.
#define RAYA_STATE_FOUND 0x10u
// Made or changed by this node, and not sent yet: what a trace of the traffic shows as a message of its own.
#define RAYA_STATE_FRESH 0x20u
// Of a return: a message of its own to the model, which others of its ray go with for nothing. Of a shadow ray: its end
// makes one, as its ray is done with it (raya_run.return_a_ray).
#define RAYA_STATE_CHARGED 0x40u
#define RAYA_STATE_LEVEL_SHIFT 8u
#define RAYA_STATE_LIGHT_SHIFT 16u
#define RAYA_MOST_LIGHTS 65535u

// Light: of a shadow ray the light's number + 1; of a return 0 for an ambient term or a
// background, else a light's number + 1.
RAYA_SHARED_FUNCTION raya_u32 raya_state(raya_u32 kind, raya_u32 level, raya_u32 light) {
    return kind | level << RAYA_STATE_LEVEL_SHIFT | light << RAYA_STATE_LIGHT_SHIFT;
}
RAYA_SHARED_FUNCTION raya_u32 raya_state_kind(raya_u32 state) { return state & RAYA_STATE_KIND; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_level(raya_u32 state) { return state >> RAYA_STATE_LEVEL_SHIFT & 31u; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_light(raya_u32 state) { return state >> RAYA_STATE_LIGHT_SHIFT; }

// Words of a packet as it is moved; what the model charges for it is the host's business (host/model/t805.hpp).
RAYA_SHARED_FUNCTION raya_u32 raya_packet_words(raya_u32 state) {
    return raya_state_kind(state) == RAYA_KIND_RETURN ? (raya_u32)RAYA_RETURN_WORDS : (raya_u32)RAYA_PACKET_WORDS;
}

// The path of the ray that follows at `level` + 1 when the ray of that path and level is reflected or refracted.
RAYA_SHARED_FUNCTION raya_u32 raya_path_reflected(raya_u32 path) { return path; }
RAYA_SHARED_FUNCTION raya_u32 raya_path_refracted(raya_u32 path, raya_u32 level) { return path | 1u << (31u - level); }

// Does contribution (path, level, light) of a pixel come before another one?
RAYA_SHARED_FUNCTION int raya_comes_before(raya_u32 path, raya_u32 state, raya_u32 other_path, raya_u32 other_state) {
    if (path != other_path) return path < other_path;
    if (raya_state_level(state) != raya_state_level(other_state))
        return raya_state_level(state) < raya_state_level(other_state);
    return raya_state_light(state) < raya_state_light(other_state);
}

#endif
