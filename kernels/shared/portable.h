// Types and macros that make the shared headers valid in both C++ and OpenCL C.
#ifndef RAYA_SHARED_PORTABLE_H
#define RAYA_SHARED_PORTABLE_H

#if defined(__OPENCL_VERSION__) || defined(__OPENCL_C_VERSION__)  // plain clang defines only the second
typedef uint raya_u32;
typedef ulong raya_u64;
#define RAYA_SHARED_SIZE(type, bytes)  // the host checks the sizes
#define RAYA_SHARED_FUNCTION static inline
#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: number of work-items in a work-group, 1..1024
#endif
#else
#include <cstdint>
typedef std::uint32_t raya_u32;
typedef std::uint64_t raya_u64;
#define RAYA_SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), "host and device must agree on " #type)
#define RAYA_SHARED_FUNCTION inline
#endif

#endif
