// Test kernel that finds the nearest hits of given rays (kernels/checks/rows.clh) in one voxel of a torus node.
#include "kernels/checks/rows.clh"
#include "kernels/shading/shade.clh"
#include "kernels/shared/node.h"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void voxel_hits(__global const uint* restrict memories,  // words of all nodes' memories
                __global const float* restrict rays,
                const uint start,                        // offset of the node's memory, in words
                const uint voxel,                        // index of the voxel in the node; the node's number of
                                                         // voxels selects a test of the planes alone
                __global uint* restrict objects,         // [ray]: object number in the voxel; RAYA_NO_OBJECT: miss
                __global float* restrict distances,      // [ray]: distance of the hit; for a miss the ray's limit
                __global float* restrict places)         // [ray][3][3]: geometric normal, normal, colour; undefined
                                                         // for a miss
{
    const words scene = memories + start;
    __global const raya_node* const node = (__global const raya_node*)scene;
    __global const raya_voxel_memory* const voxels = (__global const raya_voxel_memory*)(scene + node->voxels_at);
    const objects_words all = voxel < node->voxels ? &voxels[voxel].objects : &node->job.objects;
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const hit h = closest_hit(scene, all, r, 0);
    store_index(objects + first, 1, h.object);
    store_lanes(distances + first, 1, h.distance);
    const mask struck = h.object != RAYA_NO_OBJECT;
    const hit_place p = find_place(scene, all, struck, h, r.origin, r.direction);
    store_vec(places + first * 9, 9, p.geometric);
    store_vec(places + first * 9 + 3, 9, p.normal);
    store_vec(places + first * 9 + 6, 9, surface_colour(scene, struck, &p));
}
