// A part of a scene's objects, which the ring machine passes from PE to PE (kernels/ring/turn.cl):
//
//   raya_part | surfaces | spheres | for each sphere, the offset of its surface | planes | cones | polygons, with their
//   corners and normals
//
// A PE stores the part behind the job's header and lights, and offsets count from the header's first word. A part holds
// objects of consecutive numbers, and their surfaces.
#ifndef RAYA_SHARED_PART_H
#define RAYA_SHARED_PART_H
#include "kernels/shared/job.h"

typedef struct {
    raya_objects objects;
    raya_u32 first;      // number of the part's first object
    raya_u32 unused[3];  // pads the header, so that the surfaces start at a multiple of four words
} raya_part;
RAYA_SHARED_SIZE(raya_part, sizeof(raya_objects) + 4 * 4);

// Returns the number of words that a PE saves for each ray tree in flight (kernels/ring/flight.clh).
RAYA_SHARED_FUNCTION raya_u32 raya_flight_words(raya_u32 bounces) {
    const raya_u32 search = 6 + 2 + 6 + 1 + 2 + 7 + 8, ray = 7, pixel = 7;
    return search + RAYA_EVENTS + 8 + 1 + 1 + 2 + 3 + pixel + ray * bounces;
}

#endif
