#include "host/verify/breakage.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace raya {

const std::vector<Breakage>& breakages() {
    static const std::vector<Breakage> all = {
        {.name = ""},
        {.name = "rounding", .options = {"-DRAYA_BREAK_ROUNDING"}},        // ties go to the odd number
        {.name = "contraction", .options = {"-DRAYA_BREAK_CONTRACTION"}},  // the compiler may fuse a b + c
        {.name = "division", .options = {"-DRAYA_BREAK_DIVISION"}},        // fp32: by the reciprocal
        {.name = "tie", .options = {"-DRAYA_BREAK_TIE"}},                  // of equal distances the last object wins
        {.name = "walk", .options = {"-DRAYA_BREAK_WALK"}},                // the grid ends a voxel too soon
        {.name = "mapping", .options = {"-DRAYA_BREAK_MAPPING"}},          // products of 64 bits lose their upper half
        {.name = "barrier", .options = {"-DRAYA_BREAK_BARRIER"}},          // work-items read before all have written
        {.name = "border", .options = {"-DRAYA_BREAK_BORDER"}}};  // the filter takes the right border for the middle
    return all;
}

const Breakage& breakage_named(const std::string& name) {
    std::string names;
    for (const Breakage& one : breakages()) {
        if (one.name == name) return one;
        if (!one.name.empty()) names += (names.empty() ? "" : ", ") + one.name;
    }
    throw UserError(fmt::format("--break {}: must be one of {}", name, names));
}

}  // namespace raya
