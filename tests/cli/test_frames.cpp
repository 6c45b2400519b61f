// render --frames: frame numbers, cameras, and the frames that are rendered again.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <optional>
#include <thread>

#include "host/base/whole_file.hpp"
#include "host/cli/camera_path.hpp"
#include "host/cli/frame_options.hpp"
#include "host/cli/frame_record.hpp"
#include "host/error.hpp"
#include "host/scene/nff.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

TEST_CASE("parse_frames, numbered: read ranges and add the frame's number to file names", "[cli][frames]") {
    CHECK(parse_frames("1:24") == FrameRange{1, 24, 1, 24});
    CHECK(parse_frames("0:0") == FrameRange{0, 0, 0, 0});
    CHECK(parse_frames("5:8/24") == FrameRange{5, 8, 1, 24});
    for (const char* text : {"", "1", ":", "1:", ":2", "2:1", "1:2:3", "-1:2", "1:1000000", "0:3/8", "5:9/8", "1:2/",
                             "1/2:3", "1.5:2", " 1:2", "1:2x"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_frames(text), UserError);
    }
    CHECK(numbered("a/turn.png", 7) == "a/turn-0007.png");
    CHECK(numbered("turn", 12345) == "turn-12345");
    CHECK(numbered("a.b/turn.tar.exr", 1) == "a.b/turn.tar-0001.exr");
    CHECK(numbered("", 1).empty());
}

TEST_CASE("--turn: the camera depends on a frame's position in the sequence, not on the range", "[cli][frames]") {
    const View view = read_nff(scene_file("centre")).view;
    const auto frames = [&](const char* range) { return frames_of({range, "", 360.0}, view); };
    const std::vector<Frame> all_frames = frames("1:24"), three_frames = frames("7:9/24"), from_zero = frames("0:23");
    REQUIRE(all_frames.size() == 24);
    REQUIRE(three_frames.size() == 3);
    CHECK(all_frames.front().view == view);
    for (std::size_t i = 0; i < three_frames.size(); ++i) {
        CHECK(three_frames[i].number == 7 + i);
        CHECK(three_frames[i].view == all_frames[6 + i].view);
    }
    for (std::size_t i = 0; i < all_frames.size(); ++i) CHECK(from_zero[i].view == all_frames[i].view);
    const Vec3 arm = view.from - view.at, opposite = all_frames[12].view.from - view.at;
    CHECK((opposite + arm).dot(view.up) == Approx(2 * arm.dot(view.up)));
    CHECK((opposite - (view.up * (2 * arm.dot(view.up) / view.up.dot(view.up)) - arm)).length() < 1e-12);
}

TEST_CASE("--camera-path: each line is a camera; the error for a wrong line has the line's number", "[cli][frames]") {
    const ScratchFolder folder;
    const std::string path = folder / "path.txt";
    View view;
    view.from = {9, 9, 9};
    write_whole_file(
        path, "# a walk\n\nfrom 1,2,3 at 0,0,0 up 0,0,1 angle 40\n  angle 30   # closer\r\nat 5,5,5\tfrom 1,1,1");
    const std::vector<View> cameras = read_camera_path(path, view);
    REQUIRE(cameras.size() == 3);
    CHECK(cameras[0].from == Vec3(1, 2, 3));
    CHECK(cameras[0].up == Vec3(0, 0, 1));
    CHECK(cameras[1].angle_degrees == 30);
    CHECK(cameras[1].from == view.from);
    CHECK(cameras[2].at == Vec3(5, 5, 5));
    const auto numbers = [&](const char* range) {
        std::vector<std::uint32_t> all;
        for (const Frame& frame : frames_of({range, path, {}}, view)) all.push_back(frame.number);
        return all;
    };
    CHECK(numbers("") == std::vector<std::uint32_t>{1, 2, 3});
    CHECK(numbers("2:3") == std::vector<std::uint32_t>{2, 3});
    CHECK_THROWS_WITH(numbers("2:4"), Catch::Contains("has 3 cameras"));
    CHECK_THROWS_AS(numbers("0:2"), UserError);
    const std::pair<const char*, const char*> wrong_lines[] = {
        {"from 1,2", "line 1: --from 1,2: must be"},
        {"\nfrom", "line 2: from has no value"},
        {"to 1,2,3", "line 1: 'to': must be from"},
        {"angle x", "line 1: angle 'x': must be a number"},
        {"angle 180", "line 1: --angle 180"},
        {"from 1,2,3 at 1,1,1 from 4,5,6", "line 1: 'from' is given twice"},
        {"\nangle 3 angle 3", "line 2: 'angle' is given twice"},
        {"", "no camera"},
        {"from 1,1,1 at 1,1,1", "line 1: --from 1,1,1 --at 1,1,1"}};
    for (const auto& [text, message] : wrong_lines) {
        CAPTURE(text);
        write_whole_file(path, text);
        CHECK_THROWS_WITH(read_camera_path(path, view), Catch::Contains(message));
    }
    CHECK_THROWS_WITH(read_camera_path(folder / "none.txt", view), Catch::Contains("--camera-path"));
    // Messages about long texts are short. A single byte 0xbf is not valid UTF-8.
    for (const char* name : {"", "from ", "angle ", "from 1,2,", "up \xbf"}) {
        write_whole_file(path, name + std::string(5'000'000, name[0] == 'u' ? '\xbf' : '1') + "x\n");
        try {
            read_camera_path(path, view);
            FAIL("accepted");
        } catch (const UserError& error) {
            CHECK(std::string(error.what()).size() < 300 + path.size());
        }
    }
    write_whole_file(path,
                     "\xEF\xBB\xBF"
                     "from 0,0,9\n");
    CHECK(read_camera_path(path, view)[0].from == Vec3(0, 0, 9));
}

/// A sequence of small frames in a new folder.
class Sequence {
  public:
    Arguments arguments(const Arguments& extra_options = {}) const {
        Arguments all = {"render", scene_file("centre"), "--size", "16x12", "--pes", "16", "--lanes", "4",
                         "-o",     folder_ / "t.ppm",    "--turn", "360"};
        all.insert(all.end(), extra_options.begin(), extra_options.end());
        return all;
    }

    /// Renders the sequence with the extra options and returns the number of frames that raya rendered.
    int rendered_frames(const Arguments& extra_options) const {
        const RunOutcome run = run_raya(arguments(extra_options));
        INFO(run.describe());
        REQUIRE(run.code == 0);
        CHECK(run.messages().empty());
        const std::size_t position = run.out.find(" frames, ");
        REQUIRE(position != std::string::npos);
        return std::stoi(run.out.substr(position + 9));
    }

    std::string file(const std::string& name) const { return folder_ / name; }
    const ScratchFolder& folder() const { return folder_; }
    std::string image_bytes(int frame) const { return file_contents(file(fmt::format("t-{:04}.ppm", frame))); }
    Document record() const { return Document::parse(file_contents(file("t-frames.json"))); }

  private:
    ScratchFolder folder_;
};

TEST_CASE("render --frames: frames equal single renders, and existing frames are skipped", "[cli][frames]") {
    const Sequence sequence;
    REQUIRE(sequence.rendered_frames({"--frames", "1:4"}) == 4);
    CHECK(sequence.folder().entries() == 5);
    Arguments single = sequence.arguments();
    single.resize(single.size() - 2);  // without --turn
    REQUIRE(run_raya(single).code == 0);
    CHECK((file_contents(sequence.file("t.ppm")) == sequence.image_bytes(1)));
    CHECK((sequence.image_bytes(2) != sequence.image_bytes(1)));
    const Document record = sequence.record();
    REQUIRE(record["frames"].size() == 4);
    CHECK(record["frames"][0]["number"] == 1);
    CHECK(record["frames"][1]["imbalance"] > 0);

    CHECK(sequence.rendered_frames({"--frames", "1:4"}) == 0);
    CHECK(sequence.rendered_frames({"--frames", "2:3/4"}) == 0);
    CHECK(sequence.rendered_frames({"--frames", "0:3"}) == 4);  // another sequence: its frames have other cameras
    CHECK(sequence.rendered_frames({"--frames", "1:4"}) == 3);  // frames 1 to 3 had been replaced, frame 4 had not
    CHECK(sequence.record()["frames"].size() == 5);
    CHECK(sequence.rendered_frames({"--frames", "1:8"}) == 7);  // only frame 1 has the same camera
}

TEST_CASE("render --frames --machine grande: records the load of the counted events", "[cli][frames]") {
    const Sequence sequence;
    const Arguments options = {"--machine", "grande", "--accel", "bvh"};
    Arguments frames = options, single = sequence.arguments(options);
    frames.insert(frames.end(), {"--frames", "1:2"});
    single.insert(single.end(), {"--report", sequence.file("r.json")});
    std::erase(single, "--turn");
    std::erase(single, "360");
    REQUIRE(sequence.rendered_frames(frames) == 2);
    REQUIRE(run_raya(single).code == 0);
    const Document report = Document::parse(file_contents(sequence.file("r.json")));
    CHECK(sequence.record()["frames"][0]["imbalance"] == report["load"]["imbalance"]);
}

TEST_CASE("render --frames: renders again the frames whose file or settings changed, and only those", "[cli][frames]") {
    const Sequence sequence;
    const Arguments frames = {"--frames", "1:3"};
    REQUIRE(sequence.rendered_frames(frames) == 3);
    const std::string second = sequence.image_bytes(2);
    write_whole_file(sequence.file("t-0002.ppm"), "P6 1 1 255\nabc");
    CHECK(sequence.rendered_frames(frames) == 1);
    CHECK((sequence.image_bytes(2) == second));
    fs::remove(sequence.file("t-0003.ppm"));
    CHECK(sequence.rendered_frames(frames) == 1);
    for (const Arguments& changed :
         {Arguments{"--bounces", "2"}, Arguments{"--exposure", "1"}, Arguments{"--from", "5,-9,4"},
          Arguments{"--light", "1,1,9"}, Arguments{"--mapping", "rows"}, Arguments{"--strict"},
          Arguments{"--report", sequence.file("t.json")}, Arguments{"--cost", sequence.file("c.pfm")}}) {
        Arguments arguments = frames;
        arguments.insert(arguments.end(), changed.begin(), changed.end());
        CAPTURE(changed.front());
        CHECK(sequence.rendered_frames(arguments) == 3);
        CHECK(sequence.rendered_frames(arguments) == 0);
    }
    CHECK(fs::exists(sequence.file("t-0002.json")));
    CHECK(fs::exists(sequence.file("c-0003.pfm")));
    const Document report = Document::parse(file_contents(sequence.file("t-0002.json")));
    CHECK(report["image"]["file"] == sequence.file("t-0002.ppm"));
}

TEST_CASE("render --frames: renders again if the content of the scene file changed", "[cli][frames]") {
    const Sequence sequence;
    const std::string scene = sequence.file("scene.nff");
    fs::copy_file(scene_file("spheres"), scene);
    Arguments arguments = sequence.arguments({"--frames", "1:2"});
    arguments[1] = scene;
    const auto out = [&] { return run_raya(arguments).out; };
    CHECK_THAT(out(), Catch::Contains("2 frames, 2 rendered"));
    CHECK_THAT(out(), Catch::Contains("2 frames, 0 rendered"));
    fs::remove(scene);
    fs::copy_file(scene_file("centre"), scene);
    CHECK_THAT(out(), Catch::Contains("2 frames, 2 rendered"));
}

TEST_CASE("render --frames: with --kernel-dir every frame is rendered again", "[cli][frames]") {
    const Sequence sequence;
    const Arguments arguments = {"--frames", "1:2", "--kernel-dir", RAYA_SOURCE_DIR "/kernels"};
    CHECK(sequence.rendered_frames(arguments) == 2);
    CHECK(sequence.rendered_frames(arguments) == 2);
}

TEST_CASE("render --frames: an interrupted sequence resumes with the missing frames", "[cli][frames]") {
    const Sequence complete;
    const Arguments frames = {"--frames", "1:60"};
    REQUIRE(complete.rendered_frames(frames) == 60);
    // Interrupts the render, each time after a longer delay, until a frame exists.
    std::optional<Sequence> stopped;
    int missing_frames = 60;
    for (int ms = 60; missing_frames == 60 && ms <= 5000; ms += ms / 2) {
        stopped.emplace();
        const RunOutcome run = run_raya(stopped->arguments(frames), {.signal = SIGINT, .signal_after_ms = ms});
        INFO(run.describe());
        REQUIRE(run.code == 128 + SIGINT);
        missing_frames = stopped->rendered_frames(frames);
    }
    REQUIRE((missing_frames > 0 && missing_frames < 60));
    for (int frame = 1; frame <= 60; ++frame) {
        CAPTURE(frame);
        CHECK((stopped->image_bytes(frame) == complete.image_bytes(frame)));
    }
}

TEST_CASE("render --frames --machine torus: existing frames are skipped", "[cli][frames]") {
    const Sequence sequence;
    const Arguments torus = {"--frames", "1:2", "--machine", "torus", "--nodes", "2x2x1"};
    Arguments arguments = sequence.arguments(torus);
    std::erase_if(arguments, [](const std::string& argument) { return argument == "--pes"; });
    arguments.erase(std::find(arguments.begin(), arguments.end(), "16"));
    const auto out = [&] { return run_raya(arguments).out; };
    CHECK_THAT(out(), Catch::Contains("2 frames, 2 rendered"));
    CHECK_THAT(out(), Catch::Contains("2 frames, 0 rendered"));
}

TEST_CASE("FrameRecord: contains the frames of all processes that write it concurrently", "[cli][frames]") {
    const ScratchFolder folder;
    const std::string file = folder / "t-frames.json";
    constexpr std::uint32_t kProcesses = 8, kFrames = 12;
    std::vector<pid_t> children;
    for (std::uint32_t process = 0; process < kProcesses; ++process) {
        children.push_back(::fork());
        REQUIRE(children.back() >= 0);
        if (children.back() > 0) continue;
        FrameRecord record(file);
        for (std::uint32_t i = 0; i < kFrames; ++i) {
            record.add({process * kFrames + i, "settings", "pixels", 1, 1, {}}, {});
            record.write();
        }
        ::_exit(0);
    }
    for (const pid_t child : children) {
        int status = -1;
        ::waitpid(child, &status, 0);
        CHECK(status == 0);
    }
    const FrameRecord record(file);
    for (std::uint32_t number = 0; number < kProcesses * kFrames; ++number) {
        CAPTURE(number);
        CHECK(record.find(number, "settings", {}) != nullptr);
    }
    CHECK(folder.entries() == 1);  // no lock file is left
}

TEST_CASE("FrameRecord: keeps frames that other processes wrote meanwhile, and the later of two entries for a frame",
          "[cli][frames]") {
    const ScratchFolder folder;
    FrameRecord first_record(folder / "t-frames.json"), second_record(folder / "t-frames.json");
    first_record.add({1, "settings 1", "pixels", 1, 1, {}}, {});
    first_record.add({2, "settings 1", "pixels", 1, 1, {}}, {});
    first_record.write();
    second_record.add({2, "settings 2", "pixels", 1, 1, {}}, {});
    second_record.write();
    for (const FrameRecord& record : {second_record, FrameRecord(folder / "t-frames.json")}) {
        CHECK(record.find(1, "settings 1", {}) != nullptr);
        CHECK(record.find(2, "settings 2", {}) != nullptr);  // the entry that was written last
    }
}

TEST_CASE("render --frames: several processes share a folder, and the record in it has all frames", "[cli][frames]") {
    const Sequence sequence;
    std::vector<std::thread> processes;
    std::array<int, 3> codes{};
    for (int part = 0; part < 3; ++part)
        processes.emplace_back([&, part] {
            const std::string range = fmt::format("{}:{}/6", 2 * part + 1, 2 * part + 2);
            codes[static_cast<std::size_t>(part)] = run_raya(sequence.arguments({"--frames", range})).code;
        });
    for (std::thread& process : processes) process.join();
    CHECK(codes == std::array<int, 3>{});
    CHECK(sequence.record()["frames"].size() == 6);
    CHECK(sequence.rendered_frames({"--frames", "1:6"}) == 0);
}

TEST_CASE("render --frames: refuses invalid sequences before rendering", "[cli][frames]") {
    const ScratchFolder outputs;
    const std::string image = outputs / "t.ppm";
    const auto refused = [&](const Arguments& options, const Arguments& message) {
        Arguments arguments = {"render", scene_file("centre"), "-o", image, "--size", "8"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        check_refused(outputs, arguments, 2, message);
    };
    refused({"--frames", "1:4"}, {"--frames 1:4", "--turn"});
    refused({"--turn", "90"}, {"--turn 90", "--frames"});
    refused({"--frames", "4:1", "--turn", "90"}, {"--frames 4:1", "A:B"});
    refused({"--frames", "1:4", "--turn", "1e9"}, {"--turn", "360000"});
    refused({"--frames", "1:4", "--turn", "nan"}, {"--turn"});
    refused({"--frames", "1:4", "--camera-path", "p", "--turn", "90"}, {"leave out one of them"});
    refused({"--frames", "1:4", "--camera-path", outputs / "none"}, {"--camera-path", "none"});
    for (const Arguments& single :
         {Arguments{"--page", outputs / "p.html"}, Arguments{"--trace", outputs / "t.json"}, Arguments{"--profile"},
          Arguments{"--machine", "torus", "--packets", outputs / "p.csv.gz"}}) {
        Arguments options = {"--frames", "1:4", "--turn", "90"};
        options.insert(options.end(), single.begin(), single.end());
        refused(options, {"only for a single image"});
    }
    check_refused(outputs, {"render", scene_file("centre"), "-o", "-", "--frames", "1:4", "--turn", "90"}, 2,
                  {"--output -", "several files"});
    for (const char* option : {"--report", "--cost", "--mask"})
        refused({"--frames", "1:4", "--turn", "90", option, "-"},
                {std::string(option) + " -: --frames writes several files"});
    const ScratchFolder other_folder;
    write_whole_file(other_folder / "t-frames.json", "{\"kind\": \"mine\"}");
    const RunOutcome run =
        run_raya({"render", scene_file("centre"), "-o", other_folder / "t.ppm", "--frames", "1:4", "--turn", "90"});
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Catch::Contains("not a record of frames"));
    CHECK(other_folder.entries() == 1);
}

}  // namespace
}  // namespace raya
