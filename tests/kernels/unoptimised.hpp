// Builds without optimisation that tests leave out because of a known defect of a compiler.
#pragma once
#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "tests/paths.h"

namespace raya {

/// Returns false for builds with 16 lanes and -cl-opt-disable on a device with the defect that the kernel
/// tests/portability/wide_vector.cl shows (docs/defects.md: PoCL 7.1 on CPUs with AVX-512).
inline bool tests_unoptimised(std::uint32_t lanes) {
    constexpr std::uint32_t kWidest = 16;
    if (lanes < kWidest) return true;
    static const bool right = [] {
        Session session(choose_device(""));
        std::ifstream file(RAYA_SOURCE_DIR "/tests/portability/wide_vector.cl");
        const Program program = session.build("wide_vector.cl", {std::istreambuf_iterator<char>(file), {}},
                                              {"-cl-std=CL1.2", "-cl-opt-disable"});
        auto kernel = program.kernel<Buffer<cl_uint>&, cl_uint>("defect");
        Buffer<cl_uint> out = session.buffer<cl_uint>("out", 1);
        std::vector<cl_uint> result(1);
        session.launch("defect", kernel, 1, 1, out, cl_uint{20});
        session.read("read", out, result);
        if (result[0] != 40) WARN("no builds with 16 lanes and -cl-opt-disable: wide_vector.cl gives " << result[0]);
        return result[0] == 40;
    }();
    return right;
}

}  // namespace raya
