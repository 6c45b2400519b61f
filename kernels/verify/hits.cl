// The nearest hits of given rays, by testing all objects and by the walk through the grid. A work-group is one
// work-item, which takes the next V rays; `rays` holds origin, direction and limit of each: [ray][7]. The numbers of
// rays are multiples of V. Built with RAYA_ACCEL=1, the job has a grid, its words lie in global memory.
#include "kernels/shading/search.clh"
#include "kernels/verify/rows.clh"

static inline ray load_ray(__global const float* rays, uint first) {
    __global const float* from = rays + first * 7;
    const ray r = {load_vec(from, 7), load_vec(from + 3, 7), load_lanes(from + 6, 7)};
    return r;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_of_all(__global const uint* restrict job,
                 __global const float* restrict rays,
                 __global uint* restrict objects,    // [ray]: number, RAYA_NO_OBJECT
                 __global uint* restrict distances)  // [ray]: bits; the limit where nothing is hit
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const hit h = closest_hit(job, &((job_words)job)->objects, load_ray(rays, first));
    store_index(objects + first, h.object);
    store_bits(distances + first, h.distance);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_by_grid(__global const uint* restrict job,
                  __global const float* restrict rays,
                  __global uint* restrict objects,    // as above
                  __global uint* restrict distances)
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const ray r = load_ray(rays, first);
    tree t;
    ray_pool pool;
    clear_tree(&t);
    open_pool(&pool);
    put_rays(job, &pool, 0, &t, r.limit > 0.0f, r, 0);
    find_hits(job, &pool, 0);
    const hit h = take_hit(&pool, 0, &t);
    store_index(objects + first, h.object);
    store_bits(distances + first, h.distance);
}
