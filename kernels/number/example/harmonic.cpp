// Example of an OpenCL program that uses the number layer. It sums the harmonic series, which diverges, until rounding
// stops the sum from growing.
//   harmonic OPTIONS     runs in the folder of harmonic.cl. OPTIONS are for the kernel compiler and name the folder
//                        that holds number/: -I ../.., or $(pkg-config --cflags raya-number) if raya is installed
// It needs only OpenCL:   c++ -std=c++17 harmonic.cpp -lOpenCL
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace {

void check(cl_int error, const char* what) {
    if (error == CL_SUCCESS) return;
    std::fprintf(stderr, "%s failed: OpenCL error %d\n", what, error);
    std::exit(1);
}

cl_device_id first_device() {
    cl_platform_id platforms[16];
    cl_uint count = 0;
    check(clGetPlatformIDs(16, platforms, &count), "finding platforms");
    cl_device_id device = nullptr;
    for (cl_uint i = 0; i < count && i < 16 && device == nullptr; ++i)
        clGetDeviceIDs(platforms[i], CL_DEVICE_TYPE_ALL, 1, &device, nullptr);  // a platform may have no device
    if (device == nullptr) check(CL_DEVICE_NOT_FOUND, "finding a device");
    return device;
}

/// Returns the kernel's build options for a format, including whether the device's fma and division are exact.
std::string build_options(cl_device_id device, const std::string& given, int exponent_bits, int fraction_bits) {
    cl_device_fp_config floats = 0;
    check(clGetDeviceInfo(device, CL_DEVICE_SINGLE_FP_CONFIG, sizeof floats, &floats, nullptr),
          "reading CL_DEVICE_SINGLE_FP_CONFIG");
    const bool exact = (floats & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    return given + " -DRAYA_EXPONENT_BITS=" + std::to_string(exponent_bits) +
           " -DRAYA_FRACTION_BITS=" + std::to_string(fraction_bits) +
           ((floats & CL_FP_FMA) != 0 ? "" : " -DRAYA_EXACT_FMA=0") +
           (exact ? " -cl-fp32-correctly-rounded-divide-sqrt" : " -DRAYA_EXACT_DIVIDE=0");
}

cl_kernel build(cl_context context, cl_device_id device, const std::string& options) {
    std::ifstream file("harmonic.cl");
    const std::string source{std::istreambuf_iterator<char>(file), {}};
    if (source.empty()) check(CL_INVALID_VALUE, "reading harmonic.cl in the current folder");
    const char* text = source.c_str();
    cl_int error = CL_SUCCESS;
    cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, &error);
    check(error, "making the program of harmonic.cl");
    check(clBuildProgram(program, 1, &device, options.c_str(), nullptr, nullptr),
          ("building harmonic.cl with" + options).c_str());
    cl_kernel kernel = clCreateKernel(program, "harmonic", &error);
    check(error, "making the kernel harmonic");
    clReleaseProgram(program);
    return kernel;
}

/// Runs the kernel and prints one line.
void run(cl_context context, cl_command_queue queue, cl_kernel kernel, const char* name) {
    cl_int error = CL_SUCCESS;
    cl_mem sum = clCreateBuffer(context, CL_MEM_WRITE_ONLY, sizeof(cl_float), nullptr, &error);
    check(error, "making a buffer");
    cl_mem terms = clCreateBuffer(context, CL_MEM_WRITE_ONLY, sizeof(cl_uint), nullptr, &error);
    check(error, "making a buffer");
    check(clSetKernelArg(kernel, 0, sizeof sum, &sum), "setting an argument");
    check(clSetKernelArg(kernel, 1, sizeof terms, &terms), "setting an argument");
    const size_t one = 1;
    check(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr), "running the kernel");
    cl_float found_sum = 0;
    cl_uint found_terms = 0;
    check(clEnqueueReadBuffer(queue, sum, CL_TRUE, 0, sizeof found_sum, &found_sum, 0, nullptr, nullptr),
          "reading the sum");
    check(clEnqueueReadBuffer(queue, terms, CL_TRUE, 0, sizeof found_terms, &found_terms, 0, nullptr, nullptr),
          "reading the number of terms");
    std::printf("%-18s %8u terms, sum %.7g\n", name, found_terms, found_sum);
    clReleaseMemObject(sum);
    clReleaseMemObject(terms);
    clReleaseKernel(kernel);
}

}  // namespace

int main(int argc, char** argv) {
    std::string given;
    for (int i = 1; i < argc; ++i) given += std::string(argv[i]) + ' ';
    struct {
        const char* name;
        int exponent_bits, fraction_bits;
    } const formats[] = {{"e8m7 (bfloat16)", 8, 7}, {"e5m10 (fp16)", 5, 10}, {"e6m15 (SPA)", 6, 15}};
    cl_device_id device = first_device();
    cl_int error = CL_SUCCESS;
    cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &error);
    check(error, "making a context");
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &error);
    check(error, "making a queue");
    for (const auto& format : formats) {
        const std::string options = build_options(device, given, format.exponent_bits, format.fraction_bits);
        run(context, queue, build(context, device, options), format.name);
    }
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return 0;
}
