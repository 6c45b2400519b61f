// Every DescribedKernel agrees with the kernel of its name in the kernel file.
#include <catch2/catch.hpp>
#include <sstream>
#include <type_traits>

#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/node_array.hpp"
#include "host/torus/torus_renderer.hpp"

namespace raya {
namespace {

template <class T>
struct ParameterName {
    static constexpr const char* kText = "";
};
template <FixedText Name>
struct ParameterName<Uint<Name>> {
    static constexpr const char* kText = Name.text;
};

// Returns the names of the parameters in the kernel's file.
std::vector<std::string> parameter_names(const std::string& file, const std::string& kernel) {
    std::string text = kernel_file(file);
    const std::string start = "void " + kernel + "(";
    text = text.substr(text.find(start) + start.size());
    std::istringstream lines(text.substr(0, text.find("\n{")));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        const std::string code = line.substr(0, line.find("//"));
        const std::size_t end = code.find_last_of(",)");
        if (end == code.npos) continue;
        const std::size_t blank = code.find_last_of(" *", end - 1);
        names.push_back(code.substr(blank + 1, end - blank - 1));
    }
    return names;
}

// Checks the names and the number of a kernel's parameters; returns the number of described names.
template <FixedText File, FixedText Name, class... Params>
int check_names(const std::type_identity<DescribedKernel<File, Name, Params...>>&) {
    const std::vector<std::string> names = parameter_names(File.text, Name.text);
    CAPTURE(Name.text, names);
    REQUIRE(names.size() == sizeof...(Params));
    int described = 0;
    std::size_t parameter = 0;
    const auto check = [&](const std::string& name) {
        CHECK((name.empty() || names[parameter] == name));
        described += !name.empty();
        ++parameter;
    };
    (check(ParameterName<Params>::kText), ...);
    return described;
}

}  // namespace

TEST_CASE("parameters have the same names in kernels and in their descriptions", "[kernels]") {
    const auto described = []<class... K>(std::type_identity<K>... kernels) { return (check_names(kernels) + ...); };
    CHECK(described(std::type_identity<TraceKernel>{}, std::type_identity<AddNeighboursKernel>{},
                    std::type_identity<TakeMeansKernel>{}, std::type_identity<MarkContrastsKernel>{},
                    std::type_identity<ComposeKernel>{}, std::type_identity<node_kernels::Inject>{},
                    std::type_identity<node_kernels::TraceVoxel>{}, std::type_identity<node_kernels::Route>{},
                    std::type_identity<node_kernels::Accept>{}, std::type_identity<ExchangeKernel>{}) == 41);
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

TEST_CASE("kernels of the torus have no restrict parameter to which they write", "[kernels]") {
    // Compilers may repeat a read after a barrier (docs/porting.md).
    for (const char* const name : {"inject", "trace_voxel", "route", "accept"}) {
        std::istringstream lines(kernel_file("torus/" + std::string(name) + ".cl"));
        for (std::string line; std::getline(lines, line);) {
            CAPTURE(name, line);
            CHECK((line.find(" restrict ") == line.npos || line.find("__global const ") != line.npos));
        }
    }
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
