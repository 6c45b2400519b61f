// The uniform grid: the scene's box, cut into A x B x C equal voxels (Fujimoto, Tanaka & Iwata 1986; Yoshitani &
// Yamazaki, method).
//
// Planes between voxels are fp32 numbers; host and kernels compute them with the same bits. Voxels are numbered along x
// first, then y, then z.
#ifndef RAYA_SHARED_GRID_H
#define RAYA_SHARED_GRID_H
#include "kernels/shared/portable.h"

typedef struct {
    float low[3];           // lowest x, y, z of the box, scene units
    float cell[3];          // sides of a voxel, > 0
    raya_u32 divisions[3];  // A, B, C
    // Largest coordinate of a ray's origin for which every hit lies in a voxel that lists its object. A ray from
    // farther away must be tested against all objects (host/accel/partition.hpp).
    float reach;
} raya_grid;
RAYA_SHARED_SIZE(raya_grid, 4 * 10);

#define RAYA_NO_VOXEL 0xffffffffu

// The grid in the words of a job, at raya_job.accel_at. After this header: the numbers of the separate objects; a word
// for each voxel; the rows of all lists, four words each, list after list; the number of each row's object. "at" words
// are distances from the job's first word.
typedef struct {
    raya_grid grid;
    raya_u32 apart;      // separate objects: finite, in no list, tested for every ray as planes are
    raya_u32 apart_at;   // where their numbers start, ascending
    raya_u32 voxels_at;  // voxel words
    raya_u32 rows_at;
    raya_u32 numbers_at;
} raya_grid_words;
RAYA_SHARED_SIZE(raya_grid_words, 4 * (10 + 5));

// A voxel word describes a list: its number of spheres (RAYA_ROWS_LEFT), the number of the first one's row
// (RAYA_ROW_NUMBER), and, if RAYA_LINKED is set, that a link follows in the row behind the spheres. 0: an empty list.
#define RAYA_ROW_NUMBER 0x03ffffffu
#define RAYA_ONE_ROW 0x04000000u
#define RAYA_ROWS_LEFT 0x7c000000u
#define RAYA_MOST_ROWS 31u  // maximum of one voxel word
#define RAYA_LINKED 0x80000000u

// Row 0 belongs to no list. The row of a sphere holds the first four words of its object, enough to find a hit. The row
// of a link holds the voxel word of the rest of the list, 0 at the end. The number of a link's row is that of an object
// that is not a sphere, or RAYA_NO_OBJECT_HERE where a list of more than RAYA_MOST_ROWS spheres continues.
enum { RAYA_ROW_NEXT = 0, RAYA_ROW_WORDS = 4 };
#define RAYA_NO_OBJECT_HERE 0xffffffffu

RAYA_SHARED_FUNCTION raya_u32 raya_voxels(raya_grid g) { return g.divisions[0] * g.divisions[1] * g.divisions[2]; }

RAYA_SHARED_FUNCTION raya_u32 raya_voxel(raya_grid g, raya_u32 x, raya_u32 y, raya_u32 z) {
    return x + g.divisions[0] * (y + g.divisions[1] * z);
}

// Returns the coordinate of the plane before voxel k along an axis, k = 0 .. divisions; never contracted to an fma.
RAYA_SHARED_FUNCTION float raya_voxel_plane(raya_grid g, raya_u32 axis, raya_u32 k) {
    const float offset = (float)k * g.cell[axis];
    return g.low[axis] + offset;
}

#endif
