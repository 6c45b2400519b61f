// The literature that pages speak of.
#pragma once
#include <span>
#include <string>

namespace raya {

struct Reference {
    std::string authors;  // as pages name them: "Heirich & Arvo"
    std::string full;     // as far as it is known for certain
};

/// In the order of their authors' names.
std::span<const Reference> references();

}  // namespace raya
