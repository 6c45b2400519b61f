// Kernels of kernels/checks/hits.cl, and a test kernel for hits of shadow rays.
#include "kernels/checks/hits.cl"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void shadow_hits_with_accel(__global const uint* restrict job,
                            __global const float* restrict rays,
                            __global uint* restrict objects,    // [ray]: number of an object that the ray hits;
                                                                // RAYA_NO_OBJECT if there is none
                            __global uint* restrict distances)  // [ray]: bits of t of that hit; without a hit, bits of
                                                                // the ray's limit
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const hit h = searched_hit(job, &r, 1);
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}
