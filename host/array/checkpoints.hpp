// Checkpoints of a render: one list of a machine's state saves and restores it.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/array/render.hpp"
#include "host/base/checkpoint.hpp"
#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/error.hpp"

namespace raya {

/// Visitor of a render's state, which saves or restores what it is given. Collective: all ranks visit the same members
/// in the same order. Only rank 0 has the file, which does not depend on the number of ranks. If the file is damaged,
/// functions throw UserError in rank 0.
class RenderState {
  public:
    RenderState(Session& session, const Distribution& pes, CheckpointWriter* writer, CheckpointReader* reader,
                bool saves)
        : session_(session), pes_(pes), writer_(writer), reader_(reader), saves_(saves) {}

    bool restores() const { return !saves_; }

    /// A number, or a structure of numbers of one type, that all ranks have.
    template <Sendable T>
    void value(T& value) {
        std::vector<T> values = {value};
        vector(values);
        value = values.front();
    }
    /// Numbers that all ranks have. `any_size`: see rank_0().
    template <Sendable T>
    void vector(std::vector<T>& values, bool any_size = false) {
        rank_0(values, any_size);
        if (restores()) pes_.ranks().broadcast(values);
    }
    /// Numbers that only rank 0 has. If `any_size`, the file determines their number.
    template <class T>
    void rank_0(std::vector<T>& values, bool any_size = false) {
        if (writer_ != nullptr) writer_->put(values);
        if (reader_ == nullptr) return;
        if (any_size)
            values = reader_->take_any<T>();
        else
            reader_->take(values);
    }
    /// Elements of this rank's PEs, [slot][count].
    template <Sendable T, class Count>
    void elements(std::vector<T>& own, const Count& count) {
        std::vector<T> all;
        if (saves_) all = pes_.gather(own, count);
        if (reader_ != nullptr) all.resize(pes_.total(count));
        rank_0(all);
        if (restores()) own = pes_.scatter(std::move(all), count);
    }
    /// A buffer [slot][elements of a PE].
    template <Sendable T>
    void buffer(Buffer<T>& buffer) {
        std::vector<T> own(buffer.size());
        if (saves_) session_.read("save", buffer, own);
        elements(own, buffer.size() / pes_.count());
        if (restores()) session_.write("resume", buffer, own);
    }
    /// A part of a PE's elements in a buffer: `count` elements from `first` on.
    struct Part {
        std::size_t first = 0, count = 0;
    };
    /// Some elements of each PE. parts_of(PE): the vector of its Part. For PEs of other ranks, only the counts are
    /// used.
    template <Sendable T, class PartsOf>
    void parts(Buffer<T>& buffer, const PartsOf& parts_of) {
        const auto count = [&](std::uint32_t pe) {
            std::size_t elements = 0;
            for (const Part& part : parts_of(pe)) elements += part.count;
            return elements;
        };
        std::size_t total = 0;
        for (const std::uint32_t pe : pes_.own()) total += count(pe);
        std::vector<T> own(total);
        const auto for_each_part = [&](const auto& transfer) {
            std::span<T> left = own;
            for (const std::uint32_t pe : pes_.own())
                for (const Part& part : parts_of(pe)) {
                    transfer(left.first(part.count), part.first);
                    left = left.subspan(part.count);
                }
        };
        if (saves_) for_each_part([&](std::span<T> some, std::size_t at) { session_.read("save", buffer, some, at); });
        elements(own, count);
        if (restores())
            for_each_part([&](std::span<T> some, std::size_t at) { session_.write("resume", buffer, some, at); });
    }

  private:
    Session& session_;
    const Distribution& pes_;
    CheckpointWriter* writer_;
    CheckpointReader* reader_;
    bool saves_;
};

/// The checkpoints of one render.
class Checkpoints {
  public:
    /// Without `checkpointing`, resume() returns false and save_if_due() does nothing. `settings`: those that determine
    /// the state; only those of rank 0 are used.
    Checkpoints(const Checkpointing* checkpointing, Session& session, const Distribution& pes, StateSettings settings)
        : checkpointing_(checkpointing), session_(session), pes_(pes), settings_(std::move(settings)) {}

    bool active() const { return checkpointing_ != nullptr; }
    /// Target duration of a band of pixels, seconds.
    double band_s() const { return checkpointing_->band_s; }

    /// Collective: if there is a checkpoint, restores the state by visit(RenderState&) and returns true.
    template <class Visit>
    bool resume(const Visit& visit) {
        if (checkpointing_ == nullptr || !checkpointing_->resume) return false;
        Ranks& ranks = pes_.ranks();
        char resumes = 0;
        if (ranks.is_first())
            checkpointing_->resume([&](std::string_view bytes) {
                CheckpointReader reader(bytes, settings_);
                resumes = 1;
                ranks.broadcast(resumes);
                restore(&reader, visit);
                return RenderedPart{reader.part().fraction, earlier_s_};
            });
        if (resumes) return true;
        ranks.broadcast(resumes);
        if (resumes) restore(nullptr, visit);
        return resumes != 0;
    }

    /// Collective: saves the state by visit(RenderState&) if a checkpoint is due. `fraction`: completed fraction of the
    /// render.
    template <class Visit>
    void save_if_due(double fraction, const Visit& visit) {
        if (checkpointing_ == nullptr) return;
        Ranks& ranks = pes_.ranks();
        char is_due = ranks.is_first() && checkpointing_->due();
        ranks.broadcast(is_due);
        if (!is_due) return;
        const SpanLog::Span span = session_.span("save checkpoint");
        std::optional<CheckpointWriter> writer;
        if (ranks.is_first()) writer.emplace(settings_, RenderedPart{fraction, seconds()});
        RenderState state(session_, pes_, writer ? &*writer : nullptr, nullptr, true);
        visit(state);
        if (writer) checkpointing_->save(writer->finish());
    }

    /// Measured time of earlier runs, and of all runs so far, seconds.
    double earlier_s() const { return earlier_s_; }
    double seconds() const { return earlier_s_ + seconds_since(start_); }

  private:
    template <class Visit>
    void restore(CheckpointReader* reader, const Visit& visit) {
        const SpanLog::Span span = session_.span("resume");
        if (reader != nullptr) earlier_s_ = reader->part().seconds;
        pes_.ranks().broadcast(earlier_s_);
        RenderState state(session_, pes_, nullptr, reader, false);
        visit(state);
        if (reader != nullptr) reader->check_end();
    }

    const Checkpointing* checkpointing_;
    Session& session_;
    const Distribution& pes_;
    StateSettings settings_;
    double earlier_s_ = 0;
    Clock::time_point start_ = Clock::now();
};

}  // namespace raya
