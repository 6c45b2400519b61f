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
    const uint first_polygon = all->spheres + all->planes, first_cone = first_polygon + all->polygons;
    hit h = {r.limit, (index)(RAYA_NO_OBJECT)};
    if (object < all->spheres)
        h = hit_spheres(h, r, job + all->spheres_at + object * RAYA_SPHERE_WORDS, 1, object);
    else if (object >= first_cone)
        h = hit_cones(h, r, job + all->cones_at + (object - first_cone) * RAYA_CONE_WORDS, 1, object, 0);
    else
        h = hit_polygons(h, r, job, job + all->polygons_at + (object - first_polygon) * RAYA_POLYGON_WORDS, 1, object,
                         0);
    store_lanes(distances + first, 1, h.distance);
}
