// A tree of boxes over a scene's finite objects, as it lies behind a job's words.
//
// Rows of 16 words: what sixteen lanes read at once. A node is RAYA_BVH_NODE rows, one column for each child: its box,
// and a link to what it holds. A leaf of spheres is RAYA_BVH_SPHERES rows, one column a sphere; one of polygons of
// three or four corners is RAYA_BVH_FACES rows, one column a polygon; a leaf of other objects is a row of their
// numbers. Columns of a node that no child has hold a box that no ray meets; columns of a leaf beyond its last object
// repeat the first.
#ifndef RAYA_SHARED_BVH_H
#define RAYA_SHARED_BVH_H
#include "kernels/shared/portable.h"

typedef struct {
    // Largest coordinate of a ray's origin for which a hit is sure to lie in the boxes that its object is in; a ray
    // from farther away has to be tested against all objects. Below 0: every ray has to.
    float reach;
    raya_u32 root;     // link
    raya_u32 rows_at;  // distance of row 0 from the job's first word, a multiple of 16
} raya_bvh;
RAYA_SHARED_SIZE(raya_bvh, 4 * 3);

#define RAYA_BVH_WIDTH 16  // children of a node, objects of a leaf, words of a row

enum {                  // rows of a node
    RAYA_BVH_LOW = 0,   // x, y, z: the corners of the boxes with the lowest coordinates
    RAYA_BVH_HIGH = 3,  // x, y, z: with the highest
    RAYA_BVH_LINKS = 6,
    RAYA_BVH_NODE = 7
};
enum {  // rows of a leaf of spheres: the words of their objects (kernels/shared/job.h), and their numbers
    RAYA_BVH_CENTRE = 0,
    RAYA_BVH_SQUARE = 3,
    RAYA_BVH_NUMBERS = 4,
    RAYA_BVH_SPHERES = 5
};

enum {  // rows of a leaf of polygons: x, y, z of each corner, the third one twice where there is no fourth; their
        // planes
    RAYA_BVH_CORNERS = 0,
    RAYA_BVH_PLANE = 12,
    RAYA_BVH_FACE_NUMBERS = 16,
    RAYA_BVH_FACES = 17
};
#define RAYA_BVH_MOST_CORNERS 4

// A link: the kind of what it leads to in bits 29..31, a leaf's objects - 1 in bits 25..28, the first row in bits
// 0..24.
#define RAYA_LINK_ROW 0x01ffffffu
#define RAYA_LINK_OBJECTS_SHIFT 25u
#define RAYA_LINK_KIND_SHIFT 29u
enum { RAYA_LINK_NODE, RAYA_LINK_SPHERES, RAYA_LINK_FACES, RAYA_LINK_POLYGONS, RAYA_LINK_CONES };
#define RAYA_NO_LINK 0xffffffffu  // of a tree without objects

RAYA_SHARED_FUNCTION raya_u32 raya_link(raya_u32 kind, raya_u32 objects, raya_u32 row) {
    return kind << RAYA_LINK_KIND_SHIFT | (objects - 1) << RAYA_LINK_OBJECTS_SHIFT | row;
}
RAYA_SHARED_FUNCTION raya_u32 raya_link_kind(raya_u32 link) { return link >> RAYA_LINK_KIND_SHIFT; }
RAYA_SHARED_FUNCTION raya_u32 raya_link_objects(raya_u32 link) { return (link >> RAYA_LINK_OBJECTS_SHIFT & 15u) + 1; }
RAYA_SHARED_FUNCTION raya_u32 raya_link_row(raya_u32 link) { return link & RAYA_LINK_ROW; }

#endif
