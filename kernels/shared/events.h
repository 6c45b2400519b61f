// Counters of the kernels: numbers of rays, hits, tests and steps. They do not depend on the number of lanes or the
// size of work-groups.
#ifndef RAYA_SHARED_EVENTS_H
#define RAYA_SHARED_EVENTS_H

// EVENT(ENUMERATOR, name, member) for each count, in the order of the enumerators. `name`: in Python and in messages;
// `member`: of reports, "" if another member has it.
#define RAYA_EVENT_LIST(EVENT)                                                                                     \
    EVENT(RAYA_PRIMARY, "primary", "rays.primary")                /* primary rays, one per sample point */         \
    EVENT(RAYA_PRIMARY_HITS, "primary_hits", "rays.primary_hits") /* primary rays that hit an object */            \
    EVENT(RAYA_REFLECTED, "reflected", "rays.reflected")          /* reflected rays, total reflection included */  \
    EVENT(RAYA_REFRACTED, "refracted", "rays.refracted")          /* refracted rays */                             \
    EVENT(RAYA_SHADOW, "shadow", "rays.shadow")                   /* shadow rays */                                \
    EVENT(RAYA_SHADOW_HITS, "shadow_hits", "rays.shadow_hits")    /* those that hit an object before the light */  \
    EVENT(RAYA_SPHERE_TESTS, "sphere_tests", "tests.sphere")      /* tests of a ray against a sphere */            \
    EVENT(RAYA_PLANE_TESTS, "plane_tests", "tests.plane")         /* against a plane */                            \
    EVENT(RAYA_POLYGON_TESTS, "polygon_tests", "tests.polygon")   /* against a polygon or patch */                 \
    EVENT(RAYA_CONE_TESTS, "cone_tests", "tests.cone")            /* against a cone or cylinder */                 \
    EVENT(RAYA_SHADED, "shaded", "shading.hits")                  /* shaded hits of rays other than shadow rays */ \
    EVENT(RAYA_LIT, "lit", "shading.lit") /* shadow rays that reach their light: a diffuse term */                 \
    EVENT(RAYA_HIGHLIGHTS, "highlights", "shading.highlights") /* highlights; each takes one num_power() */        \
    EVENT(RAYA_WALKS, "walks", "walks")    /* rays that entered the grid's box or traversed the BVH */             \
    EVENT(RAYA_STEPS, "steps", "steps")    /* voxels or BVH nodes that rays entered */                             \
    EVENT(RAYA_DISCARDED, "discarded", "") /* primary rays that a torus node made for another one */               \
    EVENT(RAYA_RESUMED, "resumed", "")     /* rays that a PE took up to test a part of the objects */

#define RAYA_EVENT_ENUMERATOR(enumerator, name, member) enumerator,
enum {
    RAYA_EVENT_LIST(RAYA_EVENT_ENUMERATOR) RAYA_EVENTS  // number of counters
};

#endif
