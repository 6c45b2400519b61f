// The nearest hits of given rays, by testing all objects and, where RAYA_ACCEL is 1 and the job has a grid, by the walk
// through it. The job's words lie in global memory.
#include "kernels/checks/rays.clh"
#include "kernels/shading/search.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_of_all(__global const uint* restrict job,
                 __global const float* restrict rays,
                 __global uint* restrict objects,    // [ray]: number, RAYA_NO_OBJECT
                 __global uint* restrict distances)  // [ray]: bits; the limit where nothing is hit
{
    const uint first = first_ray();
    const hit h = closest_hit(job, &((job_words)job)->objects, load_ray(rays, first));
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}

#if RAYA_ACCEL == RAYA_ACCEL_GRID
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_by_grid(__global const uint* restrict job,
                  __global const float* restrict rays,
                  __global uint* restrict objects,    // as above
                  __global uint* restrict distances)
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    tree t;
    ray_pool pool;
    clear_tree(&t);
    open_pool(&pool);
    put_rays(job, &pool, 0, &t, r.limit > 0.0f, &r, 0);
    find_hits(job, &pool, 0);
    const hit h = take_hit(&pool, 0, &t);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}
#endif
