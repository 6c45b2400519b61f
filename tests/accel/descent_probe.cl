// Hits of given rays (kernels/checks/rays.clh) by testing all objects, and down the tree of boxes behind the job's words.
#include "kernels/checks/rays.clh"
#include "kernels/shading/search.clh"

static inline void store_hits(__global uint* objects, __global uint* distances, uint first, hit h) {
    store_index(objects + first, 1, h.object);
    store_bits(distances + first, 1, h.distance);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_of_all(__global const uint* restrict job,
                 __global const float* restrict rays,
                 __global uint* restrict objects,    // [ray]: number, RAYA_NO_OBJECT
                 __global uint* restrict distances)  // [ray]: bits; the limit where nothing is hit
{
    const uint first = first_ray();
    store_hits(objects, distances, first, closest_hit(job, &((job_words)job)->objects, load_ray(rays, first)));
}

static inline hit hits_down(words job, const ray* r, int shadow) {
    tree t;
    ray_pool pool;
    clear_tree(&t);
    open_pool(&pool);
    put_rays(job, &pool, 0, &t, r->limit > 0.0f, r, shadow);
    find_hits(job, &pool, shadow);
    return take_hit(&pool, 0, &t);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void hits_by_tree(__global const uint* restrict job,
                  __global const float* restrict rays,
                  __global uint* restrict objects,    // as above
                  __global uint* restrict distances)
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    store_hits(objects, distances, first, hits_down(job, &r, 0));
}

// Any hit will do.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void stops_by_tree(__global const uint* restrict job,
                   __global const float* restrict rays,
                   __global uint* restrict objects,    // as above, of some hit
                   __global uint* restrict distances)
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    store_hits(objects, distances, first, hits_down(job, &r, 1));
}
