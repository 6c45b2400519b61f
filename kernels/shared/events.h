// Events that the kernels count. Each count is of rays, hits or tests, independent of lanes, groups and mapping.
#ifndef RAYA_SHARED_EVENTS_H
#define RAYA_SHARED_EVENTS_H

enum {
    RAYA_PRIMARY,        // primary rays, one per pixel
    RAYA_PRIMARY_HITS,   // ... that hit an object
    RAYA_REFLECTED,      // reflected rays, total reflection included
    RAYA_REFRACTED,      // refracted rays
    RAYA_SHADOW,         // shadow rays
    RAYA_SHADOW_HITS,    // ... that were stopped
    RAYA_SPHERE_TESTS,   // ray against sphere
    RAYA_PLANE_TESTS,    // ray against plane
    RAYA_POLYGON_TESTS,  // ray against polygon or patch
    RAYA_CONE_TESTS,     // ray against cone or cylinder
    RAYA_SHADED,         // hits of primary, reflected and refracted rays: a normal, a surface, an ambient term
    RAYA_LIT,            // contributions of a light: diffuse term and, where Ks > 0, a highlight
    RAYA_HIGHLIGHTS,     // powers for a highlight
    RAYA_WALKS,          // rays that entered the grid's box, or descended the BVH
    RAYA_STEPS,          // voxels that rays entered, the first one included; nodes of the BVH
    RAYA_DISCARDED,      // primary rays that a torus node made and discarded, as they belong to other nodes
    RAYA_EVENTS          // number of kinds
};

#endif
