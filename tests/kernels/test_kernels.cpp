// The one door to kernels: every description agrees with its kernel's file, and a file is built once.
#include <catch2/catch.hpp>

#include "host/cl/kernels.hpp"
#include "host/error.hpp"
#include "host/ring/smoothing.hpp"
#include "host/ring/tracer.hpp"
#include "host/torus/composer.hpp"
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

// How many parameters are named; each has that name in the kernel's file, or the driver keeps no names. PoCL 3.1 says
// _cl_distance for `distance`, as a built-in function has that name.
template <class... Params>
int named_parameters(const Kernel<Params...>& kernel) {
    cl_uint index = 0;
    int named = 0;
    const auto check = [&](const std::string& expected) {
        const std::string name = argument_name(kernel.handle(), index);
        if (!expected.empty() && name != std::to_string(index)) {
            CHECK_THAT(name, Catch::EndsWith(expected));
            ++named;
        }
        ++index;
    };
    (check(ParameterName<Params>::kText), ...);
    return named;
}

}  // namespace

TEST_CASE("numbers have the names in the kernels that their descriptions give them", "[kernels]") {
    Session session(choose_device(""));
    StepLog log;
    session.observe(log, 1);  // names of parameters are kept
    Kernels kernels(session, {});
    int named = 0;
    const auto check = [&]<class... K>(std::type_identity<K>...) {
        ((named += named_parameters(kernels.get<K>())), ...);
    };
    check(std::type_identity<TraceKernel>{}, std::type_identity<AddNeighboursKernel>{},
          std::type_identity<TakeMeansKernel>{}, std::type_identity<MarkContrastsKernel>{},
          std::type_identity<ComposeKernel>{}, std::type_identity<node_kernels::Inject>{},
          std::type_identity<node_kernels::TraceVoxel>{}, std::type_identity<node_kernels::Route>{},
          std::type_identity<node_kernels::Accept>{}, std::type_identity<ExchangeKernel>{});
    WARN(named << " of 41 names are known to the driver");
    CHECK((named == 0 || named == 41));
    CHECK(log.steps().size() == 9);  // of the filter's two kernels, one program
}

TEST_CASE("a kernel with other parameters, another name or another file is refused", "[kernels]") {
    Session session(choose_device(""));
    Kernels kernels(session, {});
    using Few = DescribedKernel<"torus/compose.cl", "compose", Buffer<float>&>;
    using Other = DescribedKernel<"torus/compose.cl", "decompose", Buffer<float>&>;
    using Nowhere = DescribedKernel<"torus/decompose.cl", "compose", Buffer<float>&>;
    CHECK_THROWS_AS(kernels.get<Few>(), DeviceError);
    CHECK_THROWS_WITH(kernels.get<Other>(), Catch::Contains("decompose") && Catch::Contains("torus/compose.cl"));
    CHECK_THROWS_AS(kernels.get<Nowhere>(), UserError);
}

TEST_CASE("sources and more options reach every build", "[kernels]") {
    Session session(choose_device(""));
    const KernelSources sources{.patches = {{"torus/compose.cl", "void compose(", "void RAYA_NAME("}},
                                .more_options = {"-DRAYA_NAME=decompose"}};
    Kernels kernels(session, {.group_size = 4}, sources);
    using Renamed = DescribedKernel<"torus/compose.cl", "decompose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                    Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;
    CHECK_NOTHROW(kernels.get<Renamed>());
    CHECK_THAT(kernels.program(Renamed::kFile).options(),
               Catch::Contains("-DRAYA_GROUP=4") && Catch::Contains("-DRAYA_NAME=decompose"));
    const Program own = kernels.build("own.cl", "#include \"kernels/torus/compose.cl\"\n");
    CHECK_NOTHROW(
        own.kernel<const Buffer<float>&, const Buffer<std::uint32_t>&, cl_uint, Buffer<float>&, Buffer<std::uint32_t>&>(
            "decompose"));
    CHECK_THROWS_AS(Kernels(session, {.lanes = 3}), UserError);
}

}  // namespace raya
