// Test kernels: trace given rays (kernels/checks/rays.clh) through a grid by kernels/grid/walk.clh and record every
// voxel.
#include "kernels/checks/rays.clh"
#include "kernels/grid/walk.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void walks(__global const raya_grid* restrict grid,
           __global const float* restrict rays,
           const uint most,               // maximum number of voxels on a ray
           __global uint* restrict wide,    // [ray]: 1 if the ray is wide, else 0
           __global uint* restrict voxels,  // [ray][most]: voxel numbers in the order of traversal, then RAYA_NO_VOXEL
           __global float* restrict leaves) // [ray][most]: t at which the ray leaves each voxel
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    store_index(wide + first, 1, choose_index(is_wide(g.reach, r), (index)(1), (index)(0)));
    voxel_walk w = enter_grid(g, r, mask_all(1));
    for (uint i = 0; i < most; ++i) {
        const mask walking = w.voxel != RAYA_NO_VOXEL;
        if (!mask_any(walking)) return;
        store_index(voxels + first * most + i, most, w.voxel);
        store_lanes(leaves + first * most + i, most, choose(walking, leaves_at(&w), num_all(0.0f)));
        next_voxel(&w, g, walking);
    }
}

// Resumes each ray's traversal in each of the voxels that `walks` has recorded.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void resumes(__global const raya_grid* restrict grid,
             __global const float* restrict rays,
             const uint most,
             __global const uint* restrict voxels,  // [ray][most], results of `walks`
             __global float* restrict leaves,       // [ray][most]: t at which the ray leaves each voxel
             __global uint* restrict nexts)         // [ray][most]: the voxel that follows each voxel
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    for (uint lane = 0; lane < RAYA_LANES; ++lane)
        for (uint i = (first + lane) * most; i < (first + lane + 1) * most && voxels[i] != RAYA_NO_VOXEL; ++i) {
            const uint x = voxels[i] % g.divisions[0], y = voxels[i] / g.divisions[0] % g.divisions[1];
            voxel_walk w = resume_walk(g, r, x, y, voxels[i] / g.divisions[0] / g.divisions[1]);
            lanes_real t;
            lanes_index next;
            t.all = leaves_at(&w);
            next_voxel(&w, g, mask_all(1));
            next.all = w.voxel;
            leaves[i] = t.lane[lane];
            nexts[i] = next.lane[lane];
        }
}

// Applies is_wide() to rays with normalised directions, and to these rays after one reflection at a normalised normal.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void made_directions(__global const raya_grid* restrict grid,
                     __global const float* restrict arms,  // [ray][6]: a direction and a normal, not normalised
                     __global uint* restrict wide)         // [ray][2]: 1 if the ray, the reflected ray is wide; else 0
{
    const uint first = first_ray();
    const vec zero = {num_all(0.0f), num_all(0.0f), num_all(0.0f)};
    const vec d = vec_normalize(load_vec(arms + first * 6, 6)), n = vec_normalize(load_vec(arms + first * 6 + 3, 6));
    const ray sent = {zero, d, num_all(1.0f)};
    const ray reflected = {zero, vec_mad(n, num_mul(num_const(-2.0f), vec_dot(n, d)), d), num_all(1.0f)};
    store_index(wide + first * 2, 2, choose_index(is_wide(grid->reach, sent), (index)(1), (index)(0)));
    store_index(wide + first * 2 + 1, 2, choose_index(is_wide(grid->reach, reflected), (index)(1), (index)(0)));
}
