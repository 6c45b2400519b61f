// Ensembles: how many views, what verdicts follow, and that a view of a number is the same wherever it is asked for.
#include <catch2/catch.hpp>
#include <random>

#include "host/scene/random_view.hpp"
#include "host/study/ensemble.hpp"

namespace raya {
namespace {

TEST_CASE("64 views of scenes like the paper's, fewer of larger images and more objects", "[ensemble]") {
    Scene scene;
    scene.spheres.resize(23);
    CHECK(view_count(scene, 256) == 64);
    CHECK(view_count(scene, 17) == 64);
    CHECK(view_count(scene, 512) == 22);  // 2^27 / (2^18 * 23)
    CHECK(view_count(scene, 1024) == 5);
    CHECK(view_count(scene, 4096) == 4);
    CHECK(view_count(scene, 256, 16) == 16);
    CHECK(view_count(scene, 4096, 2) == 2);
    scene.spheres.resize(100'000);
    CHECK(view_count(scene, 256) == 4);
}

TEST_CASE("verdicts follow what was seen and its contrary", "[ensemble]") {
    using enum ClaimVerdict;
    CHECK(verdict_of(true, false) == kReproduced);
    CHECK(verdict_of(false, true) == kNotReproduced);
    CHECK(verdict_of(false, false) == kCannotTell);
    CHECK(verdict_of(true, true) == kCannotTell);
    std::vector<double> pictures(kPredictable - 1, 1.0);
    pictures[3] = 2;
    CHECK(verdict_among(1.5, pictures) == kReproduced);
    CHECK(verdict_among(2, pictures) == kReproduced);
    CHECK(verdict_among(2.1, pictures) == kCannotTell);
    pictures.push_back(1);
    CHECK(verdict_among(2, pictures) == kReproduced);  // 39: the least and the largest still
    CHECK(verdict_among(2.1, pictures) == kNotReproduced);
    CHECK(verdict_among(0.9, pictures) == kNotReproduced);
    for (int i = 0; i < 40; ++i) pictures.push_back(1);
    CHECK(verdict_among(1.5, pictures) == kNotReproduced);  // 79: the second largest
    CHECK(verdict_among(1, pictures) == kReproduced);
}

TEST_CASE("a difference that is there is told, one that is not is mostly not", "[ensemble]") {
    std::mt19937 random(5);
    std::normal_distribution<double> draw(0, 1);
    int told = 0, of_none = 0;
    for (int i = 0; i < 400; ++i) {
        std::vector<double> some, none;
        for (int n = 0; n < 64; ++n) some.push_back(1 + draw(random)), none.push_back(draw(random));
        told += estimate_of(some, each_of(16)).low() > 0;
        const Estimate zero = mean_of_each(
            none, [](double x) { return x; }, each_of(16));
        of_none += zero.low() > 0 || zero.high() < 0;
    }
    CHECK(told == 400);
    CHECK(of_none <= 8);  // 400 * 0.05 / 16 = 1.25
}

TEST_CASE("an ensemble has the scene's own picture and its views, in order", "[ensemble]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0), other(session, 0);
    const LabelledScene scene = embedded_scene("spheres");
    const Ensemble ensemble = ensemble_of(lab, scene, 16, AntialiasMethod::kNone, 5);
    REQUIRE(ensemble.views.size() == 5);
    CHECK(ensemble.picture->trace.cycles == other.costs(scene, 16).trace.cycles);
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        CHECK(ensemble.views[seed - 1]->trace.cycles ==
              other.costs({"view", random_view(scene.scene, seed)}, 16).trace.cycles);
    CHECK(ensemble_of(lab, scene, 16, AntialiasMethod::kNone, 3).views[2] == ensemble.views[2]);  // rendered once
    CHECK(with_interval(estimate_of({1, 3})) == "2.000 +- 12.706");
    CHECK(with_interval(estimate_of({1})) == "1.000");
}

}  // namespace
}  // namespace raya
