// Detects denormal operands by the sticky DE flag of x86. PoCL's basic device runs kernels in the thread that waits for
// them, so the flag of this thread covers kernels too.
#pragma once
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include <cstdlib>
#include <string_view>

namespace raya {

/// Returns true if denormals in kernels can be detected: on x86, with PoCL's basic device (POCL_DEVICES=basic).
inline bool can_detect_denormals() {
    const char* devices = std::getenv("POCL_DEVICES");
#if defined(__x86_64__)
    return devices != nullptr && std::string_view(devices) == "basic";
#else
    return false;
#endif
}

/// Returns true if `work` computes with a denormal operand.
template <class Work>
bool uses_denormals([[maybe_unused]] const Work& work) {
#if defined(__x86_64__)
    constexpr unsigned kAllFlags = 0x3f, kDenormal = 0x02;
    _mm_setcsr(_mm_getcsr() & ~kAllFlags);
    work();
    return (_mm_getcsr() & kDenormal) != 0;
#else
    return false;
#endif
}

}  // namespace raya
