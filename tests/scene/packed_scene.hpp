// Decoder of a job (kernels/shared/job.h) for tests.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Decodes the words of a job and counts how often each word is read. `at` is the index of the first word to read.
class PackedScene {
  public:
    explicit PackedScene(std::vector<std::uint32_t> words)
        : words_(std::move(words)), reads_(words_.size(), 0), job_(record_at<raya_job>(words_, 0)) {
        for (std::size_t i = 0; i < kWordsOf<raya_job>; ++i) ++reads_[i];
    }

    const raya_job& job() const { return job_; }
    std::size_t size() const { return words_.size(); }

    std::uint32_t word(std::size_t at) {
        ++reads_.at(at);
        return words_.at(at);
    }
    double real(std::size_t at) { return std::bit_cast<float>(word(at)); }
    Vec3 vector(std::size_t at) {
        const double x = real(at), y = real(at + 1);
        return {x, y, real(at + 2)};
    }

    std::size_t unread_words() const { return static_cast<std::size_t>(std::count(reads_.begin(), reads_.end(), 0)); }
    std::size_t reread_words() const {
        return static_cast<std::size_t>(std::count_if(reads_.begin(), reads_.end(), [](int n) { return n > 1; }));
    }

    Surface surface(std::size_t at) {
        Surface s;
        s.colour = vector(at + RAYA_SURFACE_COLOUR);
        s.diffuse = real(at + RAYA_SURFACE_DIFFUSE);
        s.specular = real(at + RAYA_SURFACE_SPECULAR);
        s.shine = real(at + RAYA_SURFACE_SHINE);
        s.transmittance = real(at + RAYA_SURFACE_TRANSMIT);
        s.refraction_index = real(at + RAYA_SURFACE_REFRACTION);
        const Colour odd = vector(at + RAYA_SURFACE_ODD);
        const double size = real(at + RAYA_SURFACE_CHECKER);
        if (size > 0) s.checker = Checker{s.colour, odd, size};
        return s;
    }

  private:
    std::vector<std::uint32_t> words_;
    std::vector<int> reads_;
    raya_job job_;
};

}  // namespace raya
