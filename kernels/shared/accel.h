// The acceleration structures of the ring machine: values of RAYA_ACCEL.
#ifndef RAYA_SHARED_ACCEL_H
#define RAYA_SHARED_ACCEL_H

#define RAYA_ACCEL_NONE 0  // none: every ray is tested against all objects
#define RAYA_ACCEL_GRID 1  // uniform grid of voxels (grid.h)
#define RAYA_ACCEL_BVH 2   // bounding volume hierarchy (bvh.h)

#endif
