// Prints the reference images. Usage: build/tests/make_reference_images > host/verify/reference_images.txt
#include "tests/verify/make_reference_images.hpp"

#include <cstdio>

int main() {
    const std::string text = raya::make_reference_images();
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
}
