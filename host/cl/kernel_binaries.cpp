#include "host/cl/kernel_binaries.hpp"

#include <fmt/core.h>
#include <xxhash.h>

#include <cstdlib>

#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

bool binaries_are_off() {
    const char* const variable = std::getenv("RAYA_BINARIES");
    const std::string value = variable == nullptr ? "" : variable;
    if (!value.empty() && value != "off")
        throw UserError(fmt::format("RAYA_BINARIES={}: must be off, or not set", value));
    return value == "off";
}

}  // namespace

fs::path kernel_binary_file(const cl::Device& device, const std::string& source, const std::string& options) {
    fs::path folder;
    try {
        folder = module_folder();
    } catch (const ModuleError&) {
        return {};
    }
    const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
    std::string key;
    for (const std::string& part : {platform.getInfo<CL_PLATFORM_NAME>(), platform.getInfo<CL_PLATFORM_VERSION>(),
                                    device.getInfo<CL_DEVICE_NAME>(), device.getInfo<CL_DRIVER_VERSION>(), options})
        key += part + '\n';
    key += source;
    const XXH128_hash_t hash = XXH3_128bits(key.data(), key.size());
    return folder / "kernels" / fmt::format("{:016x}{:016x}.bin", hash.high64, hash.low64);
}

std::optional<KernelBinary> read_kernel_binary(const fs::path& file) {
    std::error_code ignored;
    if (binaries_are_off() || !fs::exists(file, ignored) || !unsafe_code_file_reason(file).empty()) return {};
    try {
        const std::string bytes = read_file(file);
        return KernelBinary(bytes.begin(), bytes.end());
    } catch (const UnreadableFile&) {  // the kernel is compiled instead
        return {};
    }
}

void write_kernel_binary(const fs::path& file, const KernelBinary& binary) {
    std::error_code failure;
    fs::create_directories(file.parent_path(), failure);
    if (failure)
        throw UserError(
            fmt::format("cannot create directory '{}': {}", file.parent_path().string(), failure.message()));
    write_whole_file(file, std::string(binary.begin(), binary.end()));
}

}  // namespace raya
