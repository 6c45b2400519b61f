// Counters of the kernels: numbers of rays, hits, tests and steps. They do not depend on the number of lanes or the
// size of work-groups.
#ifndef RAYA_SHARED_EVENTS_H
#define RAYA_SHARED_EVENTS_H

enum {
    RAYA_PRIMARY,        // primary rays, one per sample point
    RAYA_PRIMARY_HITS,   // primary rays that hit an object
    RAYA_REFLECTED,      // reflected rays, total reflection included
    RAYA_REFRACTED,      // refracted rays
    RAYA_SHADOW,         // shadow rays
    RAYA_SHADOW_HITS,    // shadow rays that hit an object before the light
    RAYA_SPHERE_TESTS,   // tests of a ray against a sphere
    RAYA_PLANE_TESTS,    // tests of a ray against a plane
    RAYA_POLYGON_TESTS,  // tests of a ray against a polygon or patch
    RAYA_CONE_TESTS,     // tests of a ray against a cone or cylinder
    RAYA_SHADED,         // shaded hits of primary, reflected and refracted rays; each adds an ambient term
    RAYA_LIT,            // shadow rays that reach their light; each adds a diffuse term
    RAYA_HIGHLIGHTS,     // highlights of lights that a shadow ray reaches; each takes one num_power()
    RAYA_WALKS,          // rays that entered the grid's box, or that traversed the BVH
    RAYA_STEPS,          // voxels or BVH nodes that rays entered, including the first
    RAYA_DISCARDED,      // primary rays that a torus node made and discarded because other nodes trace them
    RAYA_EVENTS          // number of counters
};

#endif
