// The memory of a torus node: its part of the scene, as 32-bit words. A header, then sections of fixed strides:
//
//   raya_node | surfaces | lights | raya_voxel_memory of each of its voxels | planes | for each voxel: spheres, from a
//   multiple of four words on, where their surfaces start, cones, polygons with their outlines, and the numbers of its
//   objects in the whole scene
//
// "at" words are distances from the node's first word. A node holds the surfaces of its objects only. Every voxel has
// its own copy of an object that touches it; planes are infinite, so all voxels share one copy of each.
#ifndef RAYA_SHARED_NODE_H
#define RAYA_SHARED_NODE_H
#include "kernels/shared/grid.h"
#include "kernels/shared/job.h"
#include "kernels/shared/torus.h"

typedef struct {
    raya_job job;  // job.objects: the planes only, which are all that a ray outside the box can hit
    raya_torus torus;
    raya_grid grid;
    raya_u32 number;     // the node's number
    raya_u32 voxels;     // number of its voxels
    raya_u32 window[4];  // pixels whose rays may enter the box at its voxels: first row, end row, first column, end
                         // column; the ends are excluded
    raya_u32 voxels_at;  // raya_voxel_memory of its voxels, in the order of their numbers in the node
} raya_node;
RAYA_SHARED_SIZE(raya_node, sizeof(raya_job) + 4 * (7 + 10 + 7));

// The objects of a voxel. Their numbers in the whole scene lie at numbers_at: spheres, then polygons, then cones. A
// plane's number is the scene's count of spheres + its own among the planes.
typedef struct {
    raya_objects objects;
    raya_u32 numbers_at;
    raya_u32 first_plane;  // number of the first plane in the whole scene
} raya_voxel_memory;
RAYA_SHARED_SIZE(raya_voxel_memory, 4 * 10);

#endif
