// The uniform grid: the scene's box, cut into A x B x C equal voxels (Fujimoto, Tanaka & Iwata 1986; Yoshitani &
// Yamazaki, section on the method).
//
// Host and kernels compute the planes between voxels with raya_voxel_plane(), so both get the same fp32 numbers. Voxel
// (x, y, z) has the number x + A (y + B z).
#ifndef RAYA_SHARED_GRID_H
#define RAYA_SHARED_GRID_H
#include "kernels/shared/portable.h"

typedef struct {
    float low[3];           // lowest x, y, z of the box, in scene units
    float cell[3];          // size of a voxel along x, y, z; > 0
    raya_u32 divisions[3];  // A, B, C
    // If no coordinate of a ray's origin exceeds `reach` in absolute value, each hit of the ray lies in a voxel whose
    // list contains the object hit. All other rays must be tested against all objects (host/accel/partition.hpp).
    float reach;
} raya_grid;
RAYA_SHARED_SIZE(raya_grid, 4 * 10);

#define RAYA_NO_VOXEL 0xffffffffu

// Header of the grid in the words of a job, at raya_job.accel_at. Three arrays follow it. Members named *_at are offsets
// in words from the job's first word.
typedef struct {
    raya_grid grid;
    raya_u32 separate;     // number of separate objects: finite objects in no list, tested for every ray
    raya_u32 separate_at;  // object numbers of the separate objects, ascending
    raya_u32 starts_at;    // [voxels + 1]: the list of voxel v has the entries starts[v] .. starts[v + 1] - 1
    raya_u32 lists_at;     // the entries of all lists: object numbers, ascending in each list
} raya_grid_words;
RAYA_SHARED_SIZE(raya_grid_words, 4 * (10 + 4));

RAYA_SHARED_FUNCTION raya_u32 raya_voxels(raya_grid g) { return g.divisions[0] * g.divisions[1] * g.divisions[2]; }

RAYA_SHARED_FUNCTION raya_u32 raya_voxel(raya_grid g, raya_u32 x, raya_u32 y, raya_u32 z) {
    return x + g.divisions[0] * (y + g.divisions[1] * z);
}

// Returns the coordinate of the lower plane of voxel k along an axis, k = 0 .. divisions. Product and sum are rounded
// separately, never contracted to an fma, so that host and kernels agree.
RAYA_SHARED_FUNCTION float raya_voxel_plane(raya_grid g, raya_u32 axis, raya_u32 k) {
    const float offset = (float)k * g.cell[axis];
    return g.low[axis] + offset;
}

#endif
