// The topology of the torus: its nodes, the voxels of each node, and its links.
//
// Node (i, j, k) holds the voxels (x, y, z) with x mod I = i, y mod J = j, z mod K = k (a cyclic distribution; one
// voxel per node if there are as many voxels as nodes along each axis). Nodes are numbered by their place on the torus:
// along the first side, then the second, then the third.
//
//   3-D torus  sides I x J x K; six links per node; node (i, j, k) lies at (i, j, k)
//   2-D torus  sides (I C) x (J K / C); four links per node, as a T805 has. The K slabs of nodes of equal k lie in C
//              columns, C a divisor of K: node (i, j, k) lies at (i + I (k mod C), j + J (k div C)). For example,
//              4 x 4 x 4 nodes form an 8 x 8 torus.
//
// Rays are routed in dimension order: along the first side of the torus, then the second, then the third. On each side
// they take the shorter direction, on a tie towards higher numbers. Returns follow raya_return_link().
#ifndef RAYA_SHARED_TORUS_H
#define RAYA_SHARED_TORUS_H
#include "kernels/shared/grid.h"

// Links of a node: link 2 d leads to the node with the next higher place along side d, link 2 d + 1 to the next lower.
#define RAYA_LINKS 6u
#define RAYA_NO_LINK RAYA_LINKS  // the packet is at its destination
#define RAYA_ROOT 0u             // the node that is connected to the host

typedef struct {
    raya_u32 nodes[3];  // I, J, K
    raya_u32 sides[3];  // sides of the torus, in nodes; the third is 1 on a 2-D torus
    raya_u32 slabs;     // C: 1 on a 3-D torus
} raya_torus;
RAYA_SHARED_SIZE(raya_torus, 4 * 7);

typedef struct {
    raya_u32 at[3];
} raya_place;  // place of a node on the torus, (i, j, k) of a node, or (x, y, z) of a voxel

RAYA_SHARED_FUNCTION raya_u32 raya_nodes(raya_torus t) { return t.nodes[0] * t.nodes[1] * t.nodes[2]; }

// Returns the place with the given number in a 3-D array whose first two sides are `side0` and `side1`. Numbers count
// along the first side, then the second, then the third.
RAYA_SHARED_FUNCTION raya_place raya_place_of(raya_u32 number, raya_u32 side0, raya_u32 side1) {
    raya_place p;
    p.at[0] = number % side0;
    p.at[1] = number / side0 % side1;
    p.at[2] = number / side0 / side1;
    return p;
}

RAYA_SHARED_FUNCTION raya_place raya_torus_place(raya_torus t, raya_u32 node) {
    return raya_place_of(node, t.sides[0], t.sides[1]);
}

RAYA_SHARED_FUNCTION raya_u32 raya_node_at(raya_torus t, raya_place p) {
    return p.at[0] + t.sides[0] * (p.at[1] + t.sides[1] * p.at[2]);
}

// Returns the number of node (i, j, k).
RAYA_SHARED_FUNCTION raya_u32 raya_node_of(raya_torus t, raya_u32 i, raya_u32 j, raya_u32 k) {
    raya_place p;
    p.at[0] = i + t.nodes[0] * (t.sides[2] == 1 ? k % t.slabs : 0);
    p.at[1] = j + t.nodes[1] * (t.sides[2] == 1 ? k / t.slabs : 0);
    p.at[2] = t.sides[2] == 1 ? 0 : k;
    return raya_node_at(t, p);
}

// Returns (i, j, k) of a node.
RAYA_SHARED_FUNCTION raya_place raya_node_place(raya_torus t, raya_u32 node) {
    raya_place p = raya_torus_place(t, node);
    if (t.sides[2] != 1) return p;
    raya_place n;
    n.at[0] = p.at[0] % t.nodes[0];
    n.at[1] = p.at[1] % t.nodes[1];
    n.at[2] = p.at[0] / t.nodes[0] + t.slabs * (p.at[1] / t.nodes[1]);
    return n;
}

RAYA_SHARED_FUNCTION raya_u32 raya_node_of_voxel(raya_torus t, raya_grid g, raya_u32 voxel) {
    const raya_place v = raya_place_of(voxel, g.divisions[0], g.divisions[1]);
    return raya_node_of(t, v.at[0] % t.nodes[0], v.at[1] % t.nodes[1], v.at[2] % t.nodes[2]);
}

// Returns how many coordinates a node's voxels have along an axis. They are first, first + step, ... < divisions.
RAYA_SHARED_FUNCTION raya_u32 raya_node_voxels_along(raya_torus t, raya_grid g, raya_place node, raya_u32 axis) {
    const raya_u32 first = node.at[axis], step = t.nodes[axis], end = g.divisions[axis];
    return first < end ? (end - first - 1) / step + 1 : 0;
}

RAYA_SHARED_FUNCTION raya_u32 raya_node_voxels(raya_torus t, raya_grid g, raya_u32 node) {
    const raya_place n = raya_node_place(t, node);
    return raya_node_voxels_along(t, g, n, 0) * raya_node_voxels_along(t, g, n, 1) * raya_node_voxels_along(t, g, n, 2);
}

// Returns the index of a voxel among those of its node: 0 .. raya_node_voxels() - 1.
RAYA_SHARED_FUNCTION raya_u32 raya_local_voxel(raya_torus t, raya_grid g, raya_u32 voxel) {
    const raya_place v = raya_place_of(voxel, g.divisions[0], g.divisions[1]);
    raya_place n;
    n.at[0] = v.at[0] % t.nodes[0];
    n.at[1] = v.at[1] % t.nodes[1];
    n.at[2] = v.at[2] % t.nodes[2];
    const raya_u32 along_x = raya_node_voxels_along(t, g, n, 0), along_y = raya_node_voxels_along(t, g, n, 1);
    return v.at[0] / t.nodes[0] + along_x * (v.at[1] / t.nodes[1] + along_y * (v.at[2] / t.nodes[2]));
}

// Returns the number of the voxel with index `local_index` among those of a node: the inverse of raya_local_voxel().
RAYA_SHARED_FUNCTION raya_u32 raya_voxel_of_node(raya_torus t, raya_grid g, raya_u32 node, raya_u32 local_index) {
    const raya_place n = raya_node_place(t, node);
    const raya_place l =
        raya_place_of(local_index, raya_node_voxels_along(t, g, n, 0), raya_node_voxels_along(t, g, n, 1));
    return raya_voxel(g, n.at[0] + t.nodes[0] * l.at[0], n.at[1] + t.nodes[1] * l.at[1],
                      n.at[2] + t.nodes[2] * l.at[2]);
}

// Returns the distance, in links, between two places along one side of the torus in the shorter direction. Sets `up` to
// 1 if that direction leads to higher places, else to 0.
RAYA_SHARED_FUNCTION raya_u32 raya_side_distance(raya_u32 from, raya_u32 to, raya_u32 side, int* up) {
    const raya_u32 higher = to >= from ? to - from : to + side - from;
    *up = higher <= side - higher;
    return *up ? higher : side - higher;
}

// Returns the link by which a ray packet leaves node `from` on its route to node `to`; RAYA_NO_LINK if they are the
// same.
RAYA_SHARED_FUNCTION raya_u32 raya_next_link(raya_torus t, raya_u32 from, raya_u32 to) {
    const raya_place a = raya_torus_place(t, from), b = raya_torus_place(t, to);
    for (raya_u32 d = 0; d < 3; ++d) {
        int up = 0;
        if (raya_side_distance(a.at[d], b.at[d], t.sides[d], &up)) return 2 * d + (up ? 0 : 1);
    }
    return RAYA_NO_LINK;
}

// Returns the link by which a node sends returns towards the root; RAYA_NO_LINK in the root. Routes are those of
// raya_next_link(), except that nodes begin with different sides of the torus, so that all links of the root share the
// load.
RAYA_SHARED_FUNCTION raya_u32 raya_return_link(raya_torus t, raya_u32 node) {
    const raya_place a = raya_torus_place(t, node), b = raya_torus_place(t, RAYA_ROOT);
    const raya_u32 first = a.at[0] + a.at[1] + a.at[2];
    for (raya_u32 i = 0; i < 3; ++i) {
        const raya_u32 d = (first + i) % 3;
        int up = 0;
        if (raya_side_distance(a.at[d], b.at[d], t.sides[d], &up)) return 2 * d + (up ? 0 : 1);
    }
    return RAYA_NO_LINK;
}

// Returns the node at the other end of a link.
RAYA_SHARED_FUNCTION raya_u32 raya_link_end(raya_torus t, raya_u32 node, raya_u32 link) {
    raya_place p = raya_torus_place(t, node);
    const raya_u32 d = link / 2, side = t.sides[d];
    p.at[d] = (p.at[d] + (link % 2 == 0 ? 1 : side - 1)) % side;
    return raya_node_at(t, p);
}

#endif
