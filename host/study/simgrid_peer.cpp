#include "host/study/simgrid_peer.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <system_error>

#include "host/files/program.hpp"
#include "host/files/whole_file.hpp"
#include "host/torus/simgrid_files.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

// A folder of its own, gone with all in it at the end.
struct TemporaryFolder {
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "raya-simgrid-XXXXXX").string();
        if (!mkdtemp(name.data())) throw PeerFailure("no folder for temporary files can be made: " + name);
        path = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    fs::path path;
};

}  // namespace

SimgridAnswer simgrid_answer(const std::string& printed) {
    std::istringstream words(printed);
    std::string finish, delivered;
    SimgridAnswer answer;
    words >> finish >> answer.finish_ms >> delivered >> answer.delivered;
    if (!words || finish != "finish_ms" || delivered != "delivered")
        throw PeerFailure("simgrid_replay: it does not tell its time");
    return answer;
}

SimgridAnswer ask_simgrid(const fs::path& program, const raya_torus& torus, const History& history,
                          const AsyncMachine& machine) {
    const TemporaryFolder folder;
    const std::string platform = folder.path / "platform.xml", replay = folder.path / "replay.txt";
    write_whole_file(platform, simgrid_platform(torus, machine));
    write_whole_file(replay, simgrid_replay(torus, history, machine));
    const ProgramRun run = run_program({program.string(), platform, replay, "--log=root.thres:error"});
    if (run.succeeded()) return simgrid_answer(run.out);
    if (run.not_started != 0) throw PeerFailure(std::generic_category().message(run.not_started));
    const std::string words = last_line(run.err);
    throw PeerFailure(words.empty() ? ending_text(run.status) : words);
}

}  // namespace raya
