// A part of a scene's objects, which the ring machine passes from PE to PE (kernels/ring/turn.cl):
//
//   raya_part | surfaces | spheres | for each sphere, the offset of its surface | planes | cones | polygons, with their
//   corners and normals
//
// Offsets count from the part's first word. A part holds objects of consecutive numbers, and their surfaces.
#ifndef RAYA_SHARED_PART_H
#define RAYA_SHARED_PART_H
#include "kernels/shared/job.h"

typedef struct {
    raya_objects objects;
    raya_u32 first;      // number of the part's first object
    raya_u32 unused[3];  // pads the header, so that the surfaces start at a multiple of four words
} raya_part;
RAYA_SHARED_SIZE(raya_part, sizeof(raya_objects) + 4 * 4);

// Returns the number of words of each ray tree in flight (kernels/ring/flight.clh), without its event counts, which a
// modelled PE does not store: rays, what they have found, the last hit's shading, the tree, its pixel, and its pending
// rays.
RAYA_SHARED_FUNCTION raya_u32 raya_flight_words(raya_u32 bounces) {
    const raya_u32 vec = 3, rays = 2 + 4 * vec, found = 3 + 2 * vec + 1 + vec + 5, hit = 2 * vec + 3;
    const raya_u32 tree = 3 + vec, pixel = 4 + vec, pending = 2 * vec + 1;
    return rays + found + hit + tree + pixel + pending * bounces;
}

#endif
