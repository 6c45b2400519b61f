// What papers on grids printed; marked [D] where it is arithmetic on printed figures.
#pragma once
#include <cstdint>

#include "host/grid/partition.hpp"

namespace raya::paper {

// Yoshitani & Yamazaki, about 1995, on Fig. 3: 1024 objects on one machine.
inline constexpr std::uint32_t kFewDivisions = 32, kManyDivisions = 1024;
inline constexpr double kFewDivisionsS = 313, kManyDivisionsS = 60;
inline constexpr double kDivisionsFall = kFewDivisionsS / kManyDivisionsS;  // [D] 5.2
inline constexpr double kTestsFall = 5;                                     // tests fall "to about 1/5"

// Havran & Sixta 1999: a uniform grid with 3D-DDA on SPD's scenes, tests and steps a ray.
struct UniformGrid {
    const char* scene;
    Divisions divisions;
    double tests, steps;
};
inline constexpr UniformGrid kHavran[] = {{"balls", {46, 46, 3}, 358.66, 5.69},
                                          {"balls", {103, 103, 7}, 72.54, 12.40},
                                          {"lattice", {20, 20, 20}, 20.67, 5.09},
                                          {"lattice", {44, 44, 44}, 9.26, 10.56}};

}  // namespace raya::paper
