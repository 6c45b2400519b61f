// The scene's box, cut into A x B x C equal voxels (Fujimoto, Tanaka & Iwata 1986; Yoshitani & Yamazaki, method).
//
// Planes between voxels are fp32 numbers that host and kernels compute alike. Numbers of voxels run
// along x first, then y, then z.
#ifndef RAYA_SHARED_GRID_H
#define RAYA_SHARED_GRID_H
#include "kernels/shared/portable.h"

typedef struct {
    float low[3];           // the corner of the box with the lowest coordinates, scene units
    float cell[3];          // sides of a voxel, > 0
    raya_u32 divisions[3];  // A, B, C
    // Largest coordinate of a ray's origin for which a hit is sure to lie in a voxel that its object is registered in;
    // a ray from farther away has to be tested against all objects (host/accel/partition.hpp).
    float reach;
} raya_grid;
RAYA_SHARED_SIZE(raya_grid, 4 * 10);

#define RAYA_NO_VOXEL 0xffffffffu

// The grid in the words of a job, at raya_job.accel_at. After this header: the numbers of the objects held apart; a word
// for each voxel; the rows of all lists, four words each, list after list; the number of each row's object. "at" words
// are distances from the job's first word.
typedef struct {
    raya_grid grid;
    raya_u32 apart;      // finite objects that are in no list, as every ray is tested against them, as against planes
    raya_u32 apart_at;   // their numbers, ascending
    raya_u32 voxels_at;  // voxel words
    raya_u32 rows_at;
    raya_u32 numbers_at;
} raya_grid_words;
RAYA_SHARED_SIZE(raya_grid_words, 4 * (10 + 5));

// A voxel word says what is to be gone through: so many spheres (RAYA_ROWS_LEFT) from the row of that number
// (RAYA_ROW_NUMBER) on, and then, where RAYA_LINKED is set, the link in the row behind them. 0: nothing.
#define RAYA_ROW_NUMBER 0x03ffffffu
#define RAYA_ONE_ROW 0x04000000u
#define RAYA_ROWS_LEFT 0x7c000000u
#define RAYA_MOST_ROWS 31u  // in one voxel word
#define RAYA_LINKED 0x80000000u

// Row 0 belongs to no list. Words of a row: a sphere's are the first four of its object, all that a hit needs. A
// link's: the voxel word for what comes next, 0 at the end; its number is that of an object that is no sphere, or
// RAYA_NO_OBJECT_HERE: a list of more than RAYA_MOST_ROWS spheres goes on.
enum { RAYA_ROW_NEXT = 0, RAYA_ROW_WORDS = 4 };
#define RAYA_NO_OBJECT_HERE 0xffffffffu

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
