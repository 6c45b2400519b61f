// Values of RAYA_ACCEL: the acceleration structure that the ring machine's kernels are built for.
#ifndef RAYA_SHARED_ACCEL_H
#define RAYA_SHARED_ACCEL_H

#define RAYA_ACCEL_NONE 0  // none: every ray is tested against all objects
#define RAYA_ACCEL_GRID 1  // uniform grid of voxels (grid.h)
#define RAYA_ACCEL_BVH 2   // bounding volume hierarchy (bvh.h)

#endif
