// Every DescribedKernel agrees with the kernel of its name in the kernel file, and each file is built once.
#include <catch2/catch.hpp>

#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/node_array.hpp"

namespace raya {
namespace {

template <class T>
struct ParameterName {
    static constexpr const char* kText = "";
};
template <FixedText Name>
struct ParameterName<Uint<Name>> {
    static constexpr const char* kText = Uint<Name>::kName;
};

// Returns false if the driver reports that it does not store parameter names.
bool has_parameter_name(const cl::Kernel& kernel, cl_uint index) {
    std::size_t size = 0;
    return clGetKernelArgInfo(kernel(), index, CL_KERNEL_ARG_NAME, 0, nullptr, &size) !=
           CL_KERNEL_ARG_INFO_NOT_AVAILABLE;
}

struct NamedParameters {
    int described = 0;  // number of parameters that have a name in a description
    int reported = 0;   // number of these parameters whose names the driver reports
};

// Checks that the parameters have the same names in the kernel file, if the driver stores names. PoCL 3.1 reports
// `distance` as _cl_distance, because a built-in function is called distance.
template <class... Params>
void check_parameter_names(const Kernel<Params...>& kernel, NamedParameters& counts) {
    cl_uint index = 0;
    const auto check = [&](const std::string& expected) {
        if (!expected.empty()) {
            ++counts.described;
            if (has_parameter_name(kernel.handle(), index)) {
                ++counts.reported;
                CHECK_THAT(argument_name(kernel.handle(), index), Catch::EndsWith(expected));
            }
        }
        ++index;
    };
    (check(ParameterName<Params>::kText), ...);
}

}  // namespace

TEST_CASE("parameters have the same names in kernels and in their descriptions", "[kernels]") {
    Session session(choose_device(""));
    SpanLog log;
    session.observe(log, 1);  // builds with -cl-kernel-arg-info
    Kernels kernels(session, {});
    NamedParameters counts;
    const auto check = [&]<class... K>(std::type_identity<K>...) {
        (check_parameter_names(kernels.get<K>(), counts), ...);
    };
    check(std::type_identity<TraceKernel>{}, std::type_identity<AddNeighboursKernel>{},
          std::type_identity<TakeMeansKernel>{}, std::type_identity<MarkContrastsKernel>{},
          std::type_identity<ComposeKernel>{}, std::type_identity<node_kernels::Inject>{},
          std::type_identity<node_kernels::TraceVoxel>{}, std::type_identity<node_kernels::Route>{},
          std::type_identity<node_kernels::Accept>{}, std::type_identity<ExchangeKernel>{});
    CHECK(counts.described == 41);
    CHECK((counts.reported == 0 || counts.reported == counts.described));
    CHECK(log.spans().size() == 9);  // one program for each file; the filter's two kernels share one
}

TEST_CASE("a kernel with other parameters, another name or another file is refused", "[kernels]") {
    Session session(choose_device(""));
    Kernels kernels(session, {});
    using TooFewParameters = DescribedKernel<"torus/compose.cl", "compose", Buffer<float>&>;
    using OtherName = DescribedKernel<"torus/compose.cl", "decompose", Buffer<float>&>;
    using OtherFile = DescribedKernel<"torus/decompose.cl", "compose", Buffer<float>&>;
    CHECK_THROWS_AS(kernels.get<TooFewParameters>(), DeviceError);
    CHECK_THROWS_WITH(kernels.get<OtherName>(), Catch::Contains("decompose") && Catch::Contains("torus/compose.cl"));
    CHECK_THROWS_AS(kernels.get<OtherFile>(), UserError);
}

TEST_CASE("source patches and additional options reach every build", "[kernels]") {
    Session session(choose_device(""));
    const KernelSources sources{.patches = {{"torus/compose.cl", "void compose(", "void RAYA_NAME("}},
                                .more_options = {"-DRAYA_NAME=decompose"}};
    Kernels kernels(session, {.group_size = 4}, sources);
    using Renamed = DescribedKernel<"torus/compose.cl", "decompose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                    Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;
    CHECK_NOTHROW(kernels.get<Renamed>());
    CHECK_THAT(kernels.program(Renamed::kFile).options(),
               Catch::Contains("-DRAYA_GROUP=4") && Catch::Contains("-DRAYA_NAME=decompose"));
    const Program including_program = kernels.build("including.cl", "#include \"kernels/torus/compose.cl\"\n");
    CHECK_NOTHROW(including_program.kernel<const Buffer<float>&, const Buffer<std::uint32_t>&, cl_uint, Buffer<float>&,
                                           Buffer<std::uint32_t>&>("decompose"));
    CHECK_THROWS_AS(Kernels(session, {.lanes = 3}), UserError);
}

}  // namespace raya
