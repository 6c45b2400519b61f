// Test kernel that tests each of the given rays (kernels/checks/rows.clh) against one object. Rays 16 i to 16 i + 15
// are tested against objects[i]. The number of rays is a multiple of 16.
#include "kernels/checks/rows.clh"
#include "kernels/geometry/scene.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void single_object_hits(__global const uint* restrict job,
                 __global const float* restrict rays,
                 __global const uint* restrict objects,      // [ray / 16]: number in the job of an object other than a plane
                 __global float* restrict distances) // [ray]: t; without a hit the ray's limit
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const objects_words all = &((job_words)job)->objects;
    const uint object = objects[first / 16];
    const ray_frame f = frame_of(r);
    hit h = {r.limit, (index)(RAYA_NO_OBJECT)};
    if (object < all->spheres)
        h = hit_spheres(h, r, job + all->spheres_at + object * RAYA_SPHERE_WORDS, 1, object);
#define RAYA_HIT_ONE(kind, kinds, KIND)                                                                             \
    if (RAYA_ARE_OF_KIND(all, object, kinds, KIND)) {                                                               \
        const uint i = object - raya_first_object(*all, RAYA_##KIND);                                               \
        h = hit_##kind(h, &r, &f, job, job + all->kinds##_at + i * RAYA_##KIND##_WORDS, object);                    \
    }
    RAYA_SHAPE_LIST(RAYA_HIT_ONE)
    store_lanes(distances + first, 1, h.distance);
}
