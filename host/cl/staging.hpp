// Pinned memory of the driver's, through which transfers go where the device's memory is apart from the host's: a GPU
// copies to and from it at its bus's full speed, and without making the host wait.
#pragma once
#include <array>
#include <cstddef>

#include "host/cl/opencl.hpp"

namespace raya {

/// Two halves that are used in turn: while the device copies one, the host fills or empties the other.
class Staging {
  public:
    static constexpr std::size_t kHalfBytes = 4u << 20;

    /// Takes the memory; both outlive this. cl::Error.
    Staging(const cl::Context& context, const cl::CommandQueue& queue);
    ~Staging();
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;

    struct Half {
        cl::Buffer buffer;
        std::byte* memory = nullptr;  // kHalfBytes
        cl::Event last;               // command that uses it; none at first

        /// Waits for that command. cl::Error where it has failed.
        void wait();
    };

    /// The half whose turn it is, once the command before has left it.
    Half& next();

  private:
    const cl::CommandQueue& queue_;
    std::array<Half, 2> halves_;
    std::size_t turn_ = 0;
};

}  // namespace raya
