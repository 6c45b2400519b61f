// The memory of a torus node: its part of the scene, as 32-bit words. It consists of a header and these sections:
//
//   raya_node | surfaces | lights | raya_voxel_memory of each of its voxels | planes | for each of its voxels: spheres
//   (aligned to four words), offsets of their surfaces, cones, polygons with their corners, and the scene-wide numbers
//   of the voxel's objects
//
// Members named *_at are offsets in words from the node's first word. A node holds only the surfaces of its own
// objects. An object that several voxels list is copied to each of them. All voxels of a node share one copy of the
// planes, which are infinite.
#ifndef RAYA_SHARED_NODE_H
#define RAYA_SHARED_NODE_H
#include "kernels/shared/grid.h"
#include "kernels/shared/job.h"
#include "kernels/shared/torus.h"

typedef struct {
    raya_job job;  // job.objects holds only the planes: rays outside the box can hit nothing else
    raya_torus torus;
    raya_grid grid;
    raya_u32 number;     // the node's number
    raya_u32 voxels;     // number of its voxels
    raya_u32 window[4];  // pixels whose rays may enter the box at the node's voxels: first row, end row, first column,
                         // end column; the ends are excluded
    raya_u32 voxels_at;  // the raya_voxel_memory of its voxels, in the order of raya_local_voxel()
} raya_node;
RAYA_SHARED_SIZE(raya_node, sizeof(raya_job) + 4 * (7 + 10 + 7));

// The objects of a voxel. Their scene-wide object numbers are stored at numbers_at: those of the spheres, then
// those of the shapes (RAYA_SHAPE_LIST). Plane i has the scene-wide number first_plane + i.
typedef struct {
    raya_objects objects;
    raya_u32 numbers_at;
    raya_u32 first_plane;  // scene-wide number of the first plane: the number of spheres in the scene
} raya_voxel_memory;
RAYA_SHARED_SIZE(raya_voxel_memory, sizeof(raya_objects) + 4 * 2);

#endif
