// What travels between nodes: ray packets and return packets, 16 and 8 words (Yoshitani & Yamazaki, Table 1 and protocol).
//
//   the paper's field            here
//   voxel, next voxel            VOXEL: the voxel that the packet goes to; what it was in before is not needed
//   screen position *            PIXEL
//   kind of ray *                STATE: kind, level, light, flags; PATH: which ray of its pixel's tree
//   weight                       WEIGHT *
//   direction                    ORIGIN and DIRECTION: a ray must not change on its way, or its hits would
//   luminance *                  COLOUR
//   intersection, normal, data of the object hit: not here; a hit is shaded where it is found
//   data for the search of the next voxel: not here; made anew from ray and voxel, the same in every node
//
// (* also in a return packet.) A return packet is one contribution to its pixel: colour times weight. The host adds those of a pixel in the
// order of its ray tree, which PATH, level and light tell: a ray's own contributions (ambient term, then lights in turn), then
// those of all that follows its reflected ray, then its refracted ray.
#ifndef RAYA_SHARED_PACKET_H
#define RAYA_SHARED_PACKET_H
#include "kernels/shared/torus.h"

enum {
    RAYA_PACKET_PIXEL = 0,   // row * W + column
    RAYA_PACKET_STATE = 1,   // see below
    RAYA_PACKET_PATH = 2,    // bit 31 - l set: at level l the tree's path takes the refracted ray, else the reflected one
    RAYA_PACKET_WEIGHT = 3,  // of the ray; of a return: what its colour is multiplied by
    RAYA_PACKET_COLOUR = 4,  // return: r g b. Shadow: what the light adds if the ray arrives. Other rays: unused, see FOUND_OBJECT
    RAYA_PACKET_VOXEL = 7,   // place of the voxel that the ray goes to or is in; RAYA_NO_VOXEL: it will never enter the box
    RAYA_RETURN_WORDS = 8,
    RAYA_PACKET_ORIGIN = 8,      // x y z
    RAYA_PACKET_DIRECTION = 11,  // x y z, of length 1
    RAYA_PACKET_LIMIT = 14,      // hits count below: a shadow ray's distance to its light; of a wide ray: of its nearest hit so far
    RAYA_PACKET_FOUND = 15,      // of a wide ray that is no shadow ray: place of the voxel where the nearest hit so far was found, RAYA_NO_VOXEL without one
    RAYA_PACKET_WORDS = 16,
    RAYA_PACKET_FOUND_OBJECT = RAYA_PACKET_COLOUR,   // of a wide ray that is no shadow ray: number of the object hit, in the whole scene
    RAYA_PACKET_START = RAYA_PACKET_COLOUR + 1,      // of such a ray: place of the voxel that it visited first
    RAYA_PACKET_SHADOW_START = RAYA_PACKET_FOUND     // of a wide shadow ray: the same
};

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

// STATE: kind in bits 0..2, flags in 3..5, level in 8..12, light in 16..31.
#define RAYA_STATE_KIND 0x7u
// Must be tested against all objects (kernels/grid/walk.clh): visits all voxels in turn, from one of the node where it was made on, and is shaded where
// its nearest hit was found.
#define RAYA_STATE_WIDE 0x8u
// A wide ray that has visited all voxels and goes to be shaded.
#define RAYA_STATE_FOUND 0x10u
// Made or changed by this node, and not sent yet: what a trace of the traffic shows as a message of its own.
#define RAYA_STATE_FRESH 0x20u
#define RAYA_STATE_LEVEL_SHIFT 8u
#define RAYA_STATE_LIGHT_SHIFT 16u
#define RAYA_MOST_LIGHTS 65535u

// Light: of a shadow ray the light's number + 1; of a return 0 for an ambient term or a background, else a light's number + 1.
RAYA_SHARED_FUNCTION raya_u32 raya_state(raya_u32 kind, raya_u32 level, raya_u32 light) {
    return kind | level << RAYA_STATE_LEVEL_SHIFT | light << RAYA_STATE_LIGHT_SHIFT;
}
RAYA_SHARED_FUNCTION raya_u32 raya_state_kind(raya_u32 state) { return state & RAYA_STATE_KIND; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_level(raya_u32 state) { return state >> RAYA_STATE_LEVEL_SHIFT & 31u; }
RAYA_SHARED_FUNCTION raya_u32 raya_state_light(raya_u32 state) { return state >> RAYA_STATE_LIGHT_SHIFT; }

// Words of a packet on a link.
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
