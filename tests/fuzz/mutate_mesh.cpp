// Mutates the records of raya_import: whole 32-bit numbers, or bytes.
#include "tests/fuzz/mutate.hpp"

using namespace raya::fuzz;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    static const std::uint32_t kNumbers[] = {0,          1,          2,          3,          4,          5,
                                             0x5241594D, 0x5241594E, 0x5241594F, 0x52415950, 0x52415951, 0x52415952,
                                             0x3F800000, 0x7F800000, 0x7FC00000, 0x7F7FFFFF, UINT32_MAX, 1000};
    Random random(seed);
    std::string bytes(reinterpret_cast<const char*>(data), size);
    if (bytes.size() < 4 || random.one_in(3))
        mutate_bytes(bytes);
    else
        std::memcpy(bytes.data() + random.below(bytes.size() - 3), &random.pick(kNumbers), 4);
    return store(bytes, data, max_size);
}
