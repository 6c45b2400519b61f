// The job: the 32-bit words that the host broadcasts to every PE. It consists of a header and the scene's sections:
//
//   raya_job | surfaces | spheres | for each sphere, the offset of its surface | lights | planes | cones | polygons |
//   for each polygon, its corners and, of a patch, its normals
//
// Every word holds the bits of a float or an unsigned integer. Objects are numbered from 0, kind after kind, in the
// order of RAYA_OBJECT_LIST. Members named *_at are offsets in words from the job's first word.
#ifndef RAYA_SHARED_JOB_H
#define RAYA_SHARED_JOB_H
#include "kernels/shared/events.h"
#include "kernels/shared/mapping.h"
#include "kernels/shared/portable.h"

// KIND(singular, plural, SINGULAR) for each kind of objects. RAYA_FIXED_LIST: finite objects that are described by the
// same number of words; RAYA_SHAPE_LIST: these and polygons, which have corners.
#define RAYA_FIXED_LIST(KIND) KIND(cone, cones, CONE)
#define RAYA_SHAPE_LIST(KIND) KIND(polygon, polygons, POLYGON) RAYA_FIXED_LIST(KIND)
#define RAYA_OBJECT_LIST(KIND) KIND(sphere, spheres, SPHERE) KIND(plane, planes, PLANE) RAYA_SHAPE_LIST(KIND)

#define RAYA_KIND_ENUMERATOR(kind, kinds, KIND) RAYA_##KIND,
enum { RAYA_OBJECT_LIST(RAYA_KIND_ENUMERATOR) RAYA_OBJECT_KINDS };

// The objects of a scene or of a voxel: the number of objects of each kind, and the offset of the first object of each
// kind.
typedef struct {
#define RAYA_KIND_MEMBERS(kind, kinds, KIND) raya_u32 kinds, kinds##_at;
    RAYA_OBJECT_LIST(RAYA_KIND_MEMBERS)
} raya_objects;
RAYA_SHARED_SIZE(raya_objects, 4 * 2 * RAYA_OBJECT_KINDS);

// Returns the object number of the first object of a kind; for RAYA_OBJECT_KINDS, the number of objects.
RAYA_SHARED_FUNCTION raya_u32 raya_first_object(raya_objects all, raya_u32 kind) {
#define RAYA_EARLIER_KIND(other, others, OTHER) +(RAYA_##OTHER < kind ? all.others : 0)
    return 0 RAYA_OBJECT_LIST(RAYA_EARLIER_KIND);
}

#define RAYA_JOB_WORDS (5 + 3 + 2 * RAYA_OBJECT_KINDS + 1 + RAYA_EVENTS + 17)  // of the header, without padding
typedef struct {
    raya_mapping mapping;
    raya_u32 bounces;  // maximum number of reflections and refractions from a primary ray to a ray of its tree
    raya_u32 lights;   // number of lights
    raya_u32 lights_at;
    raya_objects objects;
    raya_u32 accel_at;  // offset of the grid or BVH; 0: there is none, so every ray is tested against all objects
    raya_u32 cycles[RAYA_EVENTS];             // modelled cycles of one event of each kind (events.h)
    float eye[3];                             // origin of the primary rays
    float corner[3];                          // direction of the primary ray of row 0, column 0, not normalised
    float column_step[3], row_step[3];        // added to `corner` for each column, for each row
    float background[3];                      // radiance of rays that hit nothing
    float ambient;                            // ambient intensity A
    float extent;                             // largest absolute coordinate of eye and finite objects, in scene units
    raya_u32 unused[4 - RAYA_JOB_WORDS % 4];  // pads the header, so that the spheres start at a multiple of four words
} raya_job;
RAYA_SHARED_SIZE(raya_job, 4 * (RAYA_JOB_WORDS + 4 - RAYA_JOB_WORDS % 4));

// Values of RAYA_ACCEL: the acceleration structure that the ring machine's kernels are built for.
#define RAYA_ACCEL_NONE 0  // none: every ray is tested against all objects
#define RAYA_ACCEL_GRID 1  // uniform grid of voxels (grid.h)
#define RAYA_ACCEL_BVH 2   // bounding volume hierarchy (bvh.h)

enum {                            // words of a surface
    RAYA_SURFACE_COLOUR = 0,      // r, g, b; with a checker, of its even squares
    RAYA_SURFACE_DIFFUSE = 3,     // Kd
    RAYA_SURFACE_SPECULAR = 4,    // Ks
    RAYA_SURFACE_SHINE = 5,       // Phong exponent
    RAYA_SURFACE_TRANSMIT = 6,    // T
    RAYA_SURFACE_REFRACTION = 7,  // ior
    RAYA_SURFACE_ODD = 8,         // r, g, b of the checker's odd squares
    RAYA_SURFACE_CHECKER = 11,    // side of a square in scene units, 0 without a checker
    RAYA_SURFACE_WORDS = 12
};

enum { RAYA_LIGHT_POSITION = 0, RAYA_LIGHT_COLOUR = 3, RAYA_LIGHT_WORDS = 6 };

// The first words of every object: three for its place (a sphere's centre, a plane's normal, a cone's base), one for
// its size (r^2, d or r0) and, except for spheres, the offset of its surface.
enum { RAYA_OBJECT_PLACE = 0, RAYA_OBJECT_SIZE = 3, RAYA_OBJECT_SURFACE_AT = 4, RAYA_OBJECT_WORDS = 5 };

enum {  // words of a sphere, aligned to four words, so that one load reads them
    RAYA_SPHERE_CENTRE = RAYA_OBJECT_PLACE,
    RAYA_SPHERE_SQUARE = RAYA_OBJECT_SIZE,  // r^2, negated if only the inside is visible
    RAYA_SPHERE_WORDS = 4
};
// Returns the offset of the spheres' surface words. They follow the last sphere: one word for each sphere, the offset
// of its surface.
RAYA_SHARED_FUNCTION raya_u32 raya_sphere_surfaces_at(raya_u32 spheres_at, raya_u32 spheres) {
    return spheres_at + spheres * RAYA_SPHERE_WORDS;
}

enum {                                       // words of a plane n.x = d
    RAYA_PLANE_NORMAL = RAYA_OBJECT_PLACE,   // unit vector
    RAYA_PLANE_DISTANCE = RAYA_OBJECT_SIZE,  // d
    RAYA_PLANE_WORDS = RAYA_OBJECT_WORDS
};

enum {                                      // words of a polygon after those of its plane
    RAYA_POLYGON_AXIS = RAYA_OBJECT_WORDS,  // 0..2: axis along which a patch's points are projected to (u, v)
    RAYA_POLYGON_CORNERS,                   // number of corners
    RAYA_POLYGON_CORNERS_AT,                // offset of the first corner
    RAYA_POLYGON_NORMALS_AT,                // offset of the normals of a patch; 0 for a polygon
    RAYA_POLYGON_WORDS
};

// A corner of a polygon: x, y, z and an unused word, so that one load reads all four.
enum { RAYA_CORNER_WORDS = 4 };

// Words of a patch's shading normal, which at (u, v) is N0 + (u - u0) NU + (v - v0) NV, not normalised.
// RAYA_PATCH_ORIGIN: u0, v0.
enum { RAYA_PATCH_ORIGIN = 0, RAYA_PATCH_N0 = 2, RAYA_PATCH_NU = 5, RAYA_PATCH_NV = 8, RAYA_PATCH_WORDS = 11 };

enum {  // words of a cone
    RAYA_CONE_BASE = RAYA_OBJECT_PLACE,
    RAYA_CONE_RADIUS = RAYA_OBJECT_SIZE,  // r0 >= 0
    RAYA_CONE_AXIS = RAYA_OBJECT_WORDS,   // unit vector
    RAYA_CONE_HEIGHT = RAYA_CONE_AXIS + 3,
    RAYA_CONE_SLOPE,   // slope k = (r1 - r0) / h
    RAYA_CONE_INSIDE,  // 1 if only the inside is visible, else 0
    RAYA_CONE_WORDS
};

#endif
