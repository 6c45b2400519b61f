// Fault injection into allocations: a library that is preloaded into raya (LD_PRELOAD) and makes one allocation fail.
//   RAYA_MEMORY_SITES=FILE      when the process exits, writes a line for each allocation site: number of the site,
//                               number of allocations, return addresses. The last line, "elsewhere", has the number
//                               of allocations by other libraries.
//   RAYA_MEMORY_FAULT=1f2e      the first allocation at the site with number 1f2e fails
//   RAYA_MEMORY_FAULT==17       the 17th allocation by raya fails
//   RAYA_MEMORY_FAULT=+17       the 17th allocation by other libraries fails
//   RAYA_MEMORY_FAILED=FILE     creates FILE when the injected fault occurs
// A site is identified by the innermost return addresses in raya and its modules. An allocation counts as raya's if
// only libraries that allocate for their caller are between these addresses and the allocation: the C and C++
// libraries, fmt, zlib and xxHash.
#include <fcntl.h>
#include <unistd.h>
#include <unwind.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/cli/calling_module.hpp"

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

constexpr std::size_t kDepth = 3;        // addresses per site; a single one would not distinguish callers of a template
constexpr std::size_t kSlots = 1 << 16;  // maximum number of sites

using Site = std::array<std::uintptr_t, kDepth>;

struct Slot {
    std::atomic<std::uint64_t> number{0};  // number of the site; 0: the slot is free
    std::atomic<std::uint64_t> count{0};   // number of allocations
    Site site{};
};

std::array<Slot, kSlots> slots;
std::atomic<std::uint64_t> raya_allocations{0}, other_allocations{0};
std::atomic<bool> has_failed{false};
__thread bool busy __attribute__((tls_model("initial-exec"))) = false;  // true during this library's own allocations

enum class Module { kThisLibrary, kRaya, kSupport, kOther };  // kSupport: a library that allocates for its caller

Module module_of(std::uintptr_t address, std::uintptr_t& base) {
    const char* const name = raya::module_of(address, base);
    if (name == nullptr) return Module::kOther;
    if (raya::is_raya(name)) return Module::kRaya;
    for (const char* support : {"libstdc++", "libc.so", "libfmt", "libz.so", "libxxhash", "ld-linux"})
        if (raya::begins_with(name, support)) return Module::kSupport;
    return raya::begins_with(name, "libmemory_faults") ? Module::kThisLibrary : Module::kOther;
}

struct StackWalk {
    Site site{};
    std::size_t frames = 0;  // number of addresses in `site`
};

_Unwind_Reason_Code add_frame(_Unwind_Context* context, void* data) {
    StackWalk& walk = *static_cast<StackWalk*>(data);
    std::uintptr_t base = 0;
    const std::uintptr_t address = _Unwind_GetIP(context);
    const Module module = module_of(address - 1, base);
    if (module == Module::kOther) return _URC_END_OF_STACK;
    if (module == Module::kRaya) walk.site[walk.frames++] = address - base;
    return walk.frames == kDepth ? _URC_END_OF_STACK : _URC_NO_REASON;
}

std::uint64_t number_of(const Site& site) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a over 64-bit words
    for (const std::uintptr_t address : site) hash = (hash ^ address) * 1099511628211ull;
    return hash | 1;
}

void count_allocation(std::uint64_t number, const Site& site) {
    for (std::size_t index = number % kSlots;; index = (index + 1) % kSlots) {
        std::uint64_t found = 0;
        if (slots[index].number.compare_exchange_strong(found, number)) slots[index].site = site;
        if (found != 0 && found != number) continue;
        ++slots[index].count;
        return;
    }
}

/// The first call sets errno and returns true. Later calls return false.
bool fail_once() {
    if (has_failed.exchange(true)) return false;
    if (const char* file = std::getenv("RAYA_MEMORY_FAILED")) ::close(::open(file, O_CREAT | O_WRONLY, 0666));
    errno = ENOMEM;
    return true;
}

/// The value of RAYA_MEMORY_FAULT.
struct Fault {
    char kind = '\0';          // '=': allocation by raya, '+': by other libraries, ' ': site, 0: no fault
    std::uint64_t number = 0;  // number of the allocation (from 1) or of the site

    Fault() {
        const char* text = std::getenv("RAYA_MEMORY_FAULT");
        if (text == nullptr) return;
        const bool is_ordinal = *text == '=' || *text == '+';
        kind = is_ordinal ? *text : ' ';
        number = std::strtoull(text + is_ordinal, nullptr, is_ordinal ? 10 : 16);
    }
};

bool is_by_raya(const void* caller, StackWalk& walk) {
    std::uintptr_t base = 0;
    const Module module = module_of(reinterpret_cast<std::uintptr_t>(caller) - 1, base);
    if (module == Module::kRaya || module == Module::kSupport) {
        busy = true;
        _Unwind_Backtrace(&add_frame, &walk);
        busy = false;
    }
    return walk.frames > 0;
}

bool fails(const void* caller) {
    static const Fault fault;
    static const bool lists_sites = std::getenv("RAYA_MEMORY_SITES") != nullptr;
    if (busy || (fault.kind == '\0' && !lists_sites) || has_failed.load(std::memory_order_relaxed)) return false;
    StackWalk walk;
    const bool by_raya = is_by_raya(caller, walk);
    const std::uint64_t count = ++(by_raya ? raya_allocations : other_allocations), number = number_of(walk.site);
    if (by_raya && lists_sites) count_allocation(number, walk.site);
    const bool is_faulty = fault.kind == ' ' ? by_raya && number == fault.number
                                             : count == fault.number && fault.kind == (by_raya ? '=' : '+');
    return is_faulty && fail_once();
}

/// Writes RAYA_MEMORY_SITES when the process exits.
struct SiteWriter {
    ~SiteWriter() {
        busy = true;  // dprintf() may allocate
        const char* file = std::getenv("RAYA_MEMORY_SITES");
        const int descriptor = file != nullptr ? ::open(file, O_CREAT | O_WRONLY | O_TRUNC, 0666) : -1;
        if (descriptor < 0) return;
        for (const Slot& slot : slots) {
            if (slot.number == 0) continue;
            ::dprintf(descriptor, "%lx %lu", slot.number.load(), slot.count.load());
            for (const std::uintptr_t address : slot.site) ::dprintf(descriptor, " %lx", address);
            ::dprintf(descriptor, "\n");
        }
        ::dprintf(descriptor, "elsewhere %lu\n", other_allocations.load());
        ::close(descriptor);
    }
} site_writer;

}  // namespace

extern "C" {

void* malloc(std::size_t bytes) { return fails(__builtin_return_address(0)) ? nullptr : __libc_malloc(bytes); }

void* calloc(std::size_t count, std::size_t bytes) {
    return fails(__builtin_return_address(0)) ? nullptr : __libc_calloc(count, bytes);
}

void* realloc(void* memory, std::size_t bytes) {
    return fails(__builtin_return_address(0)) ? nullptr : __libc_realloc(memory, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) {
    return fails(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
    return fails(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, bytes);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
    if (fails(__builtin_return_address(0))) return ENOMEM;
    *memory = __libc_memalign(alignment, bytes);
    return *memory != nullptr ? 0 : ENOMEM;
}

}  // extern "C"
