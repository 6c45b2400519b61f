// Faults that are put in on purpose, one at a time, so that verify can be seen to fail: for the tests alone.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// A fault of a device, its driver or its compiler, as `raya verify --break NAME` makes it.
struct Breakage {
    std::string name;
    std::vector<std::string> options{};  // added to every kernel's build options: RAYA_BREAK_* of kernels/
};

/// Every fault that there is; the first one is none.
const std::vector<Breakage>& breakages();

/// The fault of that name, none for an empty one. UserError lists those there are.
const Breakage& breakage_named(const std::string& name);

}  // namespace raya
