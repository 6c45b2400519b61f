// What the kernels count, one number each. Every count is per ray, hit or test, whatever lanes, groups and mapping are.
#ifndef RAYA_SHARED_EVENTS_H
#define RAYA_SHARED_EVENTS_H

enum {
    RAYA_PRIMARY,        // primary rays, one a pixel
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
    RAYA_WALKS,          // rays that met the box of the voxels, or went down the tree of boxes
    RAYA_STEPS,          // voxels that rays entered, the first one among them; nodes of the tree
    RAYA_DISCARDED,      // primary rays that a node of the torus made and threw away, as they are other nodes'
    RAYA_EVENTS          // how many kinds there are
};

#endif
