// What papers printed, each figure with its place; marked [D] where it is arithmetic on printed figures.
#pragma once
#include <cstdint>
#include <optional>

#include "host/accel/partition.hpp"

namespace raya::paper {

// Whom a claim is of, as pages name them.
inline constexpr const char *kSpa = "Kohata & Ito 1993", *kTp = "Yoshitani & Yamazaki, about 1995",
                            *kGrid = "Havran & Sixta 1999", *kDynamic = "Heirich & Arvo 1998";

// Kohata & Ito 1993, up to the rotation.
inline constexpr double kPes = 256, kSize = 256;

// Table 2: milliseconds of the scene of Fig. 6 on the SPA of 256 PEs and of one.
inline constexpr double kObjectsMs = 2, kComputeMs = 283, kImageMs = 140, kDisplayMs = 1130, kTotalMs = 1555;
inline constexpr double kOnePeComputeMs = 64'800, kOnePeTotalMs = 66'072;
inline constexpr double kPcMs = 295'910, kWorkstationMs = 28'800;  // computing only

// Table 3: ray tracing and filtering, p = 0 and p = 16.
inline constexpr double kTrace0Ms = 653, kTrace16Ms = 283, kFilter0Ms = 9, kFilter16Ms = 19;
inline constexpr double kFiltered0Ms = kTrace0Ms + kFilter0Ms, kFiltered16Ms = kTrace16Ms + kFilter16Ms;

// Table 4: supersampling, communication and computation, p = 0 and p = 16.
inline constexpr double kExchange0Ms = 2, kExchange16Ms = 12, kSupersample0Ms = 739, kSupersample16Ms = 407;

// [D] Table 3: what a rotation takes, and that filtering's arithmetic takes the same for every p, give p = 8.
inline constexpr double kFilterArithmeticMs = 7, kFilter8Ms = 14, kExchange8Ms = 7;
// [D] Table 4, if its computation is the supersampling alone: pixels recomputed, and what they take on the mean PE.
inline constexpr double kRecomputedLeast = 0.16, kRecomputedMost = 0.18, kMeanSupersampleMs = 364;

// [D] from Tables 2 and 3, with the digits that the rounding of 653, 283 and 64,800 ms leaves them.
inline constexpr double kSpeedup16 = 229;                  // stands in the abstracts
inline constexpr double kMeanMs = kOnePeComputeMs / kPes;  // mean load, 253.1
inline constexpr double kSpeedup0 = 99.2;
inline constexpr double kImbalance0 = 1.58;    // u(0); Figs 7 and 8 print no u
inline constexpr double kImbalance16 = 0.118;  // u(16)
inline constexpr double kImbalance16Least = 0.115, kImbalance16Most = 0.121;
inline constexpr const char* kImbalance16Rounding = "the paper's: 0.115 .. 0.121 by the rounding of its times";
inline constexpr double kEfficiency0 = 0.388;
inline constexpr double kEfficiency16 = 0.895;
inline constexpr double kCapRatio = 3.86;           // beside Fig. 9: CAP, 256 PEs over 64
inline constexpr double kPixelMachineSpeedup = 60;  // beside Fig. 9: 64 nodes, "60 or more"
inline constexpr double kExchangeSetupMs = 1.375;   // [D] Table 4: 2 - 2 x 0.3125 = 12 - 34 x 0.3125
inline constexpr double kRotationMs = 0.3125;       // [D] Tables 3 and 4: 10 ms for 32 rotations

// [D] Yoshitani & Yamazaki, about 1995, Table 1: scalars of a ray packet, beside data for the search and of the object.
inline constexpr std::uint32_t kRayWords = 22;

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

namespace raya {

/// Whether a study is made as the paper made it: of the scene of its kind, under the name that it has within the
/// program, and at its size. Beside any other the paper's figures would stand for nothing.
inline bool as_in_paper(const std::string& scene, std::uint32_t size) {
    return scene == "centre" && size == static_cast<std::uint32_t>(paper::kSize);
}

/// What the paper printed, where the study is made as the paper made it.
inline std::optional<double> printed(std::optional<double> value, const std::string& scene, std::uint32_t size) {
    return as_in_paper(scene, size) ? value : std::nullopt;
}

}  // namespace raya
