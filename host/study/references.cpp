#include "host/study/references.hpp"

namespace raya {

std::span<const Reference> references() {
    static const Reference all[] = {
        {"Abramowitz & Stegun",
         "Milton Abramowitz, Irene A. Stegun (eds.): Handbook of Mathematical Functions. National Bureau of Standards, "
         "Applied Mathematics Series 55, 1964."},
        {"Amanatides & Woo",
         "John Amanatides, Andrew Woo: A Fast Voxel Traversal Algorithm for Ray Tracing. Eurographics '87, pp. 3-10, "
         "1987."},
        {"Embree",
         "Ingo Wald, Sven Woop, Carsten Benthin, Gregory S. Johnson, Manfred Ernst: Embree: A Kernel Framework for "
         "Efficient CPU Ray Tracing. ACM Transactions on Graphics 33 (4), 2014."},
        {"Fujimoto",
         "Akira Fujimoto, Takayuki Tanaka, Kansei Iwata: ARTS: Accelerated Ray-Tracing System. IEEE Computer Graphics "
         "and Applications 6 (4), pp. 16-26, 1986."},
        {"SPD",
         "Eric Haines: A Proposal for Standard Graphics Environments. IEEE Computer Graphics and Applications 7 (11), "
         "pp. 3-5, 1987. (The Standard Procedural Databases, SPD.)"},
        {"Havran & Sixta",
         "Vlastimil Havran, Filip Sixta: Comparison of Hierarchical Grids. Ray Tracing News 12 (1), 1999."},
        {"Heirich",
         "Alan Heirich, James Arvo: A Competitive Analysis of Load Balancing Strategies for Parallel Ray Tracing. The "
         "Journal of Supercomputing 12, pp. 57-68, 1998."},
        {"IMS T805", "SGS-Thomson Microelectronics: IMS T805, 32-bit floating-point transputer. Data sheet, 1996."},
        {"Kohata & Ito",
         "Kohata, Ito: ray tracing on the SPA, an array of 256 digital signal processors on a ring and a bus. IPSJ "
         "Journal (Information Processing Society of Japan), 1993, in Japanese."},
        {"Pixel Machine",
         "Michael Potmesil, Eric M. Hoffert: The Pixel Machine: A Parallel Image Computer. Computer Graphics 23 (3) "
         "(SIGGRAPH '89), pp. 69-78, 1989."},
        {"SimGrid",
         "Henri Casanova, Arnaud Giersch, Arnaud Legrand, Martin Quinson, Frédéric Suter: Versatile, Scalable, and "
         "Accurate Simulation of Distributed Applications and Platforms. Journal of Parallel and Distributed Computing "
         "74 (10), pp. 2899-2917, 2014."},
        {"Yoshitani & Yamazaki",
         "Yoshitani, Yamazaki: ray tracing by division of space on 64 transputers connected as a torus. About 1995; "
         "where it appeared is not known to us."},
    };
    return all;
}

}  // namespace raya
