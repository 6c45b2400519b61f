// raya generate: writes procedural scenes.
#include "host/scene/generate.hpp"

#include <fmt/core.h>

#include <functional>
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
    int level = 4, sphere_count = 0;
    int cylinders = 12, wheels = 4;  // number of each along an edge of the cube
    std::string voxels = "4x4x4";
    std::uint64_t seed = 1;
};

Scene uniform_scene(const GenerateOptions& options) {
    const auto sides = parse_three_sides("--voxels", options.voxels, fmt::format("1..{} each", kMaxVoxelsPerAxis));
    return generate_uniform(options.sphere_count,
                            {static_cast<int>(sides[0]), static_cast<int>(sides[1]), static_cast<int>(sides[2])});
}

// The generators, each of which writes the scene that `make` returns.
class Generators {
  public:
    explicit Generators(CLI::App& command) : command_(command) {}

    GenerateOptions& options() { return *options_; }

    CLI::App& add(const std::string& name, const std::string& help, const std::vector<ExampleText>& examples,
                  const std::function<Scene(const GenerateOptions&)>& make) {
        CLI::App& generator = *command_.add_subcommand(name, help);
        add_examples(generator, examples);
        generator.option_defaults()->group("Scene");
        const OptionGroup group(generator, kFiles);
        add_file(generator, FileUse::kWritten, "-o,--output SCENE.nff", options_->output,
                 "NFF file to write; -: stdout")
            ->required();
        generator.callback([make, options = options_] {
            ProgressBar bar(true, "generating");
            const Scene scene = make(*options);
            bar.stage("writing");
            write_whole_file(options->output, write_nff(scene));
        });
        return generator;
    }

    void add_seed(CLI::App& generator) {
        add_value(generator, "--seed N", options_->seed, "Seed of the random numbers, 0..2^64-1")
            ->capture_default_str();
    }
    void add_count(CLI::App& generator) {
        add_value(generator, "N COUNT", options_->sphere_count, "Number of spheres, 1..20000000")->required();
    }

  private:
    CLI::App& command_;
    std::shared_ptr<GenerateOptions> options_ = std::make_shared<GenerateOptions>();
};

}  // namespace

void add_generate_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("generate", "Generate a scene");
    add_examples(*command, {{"raya generate balls --level 2 -o balls.nff", "Generate SPD's balls with 91 spheres"},
                            {"raya generate random 500 -o - | raya render - --size 128 -o random.png",
                             "Generate and render a scene without a file"}});
    command->require_subcommand(1);
    Generators generators(*command);

    CLI::App& balls = generators.add("balls", "SPD's sphereflake: 1 + 9 + ... + 9^L spheres above a square",
                                     {{"raya generate balls -o balls.nff", "SPD's default size: 7,381 spheres"},
                                      {"raya generate balls --level 1 -o ten.nff", "A sphere surrounded by nine"}},
                                     [](const GenerateOptions& o) { return generate_balls(o.level); });
    add_value(balls, "--level N", generators.options().level,
              "Number L of levels below the largest sphere, 0..6 (4: 7,381 spheres)")
        ->capture_default_str();

    CLI::App& lattice =
        generators.add("lattice", "SPD's lattice: (N + 1)^3 spheres joined by cylinders, in a cube",
                       {{"raya generate lattice -o lattice.nff", "SPD's default size: 2,197 spheres, 6,084 cylinders"},
                        {"raya generate lattice --size 2 -o small.nff", "27 spheres, 54 cylinders"}},
                       [](const GenerateOptions& o) { return generate_lattice(o.cylinders); });
    add_value(lattice, "--size N", generators.options().cylinders,
              "Number N of cylinders along an edge, 1..64 (SPD's default 12: 2,197 spheres, 6,084 cylinders)")
        ->capture_default_str();

    CLI::App& gears = generators.add("gears", "N^3 meshing gear wheels with outlines of 144 vertices, in a cube",
                                     {{"raya generate gears -o gears.nff", "As many triangles as SPD's gears: 36,610"},
                                      {"raya generate gears --size 1 -o wheel.nff", "One wheel"}},
                                     [](const GenerateOptions& o) { return generate_gears(o.wheels); });
    add_value(gears, "--size N", generators.options().wheels,
              "Number N of wheels along an edge, 1..16 (4: 9,345 polygons = 36,610 triangles, as many as SPD's gears)")
        ->capture_default_str();

    CLI::App& uniform = generators.add(
        "uniform", "N matt spheres, evenly distributed over the voxels of a cube",
        {{"raya generate uniform 64 --voxels 4x4x4 -o even.nff", "One sphere in each of 64 voxels"},
         {"raya generate uniform 1000 --voxels 2x2x1 -o slab.nff", "250 spheres in each of four voxels"}},
        uniform_scene);
    generators.add_count(uniform);
    add_value(uniform, "--voxels XxYxZ", generators.options().voxels,
              "Number of voxels along x, y and z, 1..256 each, at most 1,048,576 in total")
        ->required();

    CLI::App& random = generators.add("random", "N spheres at random positions in a cube",
                                      {{"raya generate random 500 -o random.nff", "500 spheres"},
                                       {"raya generate random 500 --seed 2 -o other.nff", "500 other spheres"}},
                                      [](const GenerateOptions& o) { return generate_random(o.sphere_count, o.seed); });
    generators.add_count(random);
    generators.add_seed(random);

    CLI::App& cluster =
        generators.add("cluster", "Seven spheres above a floor, as in Kohata & Ito's scene of high and uneven cost",
                       {{"raya generate cluster -o cluster.nff", "The scene of raya study cluster"},
                        {"raya generate cluster --seed 2 -o other.nff", "Another scene of the same kind"}},
                       [](const GenerateOptions& o) { return generate_cluster(o.seed); });
    generators.add_seed(cluster);
}

}  // namespace raya
