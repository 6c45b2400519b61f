// Which part of the program an address belongs to: for preloaded libraries that let calls of raya's own code fail.
#pragma once
#include <dlfcn.h>
#include <link.h>

#include <cstdint>
#include <cstring>

namespace raya {

/// The file name of the library or module that holds the code at `address`, empty for the program itself, null where it
/// is in none; `base` becomes the address it was loaded at. Takes neither a lock nor memory.
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

/// Whether the name is of raya's own code: the program or one of its modules.
inline bool is_raya(const char* name) { return *name == '\0' || begins_with(name, "raya"); }

}  // namespace raya
