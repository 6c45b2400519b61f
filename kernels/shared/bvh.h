// Layout of the BVH (bounding volume hierarchy) of a scene's finite objects. It follows the job's words (job.h) in
// memory.
//
// The BVH is an array of rows of 16 words; V lanes load V words of a row at once. A node consists of RAYA_BVH_NODE
// rows. Column c of these rows describes child c: its bounding box and a link to it. In fp32 a child is another node or
// a leaf. All objects of a leaf are of one kind:
//
//     spheres, cones     one object in each column: its words (job.h); row RAYA_BVH_NUMBERS has its object number
//     faces              polygons of three or four corners, one in each column: RAYA_BVH_FACES rows, or
//                        RAYA_BVH_TRIANGLES rows if all are triangles
//     one polygon        of more than four corners: one row of its data, then its corners, one in each column
//
// In a reduced format an object test costs ten times as much as in fp32, but a box test costs the same. So in these
// formats a child is another node or a single object, whose number the link contains. V rays are tested at once, each
// against its own object. Only polygons of more than 16 corners have leaves.
//
// Unused columns of a node hold a box that no ray meets. Unused columns of a leaf repeat its first object.
#ifndef RAYA_SHARED_BVH_H
#define RAYA_SHARED_BVH_H
#include "kernels/shared/job.h"

typedef struct {
    // If no coordinate of a ray's origin exceeds `reach` in absolute value, each hit of the ray lies in all boxes that
    // contain the object hit. All other rays must be tested against all objects. A negative `reach` is exceeded by
    // every ray.
    float reach;
    // In a reduced format, the boxes have no margin for the errors of distant rays. Instead a ray counts as wider by
    // (1.1 | |D|^2 - 1 | + spread) t at t, on all sides. 0 in fp32.
    float spread;
    raya_u32 root;         // link to the root; RAYA_NO_TREE without objects
    raya_u32 separate;     // number of separate objects: finite objects in no leaf, tested for every ray
    raya_u32 separate_at;  // offset of the separate objects' numbers (ascending), in words from the job's first word
    raya_u32 rows_at;      // offset of row 0, in words from the job's first word: a multiple of 16
} raya_bvh;
RAYA_SHARED_SIZE(raya_bvh, 4 * 6);

#define RAYA_BVH_WIDTH 16  // number of words in a row; maximum number of children of a node and of objects in a leaf

enum {                  // first row of each field of a node
    RAYA_BVH_LOW = 0,   // lowest x, y, z of the boxes
    RAYA_BVH_HIGH = 3,  // highest x, y, z of the boxes
    RAYA_BVH_LINKS = 6,
    RAYA_BVH_NODE = 7
};
#define RAYA_BVH_NUMBERS RAYA_OBJECT_SURFACE_AT  // a leaf has no offsets of surfaces
enum {  // first row of each field of a leaf of faces: x, y, z of corners 1 to 3; plane; object number; and, unless all
        // are triangles, x, y, z of corner 4 (of a triangle: corner 3 again)
    RAYA_BVH_CORNERS = 0,
    RAYA_BVH_PLANE = 9,
    RAYA_BVH_FACE_NUMBERS = 13,
    RAYA_BVH_TRIANGLES = 14,
    RAYA_BVH_FOURTH = 14,
    RAYA_BVH_FACES = 17
};
#define RAYA_BVH_MAX_CORNERS 4
enum {  // first word of each field in the first row of a polygon's leaf
    RAYA_BVH_OUTLINE_NUMBER = 0,
    RAYA_BVH_OUTLINE_CORNERS = 1,  // number of corners
    RAYA_BVH_OUTLINE_PLANE = 2,
    RAYA_BVH_OUTLINE_LOW = 6,  // lowest x, y, z of the corners; RAYA_BVH_OUTLINE_HIGH: highest
    RAYA_BVH_OUTLINE_HIGH = 9
};

// Returns the number of rows that hold one coordinate of a polygon's corners. After the first row of the leaf come the
// x of all corners, then the y, then the z. The columns after the last corner repeat the first corner. There is one row
// more than the corners need, so that a test of V edges at once can read the next corner of every edge.
RAYA_SHARED_FUNCTION raya_u32 raya_outline_rows(raya_u32 corners) {
    return (corners + RAYA_BVH_WIDTH - 1) / RAYA_BVH_WIDTH + 1;
}

// Maximum distance by which a hit in fp32 may lie outside of its object's box, relative to raya_bvh.reach.
#define RAYA_BVH_HIT_MARGIN 0x1p-14f

// A link is one word. Bits 29..31 are the kind of the link's target. If the target is an object (RAYA_LINK_OBJECT),
// bits 0..28 are the object's number. Else bits 25..28 are the number of objects in the leaf - 1, and bits 0..24 are
// the target's first row.
#define RAYA_LINK_ROW 0x01ffffffu
#define RAYA_LINK_OBJECTS_SHIFT 25u
#define RAYA_LINK_KIND_SHIFT 29u
#define RAYA_LINK_NUMBER 0x1fffffffu
#define RAYA_LINK_ENUMERATOR(kind, kinds, KIND) RAYA_LINK_##KIND##S,
enum {
    RAYA_LINK_NODE,
    RAYA_LINK_SPHERES,
    RAYA_LINK_TRIANGLES,
    RAYA_LINK_FACES,
    RAYA_LINK_POLYGON,
    RAYA_FIXED_LIST(RAYA_LINK_ENUMERATOR) RAYA_LINK_OBJECT
};
#define RAYA_NO_TREE 0xffffffffu  // raya_bvh.root of a BVH without objects

RAYA_SHARED_FUNCTION raya_u32 raya_link(raya_u32 kind, raya_u32 objects, raya_u32 row) {
    return kind << RAYA_LINK_KIND_SHIFT | (objects - 1) << RAYA_LINK_OBJECTS_SHIFT | row;
}
RAYA_SHARED_FUNCTION raya_u32 raya_link_kind(raya_u32 link) { return link >> RAYA_LINK_KIND_SHIFT; }
RAYA_SHARED_FUNCTION raya_u32 raya_link_objects(raya_u32 link) { return (link >> RAYA_LINK_OBJECTS_SHIFT & 15u) + 1; }
RAYA_SHARED_FUNCTION raya_u32 raya_link_row(raya_u32 link) { return link & RAYA_LINK_ROW; }
RAYA_SHARED_FUNCTION raya_u32 raya_link_to_object(raya_u32 number) {
    return (raya_u32)RAYA_LINK_OBJECT << RAYA_LINK_KIND_SHIFT | number;
}
RAYA_SHARED_FUNCTION raya_u32 raya_link_number(raya_u32 link) { return link & RAYA_LINK_NUMBER; }

#endif
