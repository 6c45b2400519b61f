// A session that ends because of an exception leaves no running commands.
#include <catch2/catch.hpp>
#include <stdexcept>
#include <string>

#include "host/cl/commands.hpp"

using namespace raya;

TEST_CASE("a session that an exception ends waits for the device's running commands", "[cl]") {
    // PoCL compiles this kernel at its launch. Then the kernel runs millions of iterations, and only the session's
    // destructor waits for its end.
    const std::string source =
        "kernel void slow(global uint* a, const uint turns) {\n"
        "    uint x = a[0];\n"
        "    for (uint i = 0; i < turns; ++i) x = x * 1664525U + 1013904223U;\n"
        "    a[0] = x;\n"
        "}";
    constexpr cl_uint kIterations = 1u << 25;
    cl_uint expected = 1, got = 0;
    for (cl_uint i = 0; i < kIterations; ++i) expected = expected * 1664525U + 1013904223U;
    cl::Buffer memory;
    const auto fail = [&] {
        Session session(choose_device(""));
        auto slow = session.build("slow", source, {}).kernel<Buffer<cl_uint>&, cl_uint>("slow");
        Buffer<cl_uint> a = session.buffer<cl_uint>("a", 1);
        memory = a.memory();
        session.fill("one", a, 1);
        session.launch("slow", slow, 1, 1, a, kIterations);
        session.flush();
        session.launch("empty", slow, 0, 1, a, kIterations);
    };
    CHECK_THROWS_AS(fail(), std::invalid_argument);
    // This separate queue does not wait for the session's commands.
    const auto context = memory.getInfo<CL_MEM_CONTEXT>();
    const cl::CommandQueue separate_queue(context, context.getInfo<CL_CONTEXT_DEVICES>().front());
    separate_queue.enqueueReadBuffer(memory, CL_TRUE, 0, sizeof got, &got);
    CHECK(got == expected);
}
