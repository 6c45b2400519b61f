// Settings and results that renders on all machines of PEs have in common.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host/base/log.hpp"
#include "host/cl/capture.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/profile.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/model/t805.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct RenderSettings {
    Machine machine{};
    std::uint32_t bounces = 8;  // maximum number of reflections and refractions after the primary ray
    NumberFormat format{};
    Sampling sampling = Sampling::kCentres;
    KernelChoice kernels{};
    // Maximum work of a launch (LaunchLoop): on a ring, tests and traversal steps of a lane's rays; on a torus, work of
    // a node. 0: chosen so that a launch takes about a second at most.
    std::uint32_t work_per_launch = 0;
};

struct RenderResult {
    Image image;
    EventCounts events{}, rank_events{};  // of all ranks; of this rank
    Load load;                            // modelled cycles of each PE
    LengthScale scale;
    std::uint32_t parts_of_rank = 0;  // number of PEs of this rank
    RankTraffic traffic;              // messages that this rank has sent during the render
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;                 // origin of lanes, group size and related settings (host/cl/kernel_options.hpp)
    double build_s = 0, render_s = 0;  // measured by the host's clock: kernel build; render after it
    double earlier_s = 0;              // part of render_s that earlier runs took, before a resume
    std::vector<LabelSummary> commands;

    /// Returns the number of kernel launches with this label.
    std::uint64_t launches(const std::string& label) const;
};

/// Returns the kernel options that follow from the settings and the job. `has_patches`: see PackedJob.
KernelOptions kernel_options(const RenderSettings& settings, const raya_job& job, bool has_patches);

// Launches of bounded work: a kernel is launched again until no work is left.

/// Returns the error for a launch whose loops the device has ended early. `label`: label of the launch; `remedy`: a
/// change that shortens the loops.
inline DeviceError truncated_loops_error(const std::string& label, const std::string& device,
                                         const std::string& remedy) {
    return DeviceError(
        "'" + label + "': " + device +
        " stopped this kernel's loops before their end and reported no error; the image would be wrong; remedy: " +
        remedy + ", or another device");
}

/// Amount of work of a launch without a limit.
inline constexpr std::uint32_t kUnlimitedWork = UINT32_MAX;

/// Result of a launch. `truncated`: the device has ended loops early, so that results are wrong.
struct LaunchEnd {
    bool done = true, truncated = false;
};

/// Launches a kernel with a bounded amount of work, in units that the kernel defines, until no work is left. The
/// amount is scaled so that a launch takes about a given time: then progress is shown, Ctrl-C takes effect and no GPU
/// watchdog ends the launch. After a launch whose loops the device has ended early (kernels/shared/loop_canary.clh),
/// restores the buffers that the launch changes (the state), halves the limit of the launch's label
/// (Session::launch_limit()) and repeats the launch. `T...`: element types of the state's buffers.
template <class... T>
class LaunchLoop {
  public:
    /// `remedy`: a change that shortens the kernels' loops, for messages.
    explicit LaunchLoop(std::string remedy) : remedy_(std::move(remedy)) {}

    /// Calls launch(work, resumes), then end(), which returns the LaunchEnd, until the work is done. `work`: amount of
    /// the first launch; `target_s`: intended duration of further launches; 0: they have the same amount. Without a
    /// limit there is one launch, and end() is not called. Throws truncated_loops_error() if the device ends loops
    /// early even in the smallest launch.
    template <class Launch, class End>
    void run(Session& session, const std::string& label, std::uint32_t work, double target_s, const Launch& launch,
             const End& end, Buffer<T>&... state) {
        for (bool resumes = false;;) {
            std::uint32_t& limit = session.launch_limit(label);
            work = std::min(work, limit);
            if (limit < kUnlimitedWork) save(session, state...);
            const Clock::time_point start = Clock::now();
            launch(work, resumes);
            if (work == kUnlimitedWork) return;
            const LaunchEnd ended = end();
            if (ended.truncated) {
                if (!copies_ || work == 1) throw truncated_loops_error(label, session.device().name, remedy_);
                limit = work / 2;
                std::apply([&](auto&... copy) { (session.copy("restore", copy, 0, state, 0, copy.size()), ...); },
                           *copies_);
                continue;
            }
            if (ended.done) return;
            // In a captured run, launches are the same in each repetition.
            if (target_s > 0 && Capture::active() == nullptr) work = next_work(work, seconds_since(start), target_s);
            resumes = true;
        }
    }

    const std::string& remedy() const { return remedy_; }

  private:
    // Returns the work with which the next launch takes about `target_s` seconds, if a launch with `work` took
    // `seconds`. The work grows at most by a factor of kMaxGrowth.
    static std::uint32_t next_work(std::uint32_t work, double seconds, double target_s) {
        constexpr double kMaxGrowth = 4, kMaxWork = 1u << 31;
        const double growth = seconds * kMaxGrowth > target_s ? target_s / seconds : kMaxGrowth;
        return static_cast<std::uint32_t>(std::clamp(growth * work, 1.0, kMaxWork));
    }

    void save(Session& session, Buffer<T>&... state) {
        if (!copies_) copies_.emplace(session.buffer<T>("copy of " + state.name(), state.size())...);
        std::apply([&](auto&... copy) { (session.copy("save", state, 0, copy, 0, copy.size()), ...); }, *copies_);
    }

    std::string remedy_;
    std::optional<std::tuple<Buffer<T>...>> copies_;
};

// Distribution of the PEs of a machine over ranks.

/// Returns [PE]: rank of the PE. Each rank gets consecutive PEs; the numbers of PEs differ by at most 1. Throws
/// UserError for more ranks than PEs.
std::vector<std::uint32_t> ranks_of_pes(std::uint32_t pes, std::uint32_t ranks);

/// The PEs that each rank simulates; "this rank" is that of `ranks`. A slot is the index of a PE within its rank.
/// Elements of PEs are in the order of slots in each rank, and in the order of PEs when rank 0 has those of all PEs.
/// Numbers of elements: `count` of each PE, or count(PE), which all ranks must know.
class Distribution {
  public:
    /// `rank_of`: [PE]: its rank. Slots are in ascending order of the PEs.
    Distribution(std::vector<std::uint32_t> rank_of, Ranks& ranks);

    /// The distribution of ranks_of_pes().
    explicit Distribution(std::uint32_t pes, Ranks& ranks = Ranks::single())
        : Distribution(ranks_of_pes(pes, ranks.count()), ranks) {}

    Ranks& ranks() const { return ranks_; }
    std::uint32_t all() const { return static_cast<std::uint32_t>(rank_of_.size()); }
    std::uint32_t count() const { return static_cast<std::uint32_t>(own().size()); }
    const std::vector<std::uint32_t>& own() const { return pes_of_[ranks_.rank()]; }
    const std::vector<std::uint32_t>& pes_of(std::uint32_t rank) const { return pes_of_[rank]; }
    std::uint32_t first() const { return own().front(); }
    std::uint32_t rank_of(std::size_t pe) const { return rank_of_[pe]; }
    bool has(std::size_t pe) const { return rank_of_[pe] == ranks_.rank(); }
    std::uint32_t slot_of(std::size_t pe) const { return slot_of_[pe]; }

    /// Returns the number of elements of all PEs.
    template <class Count>
    std::size_t total(const Count& count) const {
        return starts_of_pes(count).back();
    }
    /// Collective: returns the elements of all PEs in rank 0, and an empty vector in other ranks.
    template <Sendable T, class Count>
    std::vector<T> gather(std::vector<T> own_elements, const Count& count) const {
        if (!ranks_.has_several()) return own_elements;
        return in_order_of_pes(ranks_.gather(std::span<const T>(own_elements), sizes_of_ranks(count)), count);
    }
    /// Collective: returns the elements of all PEs in every rank.
    template <Sendable T>
    std::vector<T> all_gather(std::vector<T> own_elements, std::size_t count) const {
        if (!ranks_.has_several()) return own_elements;
        return in_order_of_pes(ranks_.all_gather(std::span<const T>(own_elements), sizes_of_ranks(count)), count);
    }
    /// Collective: inverse of gather().
    template <Sendable T, class Count>
    std::vector<T> scatter(std::vector<T> all_elements, const Count& count) const {
        if (!ranks_.has_several()) return all_elements;
        const std::vector<std::size_t> sizes = sizes_of_ranks(count);
        if (!ranks_.is_first()) {
            std::vector<T> own_elements(sizes[ranks_.rank()]);
            ranks_.receive(0, std::span(own_elements));
            return own_elements;
        }
        const std::vector<std::size_t> starts = starts_of_pes(count);
        const auto elements_of = [&](std::uint32_t rank) {
            std::vector<T> elements;
            for (const std::uint32_t pe : pes_of_[rank])
                elements.insert(elements.end(), all_elements.begin() + std::ptrdiff_t(starts[pe]),
                                all_elements.begin() + std::ptrdiff_t(starts[pe + 1]));
            return elements;
        };
        for (std::uint32_t rank = 1; rank < ranks_.count(); ++rank)
            ranks_.send(rank, std::span<const T>(elements_of(rank)));
        return elements_of(0);
    }

  private:
    template <class Count>
    static std::size_t count_of(const Count& count, std::uint32_t pe) {
        if constexpr (std::is_invocable_v<Count, std::uint32_t>)
            return count(pe);
        else
            return count;
    }
    template <class Count>
    std::vector<std::size_t> sizes_of_ranks(const Count& count) const {
        std::vector<std::size_t> sizes(pes_of_.size());
        for (std::uint32_t pe = 0; pe < all(); ++pe) sizes[rank_of_[pe]] += count_of(count, pe);
        return sizes;
    }
    template <class Count>
    std::vector<std::size_t> starts_of_pes(const Count& count) const {
        std::vector<std::size_t> starts = {0};
        for (std::uint32_t pe = 0; pe < all(); ++pe) starts.push_back(starts.back() + count_of(count, pe));
        return starts;
    }
    template <class T, class Count>
    std::vector<T> in_order_of_pes(const std::vector<T>& by_rank, const Count& count) const {
        std::vector<T> by_pe(by_rank.size());
        if (by_rank.empty()) return by_pe;
        const std::vector<std::size_t> starts = starts_of_pes(count);
        auto source = by_rank.begin();
        for (const std::vector<std::uint32_t>& pes : pes_of_)
            for (const std::uint32_t pe : pes) {
                const auto end = source + std::ptrdiff_t(starts[pe + 1] - starts[pe]);
                std::copy(source, end, by_pe.begin() + std::ptrdiff_t(starts[pe]));
                source = end;
            }
        return by_pe;
    }

    Ranks& ranks_;
    std::vector<std::uint32_t> rank_of_, slot_of_;
    std::vector<std::vector<std::uint32_t>> pes_of_;
};

}  // namespace raya
