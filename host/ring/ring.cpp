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
    const std::size_t last = (pes_ - 1) * block_words_;
    const auto move = [&](const char* label, std::size_t from, std::size_t to, std::size_t words) {
        session_.copy(label, front_, from, back_, to, words);
        counted_.rotation_words += words;
    };
    if (turn == Turn::kDown) {
        move("ring.rotate_down", block_words_, 0, last);
        move("ring.rotate_down", 0, last, block_words_);
    } else {
        move("ring.rotate_up", 0, block_words_, last);
        move("ring.rotate_up", last, 0, block_words_);
    }
    counted_.rotations += 1;
    std::swap(front_, back_);
}

}  // namespace raya
