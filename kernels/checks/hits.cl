// Kernels that find the nearest hits of given rays. hits_without_accel tests all objects. hits_with_accel uses the ring
// machine's search in the job's grid or BVH; it exists unless RAYA_ACCEL is RAYA_ACCEL_NONE. The host compares the hits
// of the two kernels. The job's words must be in global memory.
#include "kernels/checks/rows.clh"
#include "kernels/shading/search.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_without_accel(__global const uint* restrict job,
                        __global const float* restrict rays,
                        __global uint* restrict objects,    // [ray]: object number; RAYA_NO_OBJECT without a hit
                        __global uint* restrict distances)  // [ray]: bits of t; without a hit, bits of the ray's limit
{
    const uint first = first_ray();
    const hit h = closest_hit(job, &((job_words)job)->objects, load_ray(rays, first), 0);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}

#if RAYA_FILTER
// Stores the bits of the error bounds of the filters (number/reduced.clh).
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void filter_bounds(__global uint* restrict bounds) {
    bounds[0] = as_uint(RAYA_ERROR);
    bounds[1] = as_uint(RAYA_FLUSH);
    bounds[2] = as_uint(RAYA_ROOM);
}
#endif

#if RAYA_ACCEL != RAYA_ACCEL_NONE
// Returns the nearest hits that the search finds; if `shadow` is 1, any hits.
RAYA_KERNEL_BODY hit searched_hit(words job, const ray* r, int shadow) {
    tree t;
    ray_pool pool;
    clear_tree(&t);
    open_pool(&pool);
    return cast_rays(job, &pool, &t, r->limit > 0.0f, r, shadow);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_with_accel(__global const uint* restrict job,
                     __global const float* restrict rays,
                     __global uint* restrict objects,    // `objects`, `distances`: as in hits_without_accel
                     __global uint* restrict distances)
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const hit h = searched_hit(job, &r, 0);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}
#endif
