// Test kernel: traces given rays through a grid by kernels/grid/stepper.clh and records every voxel. Buffers are those
// of walk_probe.cl.
#include "kernels/checks/rays.clh"
#include "kernels/grid/stepper.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void stepped_walks(__global const raya_grid* restrict grid,
                   __global const float* restrict rays,
                   const uint most,
                   __global uint* restrict voxels,  // [ray][most]
                   __global float* restrict leaves) // [ray][most]
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    voxel_walk w = start_of_walk(r);
    real t_in, t_out;
    mask walking = meets_box(g, r, &w, &t_in, &t_out);
    enter_voxel(&w, g, r, choose(walking, t_in, num_all(0.0f)));
    steps_of_rays s = steps_of(g, &w);
    for (uint i = 0; i < most && mask_any(walking); ++i) {
        lanes_index in, voxel;
        lanes_real t;
        in.truth = walking;
        voxel.all = s.voxel;
        t.all = leaving_at(&s);
        for (uint lane = 0; lane < RAYA_LANES; ++lane) {
            if (!in.lane[lane]) continue;
            voxels[(first + lane) * most + i] = voxel.lane[lane];
            leaves[(first + lane) * most + i] = t.lane[lane];
        }
        walking = step_on(&s, g, walking, t_out);
    }
}
