// Mutates the tokens and lines of camera paths.
#include "tests/fuzz/mutate.hpp"

using namespace raya::fuzz;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    static const std::vector<std::string> kKeywords = {
        "from",      "at",      "up",
        "angle",     "#",       "1,2,3",
        "0,0,0",     "0,0,1",   "from 1,2,3 at 0,0,0 up 0,0,1 angle 40\n",
        "0,-8,3",    "1e9,0,0", "1,2",
        "1,2,3,4",   "nan,0,0", ",,",
        "1e400,0,0", ","};
    Random random(seed);
    std::string text(reinterpret_cast<const char*>(data), size);
    for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
        if (random.one_in(3))
            mutate_bytes(text);
        else
            damage_tokens(text, kKeywords, random);
    }
    return store(text, data, max_size);
}
