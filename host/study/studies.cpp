#include "host/study/studies.hpp"

namespace raya {

std::span<const Study> studies() {
    static const Study all[] = {
        {"fig7", "Load of each PE, column split and cyclic mapping", true, study_fig7},
        {"fig8", "Imbalance against the offset p", true, study_fig8},
        {"fig9", "Speed-up against the number of PEs, both folds, and the mappings of CAP and Pixel Machine", true,
         study_fig9},
        {"table2", "Times of the SPA with 256 PEs and with one, and of this machine", true, study_table2},
        {"table3", "What the 3 x 3 filter costs", true, study_table3},
        {"table4", "What supersampling costs, in both readings of the paper", true, study_table4},
        {"bus", "What neighbours cost over the ring, over the bus and by broadcasts of PEs, 4 to 256 PEs", true,
         study_bus},
        {"cluster", "Scenes as heavy as the paper's: its times on one clock, nothing fitted", false, study_cluster},
        {"fig12", "Load of each PE in supersampling", true, study_fig12},
        {"fig13", "Imbalance against the offset p in supersampling", true, study_fig13},
        {"images", "Efficiency of column split and cyclic mapping over ten scenes, two sizes", false, study_images},
        {"lattice", "Are offsets beyond the square root of P worse?", false, study_lattice},
        {"scale", "16 to 1,048,576 PEs, up to one for each pixel", true, study_scale},
        {"static-vs-dynamic", "Static mappings against dynamic and hybrid distribution", false,
         study_static_vs_dynamic},
        {"best-offset", "The best offset for your scene, communication in the balance", false, study_best_offset},
        {"turn", "Balance over a turn of the camera: u of every frame, and whether one offset holds", false,
         study_turn},
        {"divisions", "Time of one machine against the number of voxels, 64 to 1024 even spheres", false,
         study_divisions},
        {"havran", "Intersection tests and steps a ray in uniform grids, balls and lattice", false, study_havran},
        {"accel", "Time, tests and memory of none, grid and bvh, 10 to 600,000 objects, beside Embree", false,
         study_accel},
        {"objects", "Torus: time against the number of objects, even and random", true, study_objects},
        {"nodes", "Torus: 1 to 4096 nodes, speed-up, balance, hops, 2-D against 3-D", false, study_nodes},
        {"inject", "Torus: the root makes all primary rays, or all nodes do", true, study_inject},
        {"hybrid", "Torus: groups of nodes share the screen, each divides space", false, study_hybrid},
        {"simgrid", "Torus without supersteps: raya's simulator beside SimGrid", true, study_simgrid, lack_of_simgrid},
        {"ranks", "1 to 65,536 MPI ranks, ring and torus: where communication takes half, beside what is measured here",
         true, study_ranks, lack_of_ranks},
    };
    return all;
}

}  // namespace raya
