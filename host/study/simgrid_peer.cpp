#include "host/study/simgrid_peer.hpp"

#include <sstream>
#include <system_error>

#include "host/base/temporary_folder.hpp"
#include "host/base/whole_file.hpp"
#include "host/study/peer.hpp"
#include "host/torus/simgrid_files.hpp"

namespace raya {

SimgridAnswer simgrid_answer(const std::string& printed) {
    std::istringstream words(printed);
    std::string finish, delivered;
    SimgridAnswer answer;
    words >> finish >> answer.finish_ms >> delivered >> answer.delivered;
    if (!words || finish != "finish_ms" || delivered != "delivered")
        throw PeerFailure("simgrid_replay: it does not tell its time");
    return answer;
}

SimgridAnswer ask_simgrid(const std::filesystem::path& program, const raya_torus& torus, const History& history,
                          const AsyncMachine& machine) {
    try {
        const TemporaryFolder folder("raya-simgrid");
        const std::string platform = folder / "platform.xml", replay = folder / "replay.txt";
        write_whole_file(platform, simgrid_platform(torus, machine));
        write_whole_file(replay, simgrid_replay(torus, history, machine));
        return simgrid_answer(peer_output({program.string(), platform, replay, "--log=root.thres:error"}));
    } catch (const std::system_error& error) {
        throw PeerFailure(error.what());
    }
}

}  // namespace raya
