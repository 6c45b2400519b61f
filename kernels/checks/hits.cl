// Checks of hits: the nearest hits of given rays, found by testing all objects and, if the job has the structure that
// RAYA_ACCEL names, by the ring machine's search. The job's words lie in global memory. The host compares the results.
#include "kernels/checks/rays.clh"
#include "kernels/shading/search.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_of_all(__global const uint* restrict job,
                 __global const float* restrict rays,
                 __global uint* restrict objects,    // [ray]: number, RAYA_NO_OBJECT without a hit
                 __global uint* restrict distances)  // [ray]: bits of t; of the limit without a hit
{
    const uint first = first_ray();
    const hit h = closest_hit(job, &((job_words)job)->objects, load_ray(rays, first), 0);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}

#if RAYA_ACCEL != RAYA_ACCEL_NONE
// `shadow`: any hit suffices.
RAYA_KERNEL_BODY hit searched_hit(words job, const ray* r, int shadow) {
    tree t;
    ray_pool pool;
    clear_tree(&t);
    open_pool(&pool);
    put_rays(job, &pool, 0, &t, r->limit > 0.0f, r, shadow);
    find_hits(job, &pool, shadow);
    return take_hit(&pool, 0, &t);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_by_search(__global const uint* restrict job,
                    __global const float* restrict rays,
                    __global uint* restrict objects,    // as above
                    __global uint* restrict distances)
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const hit h = searched_hit(job, &r, 0);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}
#endif
