// Test kernels that apply the geometry and shading headers to given rays (kernels/checks/rows.clh). The file also has
// the kernels of hits.cl.
#include "kernels/checks/hits.cl"
#include "kernels/shading/shade.clh"

static inline void store_ray(__global float* to, uint stride, const tree_ray* r) {
    store_vec(to, stride, vec_of_lanes(r->origin));
    store_vec(to + 3, stride, vec_of_lanes(r->direction));
    store_lanes(to + 6, stride, r->weight.all);
}

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
    const hit_place p = find_place(job, all, struck, h, r.origin, r.direction);
    store_index(leaving + first, 1, choose_index(p.leaving, (index)(1), (index)(0)));
    __global float* to = places + first * 18;
    store_vec(to, 18, p.point);
    store_vec(to + 3, 18, p.outer);
    store_vec(to + 6, 18, p.inner);
    store_vec(to + 9, 18, p.geometric);
    store_vec(to + 12, 18, p.normal);
    store_vec(to + 15, 18, surface_colour(job, struck, &p));
}

// Does one step of a ray tree: traces and shades the given rays, as rays of level `level` and weight 1/2.
__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void shade_tree_step(__global const uint* restrict job,    // the job's words (kernels/shared/job.h)
                     __global const float* restrict rays,  // [ray][7]: origin, direction, limit
                     const uint level,
                     __global uint* restrict state,     // [ray][3 + RAYA_EVENTS]: active (0 or 1), level, mask
                                                        // of the levels with a pending ray, event counts
                     __global float* restrict numbers)  // [ray][17]: sum, current ray, pending ray made at `level`
{
    const uint first = first_ray();
    const ray r = load_ray(rays, first);
    tree t;
    clear_tree(&t);
    t.ray.origin = lanes_of_vec(r.origin);
    t.ray.direction = lanes_of_vec(r.direction);
    t.ray.weight.all = num_const(0.5f);
    t.active = mask_all(1);
    t.level = (index)(level);
    for (uint i = 0; i < RAYA_PENDING; ++i) t.pending[i] = t.ray;
    ray_pool pool;
    open_pool(&pool);
    follow_trees(job, &t, &pool);

    const uint words = 3 + RAYA_EVENTS;
    __global uint* to = state + first * words;
    store_index(to, words, choose_index(t.active, (index)(1), (index)(0)));
    store_index(to + 1, words, t.level);
    store_index(to + 2, words, t.pending_levels.all);
    for (uint e = 0; e < RAYA_EVENTS; ++e) store_index(to + 3 + e, words, t.events[e].all);
    store_vec(numbers + first * 17, 17, t.sum);
    store_ray(numbers + first * 17 + 3, 17, &t.ray);
    store_ray(numbers + first * 17 + 10, 17, &t.pending[min(level, (uint)(RAYA_PENDING - 1))]);
}
