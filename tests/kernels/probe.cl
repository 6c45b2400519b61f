// A test kernel that applies the shading headers to given rays (kernels/checks/rows.clh). The file also has the kernels
// of hits.cl.
#include "kernels/checks/hits.cl"
#include "kernels/shading/shade.clh"

// Finds the nearest hit of each ray, and its points, normals and colour (find_place() of shading/surface.clh).
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void find_places(__global const uint* restrict job,    // the job's words (kernels/shared/job.h)
                 __global const float* restrict rays,  // [ray][7]: origin, direction, limit
                 __global uint* restrict leaving,  // [ray]: 1 if the ray leaves the object, else 0
                 __global float* restrict places)  // [ray][6][3]: P, P+, P-, G, N, colour; undefined for a miss
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    const objects_words all = &((job_words)job)->objects;
    const hit h = closest_hit(job, all, r, 0);
    const mask struck = h.object != RAYA_NO_OBJECT;
    const hit_place p = find_place((job_words)job, job, all, struck, h, r.origin, r.direction);
    store_index(leaving + first, 1, choose_index(p.leaving, (index)(1), (index)(0)));
    __global float* to = places + first * 18;
    store_vec(to, 18, p.point);
    store_vec(to + 3, 18, p.outer);
    store_vec(to + 6, 18, p.inner);
    store_vec(to + 9, 18, p.geometric);
    store_vec(to + 12, 18, p.normal);
    store_vec(to + 15, 18, surface_colour(job, struck, &p));
}
