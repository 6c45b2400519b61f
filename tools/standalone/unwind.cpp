// _dl_find_object() for C libraries before glibc 2.35. gcc's unwinder calls it to find unwind tables when an exception
// is thrown. It is the only function of glibc 2.35 that a statically linked unwinder needs. The function
// is hidden from other libraries. An older C library does not declare it, and a compiler for it does not call it.
#include <dlfcn.h>
#include <link.h>

#include <cstdint>

#ifdef DLFO_EH_SEGMENT_TYPE

namespace {

struct Search {
    std::uintptr_t address;
    dl_find_object* result;
};

/// Callback of dl_iterate_phdr(): returns 1 if the address lies in a segment of the object, else 0 to continue.
int find_object(dl_phdr_info* object, std::size_t, void* data) {
    const auto& search = *static_cast<Search*>(data);
    bool inside = false;
    void* tables = nullptr;
    for (int i = 0; i < object->dlpi_phnum; ++i) {
        const ElfW(Phdr)& segment = object->dlpi_phdr[i];
        const std::uintptr_t start = object->dlpi_addr + segment.p_vaddr;
        if (segment.p_type == PT_LOAD && search.address - start < segment.p_memsz) inside = true;
        if (segment.p_type == PT_GNU_EH_FRAME) tables = reinterpret_cast<void*>(start);
    }
    if (!inside) return 0;
    search.result->dlfo_eh_frame = tables;
    return 1;
}

}  // namespace

/// Returns 0 if `address` lies in a loaded object with unwind tables, else -1. Sets only dlfo_eh_frame, the only member
/// that the unwinder reads.
extern "C" __attribute__((visibility("hidden"))) int _dl_find_object(void* address, dl_find_object* result) noexcept {
    *result = {};
    Search search{reinterpret_cast<std::uintptr_t>(address), result};
    return ::dl_iterate_phdr(find_object, &search) == 1 && result->dlfo_eh_frame != nullptr ? 0 : -1;
}
#endif
