#include "host/ring/ring.hpp"

#include <algorithm>
#include <utility>

namespace raya {

Ring::Ring(Session& session, Communication& counted, std::size_t pes, std::size_t block_words)
    : session_(session),
      counted_(counted),
      pes_(pes),
      block_words_(block_words),
      front_(session.buffer<float>("ring blocks", pes * block_words)),
      back_(session.buffer<float>("ring blocks on their way", pes * block_words)) {}

void Ring::load(const Buffer<float>& own, std::size_t own_words, std::size_t begin) {
    const std::size_t count = std::min(block_words_, own_words - begin);
    if (count == own_words) return session_.copy("ring.load", own, 0, front_, 0, pes_ * count);
    session_.copy_blocks("ring.load", own, {begin, own_words}, front_, {0, block_words_}, count, pes_);
}

void Ring::rotate(Turn turn) {
    if (turn == Turn::kDown)
        shift("ring.rotate_down", front_, back_, 1);
    else
        shift("ring.rotate_up", front_, back_, pes_ - 1);
    counted_.rotations += 1;
    counted_.rotation_words += pes_ * block_words_;
    std::swap(front_, back_);
}

void Ring::shift(const char* label, const Buffer<float>& from, Buffer<float>& to, std::size_t distance) {
    const std::size_t first = distance % pes_ * block_words_, all = pes_ * block_words_;
    session_.copy(label, from, first, to, 0, all - first);
    session_.copy(label, from, 0, to, all - first, first);
}

}  // namespace raya
