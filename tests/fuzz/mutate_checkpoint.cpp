// Mutates the header or the values of a checkpoint. Then recomputes the hash, because the reader refuses a file with a
// wrong hash.
#include <algorithm>

#include "host/base/encoding.hpp"
#include "tests/fuzz/mutate.hpp"

namespace {

using namespace raya;
using namespace raya::fuzz;

constexpr std::size_t kHashDigits = 32;

void damage_values(std::string& values, Random& random) {
    static const std::uint64_t kCounts[] = {
        0, 1, 2, 3, 16, 1u << 20, UINT32_MAX, UINT64_MAX, UINT64_MAX / 8, UINT64_MAX / 8 + 1, 1ull << 61, 1ull << 63};
    if (values.size() < sizeof kCounts[0] || random.one_in(3)) return mutate_bytes(values);
    if (random.one_in(4)) return values.resize(random.below(values.size()));
    const std::size_t at = random.below(values.size() / 8) * 8;
    std::memcpy(values.data() + at, &random.pick(kCounts), sizeof kCounts[0]);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    Random random(seed);
    std::string text(reinterpret_cast<const char*>(data), size);
    const std::size_t magic_end = text.find('\n'),
                      header_end = magic_end == std::string::npos ? magic_end : text.find('\n', magic_end + 1);
    if (header_end == std::string::npos || text.size() < header_end + 1 + kHashDigits || random.one_in(10)) {
        mutate_bytes(text);
        return store(text, data, max_size);
    }
    std::string line = text.substr(magic_end + 1, header_end - magic_end - 1);
    std::string values = text.substr(header_end + 1, text.size() - header_end - 1 - kHashDigits);
    if (random.one_in(2))
        damage_values(values, random);
    else if (!damage_json(line, random))
        mutate_bytes(line);
    std::replace(line.begin(), line.end(), '\n', ' ');  // the header is one line
    std::string mutated = text.substr(0, magic_end + 1) + line + "\n" + values;
    if (mutated.size() + kHashDigits > max_size) mutated.resize(max_size - kHashDigits);
    return store(mutated + bytes_hash(mutated), data, max_size);
}
