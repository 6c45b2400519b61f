// Vectors whose memory is in huge pages.
#pragma once
#include <cstddef>
#include <vector>

namespace raya {

/// Asks the system to use huge pages for memory that nothing has accessed yet. Does nothing if the system has none.
void advise_huge_pages(void* memory, std::size_t bytes);

/// Resizes a vector. If it is empty and gets large, its memory is in huge pages: the first access to memory in small
/// pages takes longer than many a render.
template <class T>
void resize_in_huge_pages(std::vector<T>& elements, std::size_t count) {
    if (elements.empty()) {
        elements.reserve(count);
        advise_huge_pages(elements.data(), count * sizeof(T));
    }
    elements.resize(count);
}

}  // namespace raya
