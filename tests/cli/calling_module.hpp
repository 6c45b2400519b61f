// Finds the module that contains a return address, so that preloaded libraries inject faults only into calls by raya's
// own code.
#pragma once
#include <dlfcn.h>
#include <link.h>

#include <cstdint>
#include <cstring>

namespace raya {

/// Returns the file name of the library or module that contains the code at `address`; "" for the program itself; null
/// if no file contains the address. Sets `base` to the file's load address. Takes no lock and allocates no memory.
inline const char* module_of(std::uintptr_t address, std::uintptr_t& base) {
    dl_find_object found;
    if (_dl_find_object(reinterpret_cast<void*>(address), &found) != 0) return nullptr;
    base = found.dlfo_link_map->l_addr;
    const char* const name = found.dlfo_link_map->l_name;
    const char* const slash = std::strrchr(name, '/');
    return slash != nullptr ? slash + 1 : name;
}

inline bool begins_with(const char* text, const char* begin) {
    return std::strncmp(text, begin, std::strlen(begin)) == 0;
}

/// Returns true if `name`, a result of module_of(), names the program raya or one of its modules.
inline bool is_raya(const char* name) { return *name == '\0' || begins_with(name, "raya"); }

}  // namespace raya
