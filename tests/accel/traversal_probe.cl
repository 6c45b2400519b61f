// Test kernels that trace given rays (kernels/checks/rows.clh) through a grid by kernels/grid/traversal.clh.
#include "kernels/checks/rows.clh"
#include "kernels/grid/traversal.clh"

// Records every voxel on each ray.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void traverse(__global const raya_grid* restrict grid,
              __global const float* restrict rays,
              const uint max_count,            // maximum number of voxels on a ray
              __global uint* restrict wide,    // [ray]: 1 if the ray is wide, else 0
              __global uint* restrict voxels,  // [ray][max_count]: voxel numbers in the order of traversal, then
                                               // RAYA_NO_VOXEL
              __global float* restrict t_exits) // [ray][max_count]: t at which the ray leaves each voxel
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    store_index(wide + first, 1, choose_index(is_wide(g.reach, r), (index)(1), (index)(0)));
    voxel_traversal w = enter_grid(g, r, mask_all(1));
    for (uint i = 0; i < max_count; ++i) {
        const mask inside = w.voxel != RAYA_NO_VOXEL;
        if (!mask_any(inside)) return;
        store_index(voxels + first * max_count + i, max_count, w.voxel);
        store_lanes(t_exits + first * max_count + i, max_count, choose(inside, t_exit_of(&w), num_all(0.0f)));
        next_voxel(&w, g, inside);
    }
}

// Resumes each ray's traversal in each of the voxels that `traverse` has recorded.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void resume_in_voxels(__global const raya_grid* restrict grid,
             __global const float* restrict rays,
             const uint max_count,
             __global const uint* restrict voxels,  // [ray][max_count], results of `traverse`
             __global float* restrict t_exits,      // [ray][max_count]: t at which the ray leaves each voxel
             __global uint* restrict next_voxels)   // [ray][max_count]: the voxel that follows each voxel
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    for (uint lane = 0; lane < RAYA_LANES; ++lane)
        for (uint i = (first + lane) * max_count; i < (first + lane + 1) * max_count && voxels[i] != RAYA_NO_VOXEL;
             ++i) {
            const uint x = voxels[i] % g.divisions[0], y = voxels[i] / g.divisions[0] % g.divisions[1];
            voxel_traversal w = resume_traversal(g, r, x, y, voxels[i] / g.divisions[0] / g.divisions[1]);
            lanes_real t;
            lanes_index next;
            t.all = t_exit_of(&w);
            next_voxel(&w, g, mask_all(1));
            next.all = w.voxel;
            t_exits[i] = t.lane[lane];
            next_voxels[i] = next.lane[lane];
        }
}

// Applies is_wide() to rays with normalised directions, and to the same rays after a reflection at a normalised normal.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void find_wide_rays(__global const raya_grid* restrict grid,
                     __global const float* restrict arms,  // [ray][6]: a direction and a normal, not normalised
                     __global uint* restrict wide)         // [ray][2]: 1 if the ray [0] or its reflected ray [1]
                                                           // is wide, else 0
{
    const uint first = first_ray();
    const vec zero = {num_all(0.0f), num_all(0.0f), num_all(0.0f)};
    const vec d = vec_normalize(load_vec(arms + first * 6, 6)), n = vec_normalize(load_vec(arms + first * 6 + 3, 6));
    const ray sent = {zero, d, num_all(1.0f)};
    const ray reflected = {zero, vec_mad(n, num_mul(num_const(-2.0f), vec_dot(n, d)), d), num_all(1.0f)};
    store_index(wide + first * 2, 2, choose_index(is_wide(grid->reach, sent), (index)(1), (index)(0)));
    store_index(wide + first * 2 + 1, 2, choose_index(is_wide(grid->reach, reflected), (index)(1), (index)(0)));
}
