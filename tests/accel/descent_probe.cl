// Test kernel for hits of shadow rays. It adds to the kernels of kernels/checks/hits.cl.
#include "kernels/checks/hits.cl"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void stops_by_search(__global const uint* restrict job,
                     __global const float* restrict rays,
                     __global uint* restrict objects,    // [ray]: number of any object hit, or RAYA_NO_OBJECT
                     __global uint* restrict distances)  // [ray]: bits of t
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const hit h = searched_hit(job, &r, 1);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}
