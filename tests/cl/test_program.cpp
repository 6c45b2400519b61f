// Programs and typed kernels. Without an OpenCL device these tests fail.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/error.hpp"

using namespace raya;
using Catch::Contains;

namespace {

const std::string kProgramSource = R"(
kernel void scale(global const float* restrict from, const float factor, global float* restrict to) {
    to[get_global_id(0)] = factor * from[get_global_id(0)] + RAYA_SHIFT;
}
kernel void reverse_group(global int* words, local int* scratch) {
    const size_t i = get_local_id(0), n = get_local_size(0);
    scratch[i] = words[get_global_id(0)];
    barrier(CLK_LOCAL_MEM_FENCE);
    words[get_global_id(0)] = scratch[n - 1 - i];
}
)";

Program build_test_program(const Session& session) {
    return session.build("test", kProgramSource, {"-DRAYA_SHIFT=0.5f"});
}

}  // namespace

TEST_CASE("a kernel receives buffers and values", "[cl]") {
    Session session(choose_device(""));
    const Program program = build_test_program(session);
    auto scale = program.kernel<const Buffer<float>&, cl_float, Buffer<float>&>("scale");
    std::vector<float> numbers(96);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = float(i) - 40.0F;
    Buffer<float> input = session.buffer<float>("input", numbers.size());
    Buffer<float> output = session.buffer<float>("output", numbers.size());
    session.write("numbers", input, numbers);
    session.launch("scale", scale, 12, 8, input, 3.0F, output);
    std::vector<float> result(numbers.size());
    session.read("result", output, result);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        CAPTURE(i);
        CHECK(result[i] == 3.0F * numbers[i] + 0.5F);  // exact: small multiples of one half
    }
    CHECK(program.options() == "-DRAYA_SHIFT=0.5f");
    CHECK(program.name() == "test");
}

TEST_CASE("a kernel receives local memory, sized in elements", "[cl]") {
    Session session(choose_device(""));
    auto reverse = build_test_program(session).kernel<Buffer<cl_int>&, LocalMemory<cl_int>>("reverse_group");
    Buffer<cl_int> words = session.buffer<cl_int>("words", 8);
    session.write("words", words, std::vector<cl_int>{1, 2, 3, 4, 5, 6, 7, 8});
    session.launch("reverse", reverse, 2, 4, words, LocalMemory<cl_int>{4});
    std::vector<cl_int> result(8);
    session.read("words", words, result);
    CHECK(result == std::vector<cl_int>{4, 3, 2, 1, 8, 7, 6, 5});

    const std::size_t too_many = session.device().local_memory_bytes / sizeof(cl_int) + 1;
    CHECK_THROWS_WITH(session.launch("reverse", reverse, 2, 4, words, LocalMemory<cl_int>{too_many}),
                      Contains("'reverse'") && Contains("reverse_group") &&
                          Contains(std::to_string(too_many * sizeof(cl_int))) &&
                          Contains(std::to_string(session.device().local_memory_bytes)));
}

TEST_CASE("errors of kernels and arguments name the kernel", "[cl]") {
    Session session(choose_device(""));
    const Program program = build_test_program(session);
    CHECK_THROWS_WITH((program.kernel<const Buffer<float>&, Buffer<float>&>("scale")),
                      Contains("'scale'") && Contains("has 3 parameters") && Contains("passes 2"));
    CHECK_THROWS_AS((program.kernel<cl_int>("scale")), DeviceError);
    CHECK_THROWS_WITH(program.kernel<cl_int>("scael"),
                      Contains("'scael'") && Contains("'test'") && Contains("reverse_group"));
    CHECK_THROWS_AS(program.kernel<cl_int>("scael"), DeviceError);
    auto wrong = program.kernel<const Buffer<float>&, cl_double2, Buffer<float>&>("scale");
    Buffer<float> data = session.buffer<float>("data", 8);
    CHECK_THROWS_WITH(session.launch("scale", wrong, 1, 8, data, cl_double2{}, data),
                      Contains("argument 1") && Contains("'scale'") && Contains("CL_INVALID_ARG_SIZE"));
}

TEST_CASE("the error of a failed build contains log, options, device and program", "[cl]") {
    const Session session(choose_device(""));
    std::string text;
    try {
        session.build("broken", "kernel void f(global int* a) { a[0] = undeclared_name; }",
                      {"-DRAYA_A=1", "-DRAYA_B=2"});
    } catch (const DeviceError& error) {
        text = error.what();
    }
    CHECK_THAT(text, Contains("'broken'") && Contains("clBuildProgram") && Contains("CL_BUILD_PROGRAM_FAILURE"));
    CHECK_THAT(text, Contains("undeclared_name"));  // only the build log contains this name
    CHECK_THAT(text, Contains("-DRAYA_A=1 -DRAYA_B=2"));
    CHECK_THAT(text, Contains(session.device().platform) && Contains(session.device().name));
}

/// Returns the number of programs in PoCL's cache. The cache folder belongs to this test program
/// (tests/tools/own_cache.sh).
long cached_programs() {
    long cached = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(std::getenv("POCL_CACHE_DIR")))
        cached += entry.path().filename() == "program.bc";
    return cached;
}

// The kernel cache stays between runs. It must not hide that a kernel no longer builds.
TEST_CASE("a failed build is not cached, and fails again", "[cl]") {
    const auto build = [](const std::string& value) {
        const Session session(choose_device(""));
        session.build("test", "kernel void f(global long* a) { a[0] = " + value + "; }", {});
    };
    const long before = cached_programs();
    for (int attempt = 0; attempt < 2; ++attempt) CHECK_THROWS_AS(build("undeclared_name"), DeviceError);
    CHECK(cached_programs() == before);
    build(std::to_string(Clock::now().time_since_epoch().count()));  // new in each run
    if (Session(choose_device("")).device().platform == "Portable Computing Language")
        CHECK(cached_programs() == before + 1);
}

TEST_CASE("a program is built once per text and options", "[cl]") {
    Session session(choose_device(""));
    SpanLog spans;
    session.observe(spans);
    const auto build = [&](const char* shift, const std::string& source) {
        return session.build("test", "// built once\n" + source, {shift});
    };
    build("-DRAYA_SHIFT=0.5f", kProgramSource);
    build("-DRAYA_SHIFT=0.5f", kProgramSource);
    CHECK(spans.spans().size() == 1);
    build("-DRAYA_SHIFT=1.5f", kProgramSource);
    build("-DRAYA_SHIFT=0.5f", kProgramSource + "\n");
    CHECK(spans.spans().size() == 3);
    CHECK(build("-DRAYA_SHIFT=1.5f", kProgramSource).options() == "-DRAYA_SHIFT=1.5f");
    CHECK(spans.spans().size() == 3);
}
