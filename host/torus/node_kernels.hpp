// The kernels that the nodes of the torus run, with their parameters in the order of the files in kernels/torus/.
#pragma once
#include <cstdint>

#include "host/cl/kernels.hpp"
#include "kernels/shared/traffic.h"

namespace raya {

/// Room that packets ask for before they are accepted or treated (kernels/shared/traffic.h).
enum class Room : cl_uint {
    kWholeTree,  // for all that a ray's tree may turn into
    kTight       // as little as can be
};

namespace node_kernels {

using Words = const Buffer<std::uint32_t>&;  // of all nodes, where each one's start, where boxes have been sent
using Run = const Buffer<raya_run>&;
using First = Uint<"first_node">;        // slot of the first node that a launch is for
using Work = Uint<"work">;               // of a node in a launch
using Again = Uint<"again">;             // 1: a launch goes on with what the last one has left
using Own = LocalMemory<std::uint32_t>;  // of one node
using Queues = Buffer<raya_packet>&;
using Boxes = Buffer<std::uint32_t>&;
using Returns = Buffer<raya_head>&;  // at the root
using Status = Buffer<std::uint32_t>&;
using Counters = Buffer<std::uint64_t>&;
using Treated = Buffer<raya_treated>&;

using Inject = DescribedKernel<"torus/inject.cl", "inject", Words, Words, Run, First, Work, Again, Own, Queues, Status,
                               Counters, Counters, Counters>;
using TraceVoxel = DescribedKernel<"torus/trace_voxel.cl", "trace_voxel", Words, Words, Run, First, Room, Work, Again,
                                   Own, Queues, Status, Counters, Counters, Counters, Treated>;
using Route = DescribedKernel<"torus/route.cl", "route", Words, Words, Run, First, Work, Again, Own, Queues, Boxes,
                              Boxes, Returns, Status, Counters>;
using Accept = DescribedKernel<"torus/accept.cl", "accept", Words, Words, Run, Room, Uint<"turn">, First, Words, Words,
                               Words, Work, Again, Own, Queues, Boxes, Boxes, Boxes, Returns, Status, Counters>;

}  // namespace node_kernels
}  // namespace raya
