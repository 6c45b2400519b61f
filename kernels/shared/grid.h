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

// Header of the grid in the words of a job, at raya_job.accel_at. Four arrays follow it: the object numbers of the
// separate objects; one word for each voxel; the rows of all lists, four words each, list after list; the object number
// of each row. Members named *_at are offsets in words from the job's first word.
typedef struct {
    raya_grid grid;
    raya_u32 separate;     // number of separate objects: finite objects in no list, tested for every ray
    raya_u32 separate_at;  // object numbers of the separate objects, ascending
    raya_u32 voxels_at;    // the voxel words
    raya_u32 rows_at;      // row 0
    raya_u32 numbers_at;   // the rows' object numbers
} raya_grid_words;
RAYA_SHARED_SIZE(raya_grid_words, 4 * (10 + 5));

// A voxel word describes a list by three bit fields: RAYA_ROWS_LEFT is the number of spheres, RAYA_ROW_NUMBER the row
// of the first sphere, and RAYA_LINKED is set if a link row follows the spheres' rows. The word of an empty list is 0.
#define RAYA_ROW_NUMBER 0x03ffffffu
#define RAYA_ONE_ROW 0x04000000u  // the value 1 of the field RAYA_ROWS_LEFT
#define RAYA_ROWS_LEFT 0x7c000000u
#define RAYA_MAX_ROWS 31u  // maximum number of spheres in one voxel word
#define RAYA_LINKED 0x80000000u

// Row 0 belongs to no list. A sphere's row holds the sphere's four words (job.h), which suffice to find a hit. A link
// row holds, at RAYA_ROW_NEXT, the voxel word of the rest of the list, 0 if nothing follows. The object number of a
// link row is that of an object in the list that is not a sphere, or RAYA_NO_OBJECT_HERE if the row only continues a
// list of more than RAYA_MAX_ROWS spheres.
enum { RAYA_ROW_NEXT = 0, RAYA_ROW_WORDS = 4 };
#define RAYA_NO_OBJECT_HERE 0xffffffffu

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
