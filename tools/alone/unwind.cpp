// How an exception finds the tables by which it unwinds, for C libraries before glibc 2.35, which lack this function:
// gcc's unwinder, linked into programs that are to run there, calls nothing else of that version. Hidden: nobody else
// gets it.
#include <dlfcn.h>
#include <link.h>

#include <cstdint>

namespace {

struct Search {
    std::uintptr_t address;
    dl_find_object* result;
};

/// 1 where the object has the address among its segments, else 0: go on.
int look(dl_phdr_info* object, std::size_t, void* data) {
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

/// 0 where `address` lies in a loaded object that has such tables; of the result the unwinder reads dlfo_eh_frame
/// alone.
extern "C" __attribute__((visibility("hidden"))) int _dl_find_object(void* address, dl_find_object* result) noexcept {
    *result = {};
    Search search{reinterpret_cast<std::uintptr_t>(address), result};
    return ::dl_iterate_phdr(look, &search) == 1 && result->dlfo_eh_frame != nullptr ? 0 : -1;
}
