// The BVH (bounding volume hierarchy) over a scene's finite objects: its layout behind a job's words.
//
// The BVH consists of rows of 16 words; up to sixteen lanes load a row at once. A node is RAYA_BVH_NODE rows, one
// column for each child: the child's box, and a link to the child. In fp32 a child is another node or a leaf of objects
// of one kind:
//
//     spheres, cones     one in each column, RAYA_BVH_SPHERES or RAYA_BVH_CONES rows
//     faces              polygons of three or four corners, one in each column: RAYA_BVH_FACES rows, RAYA_BVH_TRIANGLES
//                        where none has four
//     a polygon          of more corners: a row for the polygon, then its corners, one in each column
//
// In a reduced format an object test costs ten times as much as in fp32, a box test no more. So there a link leads to
// another node or, by its number, to a single object, and V rays test one object each. A polygon of more than 16
// corners still has a leaf.
//
// Unused columns of a node hold a box that no ray meets. Columns of a leaf beyond its last object repeat the first.
#ifndef RAYA_SHARED_BVH_H
#define RAYA_SHARED_BVH_H
#include "kernels/shared/portable.h"

typedef struct {
    // Largest coordinate of a ray's origin for which every hit lies in the boxes of its object. A ray from farther away
    // must be tested against all objects. Below 0: every ray must.
    float reach;
    raya_u32 root;      // link to the root; RAYA_NO_TREE without objects
    raya_u32 apart;     // separate objects: finite, in no leaf, tested for every ray
    raya_u32 apart_at;  // where their numbers start, ascending: distance from the job's first word
    raya_u32 rows_at;   // where row 0 starts: distance from the job's first word, a multiple of 16
} raya_bvh;
RAYA_SHARED_SIZE(raya_bvh, 4 * 5);

#define RAYA_BVH_WIDTH 16  // children of a node, objects of a leaf, words of a row

enum {                  // rows of a node
    RAYA_BVH_LOW = 0,   // lowest x, y, z of the boxes
    RAYA_BVH_HIGH = 3,  // highest x, y, z of the boxes
    RAYA_BVH_LINKS = 6,
    RAYA_BVH_NODE = 7
};
enum {  // rows of a leaf of spheres: the words of their objects (kernels/shared/job.h), and their numbers
    RAYA_BVH_CENTRE = 0,
    RAYA_BVH_SQUARE = 3,
    RAYA_BVH_NUMBERS = 4,
    RAYA_BVH_SPHERES = 5
};
enum {  // rows of a leaf of faces: x, y, z of their first three corners, their planes, their numbers, and x, y, z of
        // their last corners: fourth or third
    RAYA_BVH_CORNERS = 0,
    RAYA_BVH_PLANE = 9,
    RAYA_BVH_FACE_NUMBERS = 13,
    RAYA_BVH_TRIANGLES = 14,
    RAYA_BVH_FOURTH = 14,
    RAYA_BVH_FACES = 17
};
#define RAYA_BVH_MOST_CORNERS 4
enum {  // words of a polygon's first row
    RAYA_BVH_OUTLINE_NUMBER = 0,
    RAYA_BVH_OUTLINE_CORNERS = 1,  // number of corners
    RAYA_BVH_OUTLINE_PLANE = 2,
    RAYA_BVH_OUTLINE_LOW = 6,  // x, y, z: bounding box of the corners
    RAYA_BVH_OUTLINE_HIGH = 9
};
enum {  // rows of a leaf of cones: the words of their objects, and their numbers
    RAYA_BVH_BASE = 0,
    RAYA_BVH_RADIUS = 3,
    RAYA_BVH_AXIS = 4,
    RAYA_BVH_HEIGHT = 7,
    RAYA_BVH_SLOPE = 8,
    RAYA_BVH_INSIDE = 9,
    RAYA_BVH_CONE_NUMBERS = 10,
    RAYA_BVH_CONES = 11
};

// Rows of each coordinate of a polygon's corners. Behind the polygon's first row come x of all corners, then y, then z.
// The first corner is repeated behind the last one, in all columns up to the end; there is at least one column more
// than edges rounded up to whole rows.
RAYA_SHARED_FUNCTION raya_u32 raya_outline_rows(raya_u32 corners) {
    return (corners + RAYA_BVH_WIDTH - 1) / RAYA_BVH_WIDTH + 1;
}

// A link: the kind of its target in bits 29..31. For an object, the other bits are its number. Else bits 25..28 are a
// leaf's objects - 1, bits 0..24 the target's first row.
#define RAYA_LINK_ROW 0x01ffffffu
#define RAYA_LINK_OBJECTS_SHIFT 25u
#define RAYA_LINK_KIND_SHIFT 29u
#define RAYA_LINK_NUMBER 0x1fffffffu
enum {
    RAYA_LINK_NODE,
    RAYA_LINK_SPHERES,
    RAYA_LINK_TRIANGLES,
    RAYA_LINK_FACES,
    RAYA_LINK_POLYGON,
    RAYA_LINK_CONES,
    RAYA_LINK_OBJECT
};
#define RAYA_NO_TREE 0xffffffffu  // root of a tree without objects

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
