// What decides which objects a ray is tested against on the ring machine, as RAYA_ACCEL.
#ifndef RAYA_SHARED_ACCEL_H
#define RAYA_SHARED_ACCEL_H

#define RAYA_ACCEL_NONE 0  // nothing: all objects
#define RAYA_ACCEL_GRID 1  // voxels (grid.h)
#define RAYA_ACCEL_BVH 2   // a tree of boxes (bvh.h)

#endif
