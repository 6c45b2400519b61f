// The scene's box, cut into A x B x C equal voxels (Fujimoto, Tanaka & Iwata 1986; Yoshitani & Yamazaki, method).
//
// Planes between voxels are fp32 numbers that host and kernels compute alike. Numbers of voxels run along x first, then y, then z.
#ifndef RAYA_SHARED_GRID_H
#define RAYA_SHARED_GRID_H
#include "shared/portable.h"

typedef struct {
    float low[3];           // the corner of the box with the lowest coordinates, scene units
    float cell[3];          // sides of a voxel, > 0
    raya_u32 divisions[3];  // A, B, C
    // Largest coordinate of a ray's origin for which a hit is sure to lie in a voxel that its object is registered in; a ray
    // from farther away has to be tested against all objects (host/grid/partition.hpp).
    float reach;
} raya_grid;
RAYA_SHARED_SIZE(raya_grid, 4 * 10);

#define RAYA_NO_VOXEL 0xffffffffu

// The grid in the words of a job, at raya_job.grid_at. Then follow the numbers of the objects held apart, a word for each voxel, and the
// lists of the voxels, one after another. "at" words are distances from the job's first word.
typedef struct {
    raya_grid grid;
    raya_u32 apart;      // how many finite objects are in no list, because every ray is tested against them, as against planes
    raya_u32 apart_at;   // where their numbers start, ascending
    raya_u32 voxels_at;  // where the voxels' words start: each tells where the voxel's list starts, 0 for an empty one
} raya_grid_words;
RAYA_SHARED_SIZE(raya_grid_words, 4 * (10 + 3));

// A list holds the numbers of its objects, ascending; the last one has this bit.
#define RAYA_LAST_OBJECT 0x80000000u

RAYA_SHARED_FUNCTION raya_u32 raya_voxels(raya_grid g) { return g.divisions[0] * g.divisions[1] * g.divisions[2]; }

RAYA_SHARED_FUNCTION raya_u32 raya_voxel(raya_grid g, raya_u32 x, raya_u32 y, raya_u32 z) {
    return x + g.divisions[0] * (y + g.divisions[1] * z);
}

// Where the plane before voxel k along an axis lies, k = 0 .. divisions; never contracted.
RAYA_SHARED_FUNCTION float raya_voxel_plane(raya_grid g, raya_u32 axis, raya_u32 k) {
    const float offset = (float)k * g.cell[axis];
    return g.low[axis] + offset;
}

#endif
