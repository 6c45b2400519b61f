// The job: the 32-bit words that the host broadcasts to every PE. A header, then the scene in sections of fixed
// strides:
//
//   raya_job | surfaces | spheres | where the surface of each sphere starts | lights | planes | cones | polygons |
//   outline of each polygon, normals of a patch
//
// Every word holds a float (as its bits) or an unsigned integer. Objects are numbered consecutively: spheres, planes,
// polygons, cones. "at" words are distances from the job's first word.
#ifndef RAYA_SHARED_JOB_H
#define RAYA_SHARED_JOB_H
#include "kernels/shared/events.h"
#include "kernels/shared/mapping.h"
#include "kernels/shared/portable.h"

// The objects of a scene or of a voxel: the number of each kind, and where the words of its first object start.
typedef struct {
    raya_u32 spheres, planes, polygons, cones;
    raya_u32 spheres_at, planes_at, polygons_at, cones_at;
} raya_objects;
RAYA_SHARED_SIZE(raya_objects, 4 * 8);

typedef struct {
    raya_mapping mapping;
    raya_u32 bounces;  // reflections and refractions after the primary ray
    raya_u32 lights;   // number of lights
    raya_u32 lights_at;
    raya_objects objects;
    raya_u32 accel_at;  // where the grid or BVH starts; 0: none, every ray is tested against all objects
    raya_u32 cycles[RAYA_EVENTS];    // modelled cycles of one event of each kind
    float eye[3];                    // origin of the primary rays
    float corner[3];                 // unnormalised direction of the ray of row 0, column 0
    float column_step[3], row_step[3];  // added to it for each column, each row
    float background[3];             // radiance of a miss
    float ambient;                   // intensity A
    float extent;                    // size of the scene: largest coordinate of eye and finite objects, scene units
    raya_u32 unused[2];              // so that sections of rows start at a multiple of four words
} raya_job;
RAYA_SHARED_SIZE(raya_job, 4 * (5 + 3 + 8 + 1 + RAYA_EVENTS + 17 + 2));

enum {  // words of a surface
    RAYA_SURFACE_COLOUR = 0,      // r g b; colour `even` of a checker
    RAYA_SURFACE_DIFFUSE = 3,     // Kd
    RAYA_SURFACE_SPECULAR = 4,    // Ks
    RAYA_SURFACE_SHINE = 5,       // Phong exponent
    RAYA_SURFACE_TRANSMIT = 6,    // T
    RAYA_SURFACE_REFRACTION = 7,  // ior
    RAYA_SURFACE_ODD = 8,         // r g b: colour `odd` of a checker
    RAYA_SURFACE_CHECKER = 11,    // side of a square, 0 without a checker
    RAYA_SURFACE_WORDS = 12
};

enum { RAYA_LIGHT_POSITION = 0, RAYA_LIGHT_COLOUR = 3, RAYA_LIGHT_WORDS = 6 };

// The first words of every object: three of place (centre, normal or base), one of size, and, except for spheres, where
// its surface's words start.
enum { RAYA_OBJECT_PLACE = 0, RAYA_OBJECT_SIZE = 3, RAYA_OBJECT_SURFACE_AT = 4, RAYA_OBJECT_WORDS = 5 };

enum {  // words of a sphere: a row at a multiple of four words, so that one load reads it
    RAYA_SPHERE_CENTRE = RAYA_OBJECT_PLACE,
    RAYA_SPHERE_SQUARE = RAYA_OBJECT_SIZE,  // r^2, negated where only the inside is visible
    RAYA_SPHERE_WORDS = 4
};
// Returns where the surface words of a list's spheres start: behind the last sphere, one word for each, which holds
// where the sphere's surface starts.
RAYA_SHARED_FUNCTION raya_u32 raya_sphere_surfaces_at(raya_u32 spheres_at, raya_u32 spheres) {
    return spheres_at + spheres * RAYA_SPHERE_WORDS;
}

enum {  // words of a plane n.x = d
    RAYA_PLANE_NORMAL = RAYA_OBJECT_PLACE,   // unit
    RAYA_PLANE_DISTANCE = RAYA_OBJECT_SIZE,  // d
    RAYA_PLANE_WORDS = RAYA_OBJECT_WORDS
};

enum {  // words of a polygon behind those of its plane
    RAYA_POLYGON_AXIS = RAYA_OBJECT_WORDS,  // 0..2: the coordinate that its normals and a checker drop
    RAYA_POLYGON_CORNERS,                   // number of corners
    RAYA_POLYGON_CORNERS_AT,                // where they start
    RAYA_POLYGON_NORMALS_AT,                // where the normals of a patch start, 0 for a polygon
    RAYA_POLYGON_WORDS
};

// A corner of an outline: x y z, and an unused word, so that one load reads the row.
enum { RAYA_CORNER_WORDS = 4 };

// Shading normal of a patch: N0 + (u - u0) NU + (v - v0) NV, unnormalised.
enum { RAYA_PATCH_ORIGIN = 0, RAYA_PATCH_N0 = 2, RAYA_PATCH_NU = 5, RAYA_PATCH_NV = 8, RAYA_PATCH_WORDS = 11 };

enum {  // words of a cone
    RAYA_CONE_BASE = RAYA_OBJECT_PLACE,
    RAYA_CONE_RADIUS = RAYA_OBJECT_SIZE,  // r0 >= 0
    RAYA_CONE_AXIS = RAYA_OBJECT_WORDS,   // unit
    RAYA_CONE_HEIGHT = RAYA_CONE_AXIS + 3,
    RAYA_CONE_SLOPE,   // k
    RAYA_CONE_INSIDE,  // 1 where only the inside is visible
    RAYA_CONE_WORDS
};

#endif
