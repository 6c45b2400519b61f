// The refusal of what a PE's memory cannot hold.
#pragma once
#include <cstdint>
#include <string>

#include "host/error.hpp"

namespace raya {

struct DoesNotFit : UserError {
    DoesNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory)
        : UserError(message), needed_bytes(needed), memory_bytes(memory) {}

    std::uint64_t needed_bytes, memory_bytes;  // what a PE, the fullest of them, would have to hold, and what it can
};

}  // namespace raya
