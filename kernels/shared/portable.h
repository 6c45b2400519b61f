// Lets one header serve the C++ host and the OpenCL C kernels: sized types under one name, and no other difference.
#ifndef RAYA_SHARED_PORTABLE_H
#define RAYA_SHARED_PORTABLE_H

#if defined(__OPENCL_VERSION__) || defined(__OPENCL_C_VERSION__)  // the second alone: clang without a driver around it
typedef uint raya_u32;
typedef ulong raya_u64;
#define RAYA_SHARED_SIZE(type, bytes)  // checked once, on the host
#define RAYA_SHARED_FUNCTION static inline
#else
#include <cstdint>
typedef std::uint32_t raya_u32;
typedef std::uint64_t raya_u64;
#define RAYA_SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), "host and device must agree on " #type)
#define RAYA_SHARED_FUNCTION inline
#endif

#endif
