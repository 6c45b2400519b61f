// raya generate: writes procedural scenes.
#include "host/scene/generate.hpp"

#include <fmt/core.h>

#include <memory>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/scene/nff.hpp"

namespace raya {
namespace {

struct GenerateOptions {
    std::string output;
    int level = 4, sphere_count = 0, triangles = 100'000;
    std::uint32_t cylinders = 12, wheels = 4;  // number of each along an edge of the cube
    std::string voxels = "4x4x4";
    std::uint64_t seed = 1;
};

template <class Make>
void write_scene(const GenerateOptions& options, Make&& make) {
    ProgressBar bar(true, "generating");
    const Scene scene = make();
    bar.stage("writing");
    write_whole_file(options.output, nff_pieces(scene));
}

void write_terrain(const GenerateOptions& options) {
    if (!options.output.ends_with(".ply"))
        return write_scene(options, [&] { return generate_terrain(options.triangles, options.seed); });
    const ProgressBar bar(true, "writing");
    write_whole_file(options.output, terrain_ply(options.triangles, options.seed));
}

CLI::App* add_generator(CLI::App& command, GenerateOptions& options, const std::string& name, const std::string& help,
                        const std::vector<ExampleText>& examples,
                        const std::string& file_help = "NFF file to write; -: stdout") {
    CLI::App* generator = command.add_subcommand(name, help);
    add_examples(*generator, examples);
    generator->option_defaults()->group("Scene");
    const OptionGroup group(*generator, kFiles);
    add_file(*generator, FileUse::kWritten, "-o,--output SCENE.nff", options.output, file_help)->required();
    return generator;
}

template <class Value>
void add_number(CLI::App& generator, const std::string& name, Value& value, const std::string& help) {
    add_value(generator, name + " N", value, help)->capture_default_str();
}

void add_terrain(CLI::App& command, const std::shared_ptr<GenerateOptions>& options) {
    CLI::App* terrain = add_generator(
        command, *options, "terrain", "A height field of N triangles, for large scenes",
        {{"raya generate terrain -o terrain.nff", "100,000 triangles"},
         {"raya generate terrain --triangles 10000000 -o terrain.ply", "Ten million triangles, as binary PLY"}},
        "File to write, binary PLY if its name ends in .ply, else NFF; -: stdout, as NFF");
    add_number(*terrain, "--triangles", options->triangles, "Number N of triangles, 1..20000000");
    add_number(*terrain, "--seed", options->seed, "Seed of the random numbers, 0..2^64-1");
    terrain->callback([options] { write_terrain(*options); });
}

}  // namespace

void add_generate_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("generate", "Generate a scene");
    add_examples(*command, {{"raya generate balls --level 2 -o balls.nff", "Generate SPD's balls with 91 spheres"},
                            {"raya generate random 500 -o - | raya render - --size 128 -o random.png",
                             "Generate and render a scene without a file"}});
    command->require_subcommand(1);
    const auto options = std::make_shared<GenerateOptions>();

    CLI::App* balls =
        add_generator(*command, *options, "balls", "SPD's sphereflake: 1 + 9 + ... + 9^L spheres above a square",
                      {{"raya generate balls -o balls.nff", "SPD's default size: 7,381 spheres"},
                       {"raya generate balls --level 1 -o ten.nff", "A sphere surrounded by nine"}});
    add_number(*balls, "--level", options->level,
               "Number L of levels below the largest sphere, 0..6 (4: 7,381 spheres)");
    balls->callback([options] { write_scene(*options, [&] { return generate_balls(options->level); }); });

    CLI::App* lattice =
        add_generator(*command, *options, "lattice", "SPD's lattice: (N + 1)^3 spheres joined by cylinders, in a cube",
                      {{"raya generate lattice -o lattice.nff", "SPD's default size: 2,197 spheres, 6,084 cylinders"},
                       {"raya generate lattice --size 2 -o small.nff", "27 spheres, 54 cylinders"}});
    add_number(*lattice, "--size", options->cylinders,
               "Number N of cylinders along an edge, 1..64 (SPD's default 12: 2,197 spheres, 6,084 cylinders)");
    lattice->callback(
        [options] { write_scene(*options, [&] { return generate_lattice(static_cast<int>(options->cylinders)); }); });

    CLI::App* gears =
        add_generator(*command, *options, "gears", "N^3 meshing gear wheels with outlines of 144 vertices, in a cube",
                      {{"raya generate gears -o gears.nff", "As many triangles as SPD's gears: 36,610"},
                       {"raya generate gears --size 1 -o wheel.nff", "One wheel"}});
    add_number(
        *gears, "--size", options->wheels,
        "Number N of wheels along an edge, 1..16 (4: 9,345 polygons = 36,610 triangles, as many as SPD's gears)");
    gears->callback(
        [options] { write_scene(*options, [&] { return generate_gears(static_cast<int>(options->wheels)); }); });

    CLI::App* uniform = add_generator(
        *command, *options, "uniform", "N matt spheres, evenly distributed over the voxels of a cube",
        {{"raya generate uniform 64 --voxels 4x4x4 -o even.nff", "One sphere in each of 64 voxels"},
         {"raya generate uniform 1000 --voxels 2x2x1 -o slab.nff", "250 spheres in each of four voxels"}});
    add_value(*uniform, "N COUNT", options->sphere_count, "Number of spheres, 1..20000000")->required();
    add_value(*uniform, "--voxels XxYxZ", options->voxels,
              "Number of voxels along x, y and z, 1..256 each, at most 1,048,576 in total")
        ->required();
    uniform->callback([options] {
        const auto sides = parse_three_sides("--voxels", options->voxels, fmt::format("1..{} each", kMaxVoxelsPerAxis));
        write_scene(*options, [&] {
            return generate_uniform(options->sphere_count, {static_cast<int>(sides[0]), static_cast<int>(sides[1]),
                                                            static_cast<int>(sides[2])});
        });
    });

    CLI::App* random = add_generator(*command, *options, "random", "N spheres at random positions in a cube",
                                     {{"raya generate random 500 -o random.nff", "500 spheres"},
                                      {"raya generate random 500 --seed 2 -o other.nff", "500 other spheres"}});
    add_value(*random, "N COUNT", options->sphere_count, "Number of spheres, 1..20000000")->required();
    add_number(*random, "--seed", options->seed, "Seed of the random numbers, 0..2^64-1");
    random->callback(
        [options] { write_scene(*options, [&] { return generate_random(options->sphere_count, options->seed); }); });

    add_terrain(*command, options);

    CLI::App* cluster =
        add_generator(*command, *options, "cluster",
                      "Seven spheres above a floor, as in Kohata & Ito's scene of high and uneven cost",
                      {{"raya generate cluster -o cluster.nff", "The scene of raya study cluster"},
                       {"raya generate cluster --seed 2 -o other.nff", "Another scene of the same kind"}});
    add_number(*cluster, "--seed", options->seed, "Seed of the random numbers, 0..2^64-1");
    cluster->callback([options] { write_scene(*options, [&] { return generate_cluster(options->seed); }); });

    CLI::App* centre = add_generator(
        *command, *options, "centre", "The main scene of the studies: glass and mirror spheres clustered at the centre",
        {{"raya generate centre -o centre.nff", "The scene in scenes/centre.nff"},
         {"raya generate centre -o - | raya info -", "Print the scene's objects and the machines that can hold them"}});
    centre->callback([options] { write_scene(*options, [&] { return generate_centre(); }); });
}

}  // namespace raya
