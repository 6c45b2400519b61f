// Test kernel that traces given rays through a grid by kernels/grid/stepper.clh and records every voxel. Its arguments
// are those of `traverse` (traversal_probe.cl) except `wide`.
#include "kernels/checks/rays.clh"
#include "kernels/grid/stepper.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void stepped_traversal(__global const raya_grid* restrict grid,
                   __global const float* restrict rays,
                   const uint max_count,
                   __global uint* restrict voxels,  // [ray][max_count]
                   __global float* restrict t_exits) // [ray][max_count]
{
    const uint first = first_ray();
    const raya_grid g = *grid;
    const ray r = load_ray(rays, first);
    voxel_traversal w = start_traversal(r);
    real t_in, t_out;
    mask inside = meets_box(g, r, &w, &t_in, &t_out);
    enter_voxel(&w, g, r, choose(inside, t_in, num_all(0.0f)));
    voxel_stepper s = voxel_stepper_of(g, &w);
    for (uint i = 0; i < max_count && mask_any(inside); ++i) {
        lanes_index in, voxel;
        lanes_real t;
        in.truth = inside;
        voxel.all = s.voxel;
        t.all = stepper_t_exit(&s);
        for (uint lane = 0; lane < RAYA_LANES; ++lane) {
            if (!in.lane[lane]) continue;
            voxels[(first + lane) * max_count + i] = voxel.lane[lane];
            t_exits[(first + lane) * max_count + i] = t.lane[lane];
        }
        inside = advance_voxel(&s, g, inside, t_out);
    }
}
