// Prints the known images. Usage: build/tests/make_pictures > host/verify/pictures.txt
#include "tests/verify/make_pictures.hpp"

#include <cstdio>

int main() {
    const std::string text = raya::make_pictures();
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
}
