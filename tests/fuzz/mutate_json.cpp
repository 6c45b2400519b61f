// Mutates the values of JSON files, and sometimes their bytes.
#include "tests/fuzz/mutate.hpp"

using namespace raya::fuzz;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    Random random(seed);
    std::string text(reinterpret_cast<const char*>(data), size);
    if (random.one_in(8) || !damage_json(text, random)) mutate_bytes(text);
    return store(text, data, max_size);
}
