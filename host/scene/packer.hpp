// Packing of a scene and its view into a job: the words that the bus broadcasts and every PE stores
// (kernels/shared/job.h).
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/scene.hpp"
#include "kernels/shared/job.h"

namespace raya {

/// Number of words of a record.
template <class Record>
inline constexpr std::size_t kWordsOf = sizeof(Record) / sizeof(std::uint32_t);

/// Maximum number of words (4 GB) of a job or of a torus node's memory, so that 32-bit indices can address them.
inline constexpr std::size_t kMaxWords = std::size_t{1} << 30;

/// Returns `words` rounded up to a multiple of four, because kernels read float4.
constexpr std::size_t padded_to_rows(std::size_t words) { return (words + 3) / 4 * 4; }

template <class Record>
using WordsOf = std::array<std::uint32_t, kWordsOf<Record>>;

/// Reads the record that starts at words[at].
template <class Record>
Record record_at(std::span<const std::uint32_t> words, std::size_t at) {
    WordsOf<Record> record;
    std::copy_n(words.subspan(at, record.size()).begin(), record.size(), record.begin());
    return std::bit_cast<Record>(record);
}

/// Writes the record to words[at] and the following words.
template <class Record>
void put_record(std::span<std::uint32_t> words, std::size_t at, const Record& record) {
    const auto record_words = std::bit_cast<WordsOf<Record>>(record);
    std::copy(record_words.begin(), record_words.end(), words.subspan(at, record_words.size()).begin());
}

/// The position of the primary ray in a pixel (kernels/README.md, Camera).
enum class Sampling { kCentres, kCorners };

/// Parameters of a job other than its scene.
struct JobSettings {
    ImageSize image;
    Sampling sampling = Sampling::kCentres;
    std::uint32_t bounces = 8;                        // maximum number of reflections and refractions on a path
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};  // modelled cycles of one event of each kind
    NumberFormat format{};                            // format of every number in the job
    int length_exponent = 0;                          // lengths are multiplied by 2^length_exponent; see length_scale()
    std::size_t spare_words = 0;                      // for which memory is reserved after the job's words
};

/// Returns the kind (RAYA_SPHERE, ...) of an object.
std::uint32_t kind_of_object(const raya_objects& all, std::uint32_t number);
/// Returns the offset of an object's words in the job.
std::size_t object_at(const raya_objects& all, std::uint32_t number);
/// Returns the number of words of an object, without the corners of a polygon.
std::uint32_t words_of_kind(std::uint32_t kind);

/// The words of a job, which begin with its header.
class PackedJob {
  public:
    /// `words`: the job's words, with space for the header at the start.
    PackedJob(const raya_job& header, std::vector<std::uint32_t> words, bool has_patches);

    const raya_job& header() const { return header_; }
    const std::vector<std::uint32_t>& words() const { return words_; }
    bool has_patches() const { return has_patches_; }
    /// Returns the first of the words of an object.
    const std::uint32_t* object(std::uint32_t number) const {
        return words_.data() + object_at(header_.objects, number);
    }

    void set_header(const raya_job& header);
    /// Appends `count` words of 0 and returns them. The span is valid until more words are appended.
    std::span<std::uint32_t> append_zeros(std::size_t count);

  private:
    raya_job header_;
    std::vector<std::uint32_t> words_;
    bool has_patches_;
};

/// Copies objects of a job to the memory of a processor. Offsets count from the processor's first word, and lists of
/// object numbers are ascending.
class ObjectCopier {
  public:
    /// Appends the processor's words to `words`, after `header_words` words of 0.
    ObjectCopier(const PackedJob& job, std::vector<std::uint32_t>& words, std::size_t header_words)
        : job_(job), words_(words), start_(words.size()) {
        words.resize(start_ + header_words);
    }

    /// Returns the offset of the next word.
    std::uint32_t offset() const { return static_cast<std::uint32_t>(words_.size() - start_); }
    /// Pads with zeros to a multiple of four words, where a row or the next processor must start.
    void fill_row() { words_.resize(start_ + padded_to_rows(offset())); }
    /// Appends words of the job.
    void append(std::size_t at, std::size_t count) {
        const auto from = job_.words().begin() + static_cast<std::ptrdiff_t>(at);
        words_.insert(words_.end(), from, from + static_cast<std::ptrdiff_t>(count));
    }
    /// Appends the surfaces of the objects, each once.
    void append_surfaces(std::span<const std::uint32_t> numbers);
    /// Appends objects whose surfaces have been appended: spheres, their surfaces' offsets, planes, RAYA_FIXED_LIST,
    /// polygons, the polygons' corners and normals.
    raya_objects append_objects(std::span<const std::uint32_t> numbers);
    template <class Record>
    void put(std::size_t at, const Record& record) {
        put_record(words_, start_ + at, record);
    }

  private:
    std::uint32_t surface_of(std::uint32_t number) const;

    const PackedJob& job_;
    std::vector<std::uint32_t>& words_;
    std::size_t start_;
    std::map<std::uint32_t, std::uint32_t> surface_at_;  // first word in the job -> offset
};

/// Packs a scene. The mapping in the header assigns all pixels to one PE; machines with more PEs replace it. Each
/// number is rounded once, from double to the number format. Patches of more than three vertices are cut into
/// triangles, each of which counts as a polygon. Throws UserError if the job has more than kMaxWords words.
PackedJob pack_job(const Scene& scene, const JobSettings& settings);

}  // namespace raya
