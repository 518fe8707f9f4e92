#include "trebsweep/job/job.hpp"

#include <fmt/format.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/config_file.hpp"
#include "trebsweep/job/key.hpp"

using namespace trebsweep;

namespace fs = std::filesystem;

namespace {

Job job_of(const std::string& text, const Overrides& overrides = {}) {
  return parse_job(text, "some/where/my.cfg", overrides);
}

Job read(const std::string& name) {
  const std::string path = SOURCE_DIR "/jobs/" + name;
  return parse_job(read_job_file(path), path, {});
}

/// A scene file that is removed on destruction.
struct SceneFile {
  fs::path path;

  SceneFile(const std::string& name, const std::string& keys) : path(TEST_DIR "/" + name) {
    std::ofstream(path) << "[scene]\n" << keys;
  }
  ~SceneFile() { fs::remove(path); }
};

}  // namespace

TEST_CASE("An empty job is the paper's scene and lattice with the solver of accurate.cfg") {
  const Job job = job_of("");
  CHECK(job.scene.gravity == 9.8);
  CHECK(job.scene.counterweight_mass == 5000);
  CHECK(job.lattice.increment == 0.01);
  CHECK(job.output.fields == std::vector{Field::speed, Field::release_time, Field::status});
  CHECK(job.output.file == "my.h5");
  CHECK(to_text(job) ==
        to_text(parse_job(read_job_file(SOURCE_DIR "/jobs/accurate.cfg"), "my.cfg", {})));
}

TEST_CASE("jobs/paper.cfg sets Euler's method and the release window, and no other key") {
  const Job job = read("paper.cfg");
  CHECK(job.solver.stepper == "euler");
  CHECK(job.solver.time_step == 0.01);
  CHECK(job.solver.release == Release::window);
  CHECK(job.solver.release_window == 0.05);
  const auto given = parse_config(read_job_file(SOURCE_DIR "/jobs/paper.cfg"), "paper.cfg");
  CHECK(given.size() == 2);
}

TEST_CASE("Options take precedence over the job file, and the job file over the defaults") {
  const Job job = job_of("[scene]\ngravity = 1.6 # on the Moon\nprojectile-mass = 50\n",
                         {{"scene.gravity", "3.7"}, {"output.file", "mars.h5"}});
  CHECK(job.scene.gravity == 3.7);
  CHECK(job.scene.projectile_mass == 50);
  CHECK(job.scene.release_height == 2);
  CHECK(job.output.file == "mars.h5");
}

TEST_CASE("A key can be removed from the job file, which then may not use it") {
  const std::string text = "[solver]\ntolerance = 1e-9\n[lattice]\nincrement = 0.02\n";
  const auto parse = [&](const std::string& job, const std::vector<std::string>& unset) {
    return parse_job(job, "my.cfg", {{"solver.stepper", "euler"}}, ".h5", unset);
  };
  const Job job = parse(text, {"solver.tolerance"});
  CHECK(job.solver.tolerance == Job().solver.tolerance);
  CHECK(job.lattice.increment == 0.02);
  CHECK_THROWS_WITH(parse(text, {"solver.tolerence"}),
                    contains("solver.tolerence: unknown key; the keys of [solver] are"));
  CHECK_THROWS_WITH(
      parse(text, {"solver.check"}),
      contains("unset = solver.check: must be a key that the job file sets, given once: "
               "lattice.increment, solver.tolerance"));
  CHECK_THROWS_WITH(parse("", {"solver.check"}), contains("the job file sets no key"));
}

TEST_CASE("An option replaces several values by one, and one by several") {
  const std::string text = "[scene]\nprojectile-mass = 50, 60\n";
  CHECK(job_of(text, {{"scene.projectile-mass", "55"}}).outer_axes.empty());
  CHECK(job_of(text, {{"scene.projectile-mass", "55"}}).scene.projectile_mass == 55);
  const Job job = job_of(text, {{"scene.gravity", "1:3:1"}, {"scene.projectile-mass", "70, 80"}});
  REQUIRE(job.outer_axes.size() == 2);
  CHECK(job.outer_axes[0].values == std::vector<double>{1, 2, 3});
  CHECK(job.outer_axes[1].values == std::vector<double>{70, 80});
  CHECK(job.scene.projectile_mass == 70);
}

TEST_CASE("The text of a study parses to the same study") {
  const Job job = job_of(
      "[scene]\nprojectile-mass = 200, 50,100.5\nfulcrum-height = 1.4 : 1.6 : 0.1\n"
      "[output]\nmaps = none\n");
  const Job again = job_of(to_text(job));
  CHECK(to_text(again) == to_text(job));
  CHECK(again.output.maps == Maps::none);
  REQUIRE(again.outer_axes.size() == 2);
  for (std::size_t a = 0; a < 2; ++a) CHECK(again.outer_axes[a].values == job.outer_axes[a].values);
}

TEST_CASE("The text of a job parses to the same job") {
  const std::string text = R"([scene]
gravity = 9.81
beam-inertia = prism
[lattice]
r1 = 0.51:0.9:0.003
r3 = 0.58
[solver]
stepper = dopri5
tolerance = 1.25e-11
release = crossing
max-steps = 12345
[output]
fields = status,speed
storage = float32
compression = 4
)";
  const Job job = job_of(text);
  CHECK(to_text(job_of(to_text(job))) == to_text(job));
  CHECK(job.scene.beam_inertia == BeamInertia::prism);
  CHECK(job.lattice.r1->step == 0.003);
  CHECK(job.lattice.r3->first == 0.58);
  CHECK(job.lattice.r3->last == 0.58);
  CHECK_FALSE(job.lattice.r2);
  CHECK(job.output.fields == std::vector{Field::status, Field::speed});
  CHECK(job.output.storage == Storage::float32);
}

TEST_CASE(
    "The text of a built machine's job holds the keys that it uses, and parses to the same job") {
  const std::string lab = R"(gravity = 9.81
beam-mass = 4.86
beam-centre = -0.465
beam-moment = 1.85
start-angle = 0.55
counterweight-hanger = 0.515
trough = yes
trough-height = 0.1
projectile-diameter = 0.05
wind = -3
)";
  const Job job = job_of("[scene]\n" + lab + "[solver]\nrelease = pin\npin-angle = 0.6\n");
  CHECK(job.scene.beam_mass == 4.86);
  CHECK(job.scene.beam_centre == -0.465);
  CHECK(job.scene.beam_moment == 1.85);
  CHECK(job.scene.start_angle == 0.55);
  CHECK(job.scene.counterweight_hanger == 0.515);
  CHECK(job.scene.trough);
  CHECK(job.scene.trough_height == 0.1);
  CHECK(job.scene.projectile_diameter == 0.05);
  CHECK(job.scene.drag_coefficient == 0.47);
  CHECK(job.scene.air_density == 1.225);
  CHECK(job.scene.wind == -3);
  CHECK(job.solver.release == Release::pin);
  CHECK(job.solver.pin_angle == 0.6);
  const std::string text = to_text(job);
  CHECK(to_text(job_of(text)) == text);
  for (const char* const used : {"\nstart-angle = 0.55\n", "\npin-angle = 0.6\n", "\nwind = -3\n",
                                 "\ndrag-coefficient = 0.47\n", "\nbeam-centre = -0.465\n"})
    CHECK_THAT(text, contains(used));
  for (const char* const unused : {"release-height", "beam-density", "beam-side", "beam-inertia",
                                   "sling-angle", "release-angle", "release-window"})
    CHECK_THAT(text, !contains(unused));
}

TEST_CASE("The text of the paper's job holds no key of built machines that it does not use") {
  const std::string text = to_text(job_of(""));
  CHECK_THAT(text, contains("\ncounterweight-hanger = 0\ntrough = no\nprojectile-diameter = 0\n"));
  for (const char* const unused :
       {"beam-mass", "beam-centre", "beam-moment", "start-angle", "trough-height",
        "drag-coefficient", "air-density", "wind", "pin-angle"})
    CHECK_THAT(text, !contains(unused));
  CHECK(job_of(text).solver.release_angle == std::numbers::pi);
}

TEST_CASE(
    "An axis must reach its last value; the message gives the nearest values that it reaches") {
  CHECK_THROWS_WITH(job_of("[lattice]\nr2 = 0.5:1.0:0.3\n"),
                    contains("lattice.r2 = 0.5:1.0:0.3: must be") && contains("0.8 and 1.1"));
  CHECK_THROWS_WITH(job_of("[lattice]\nr1 = 1:1.1:0.5\n"), contains("1 and 1.5"));
  CHECK(job_of("[lattice]\nr2 = 0.5:1.1:0.3\n").lattice.r2->last == 1.1);
  CHECK(job_of("[lattice]\nr1 = 0.1:0.7:0.1\n").lattice.r1->last == 0.7);
}

TEST_CASE("The message about a malformed axis says what an axis is") {
  for (const std::string axis : {"1:0.5:0.1", "a:b:c", "0.5:1:0", "0.5:1:-0.1", "0.5:1", "nan"})
    CHECK_THROWS_WITH(job_of("[lattice]\nr1 = " + axis + "\n"),
                      contains("lattice.r1 = " + axis +
                               ": must be first:last:step with a step above 0 and first <= last, "
                               "or a single value"));
}

TEST_CASE("The message about a job file name that is not a valid archive name names output.file") {
  CHECK_THROWS_WITH(parse_job("", "#1.cfg", {}), contains("output.file = #1.h5"));
  CHECK(parse_job("", "#1.cfg", {{"output.file", "a.h5"}}).output.file == "a.h5");
}

TEST_CASE("A target error replaces the tolerance of an adaptive stepper") {
  const std::string text = to_text(job_of("[solver]\nstepper = dopri5\ntarget-error = 1e-6\n"));
  CHECK(to_text(job_of(text)) == text);
  CHECK(job_of("[solver]\nstepper = dopri5\ntarget-error = 1e-6\n").solver.target_error == 1e-6);
  CHECK_THROWS_WITH(job_of("[solver]\nstepper = rk4\ntarget-error = 1e-6\n"), contains("rk4"));
  CHECK_THROWS_WITH(job_of("[solver]\nstepper = dopri5\ntolerance = 1e-9\ntarget-error = 1e-6\n"),
                    contains("solver.tolerance = 1e-9: must be left out with solver.target-error"));
}

TEST_CASE(
    "The lists of an assessment are read; its paths are relative to the job file, or to the "
    "working directory") {
  const std::string text = "[assess]\nscenes = a.cfg, b/c.cfg\ntime-steps = 0.1 0.01\n";
  const Job job = parse_job(text, "jobs/my.cfg", {});
  CHECK(job.assess.scenes == std::vector<std::string>{"jobs/a.cfg", "jobs/b/c.cfg"});
  CHECK(job.assess.time_steps == std::vector{0.1, 0.01});
  CHECK(job_of(text, {{"assess.scenes", "d.cfg"}}).assess.scenes ==
        std::vector<std::string>{"d.cfg"});
  CHECK(job_of(text, {{"assess.scenes", ""}}).assess.scenes.empty());
  CHECK_THAT(to_text(job, true), contains("time-steps = 0.1, 0.01"));
  CHECK_THAT(to_text(job), !contains("assess"));
}

TEST_CASE("By default the optimum is the fastest design, without constraints") {
  const OptimumSpec optimum = job_of("").optimum;
  CHECK(field_of(optimum.objective) == Field::speed);
  CHECK(optimum.constraints.empty());
  CHECK(optimum.deviation == 0);
  CHECK(optimum.robust == Robust::no);
  CHECK_FALSE(optimum.refine);
  CHECK_THAT(to_text(job_of("")), contains("\n[optimum]\nobjective = speed\ndeviation = 0\n"
                                           "robust = no\nrefine = no\n"));
}

TEST_CASE("A formula may be the objective, and what is minimized is one with the opposite sign") {
  CHECK(job_of("[optimum]\nobjective = -peak-axle-load\n").optimum.objective.text ==
        "-peak-axle-load");
  const Job job = job_of("[optimum]\nminimize = abs(range - 50)\n");
  CHECK(job.optimum.objective.text == "-(abs(range - 50))");
  CHECK(job_of(to_text(job)).optimum.objective.text == job.optimum.objective.text);
  CHECK_THROWS_WITH(job_of("[optimum]\nobjective = r1 + r2\n"),
                    contains("objective = r1 + r2: must be a formula with a field"));
  CHECK_THROWS_WITH(job_of("[optimum]\nobjective = speed\nminimize = apex\n"),
                    contains("optimum.minimize = apex: must be left out with optimum.objective"));
  CHECK_THROWS_WITH(job_of("[optimum]\nobjective = range * beam-mass\n"),
                    contains("must be another field unless scene.beam-mass is given"));
}

TEST_CASE("The objective and the constraints of an optimum survive a round trip through text") {
  const std::string text = R"([optimum]
objective = range
subject-to = peak-beam-stress<=1.2e8,peak-axle-load <= 1.5e5 , least-sling-tension >= 0
deviation = 0.005
robust = worst
refine = yes
)";
  const Job job = job_of(text), again = job_of(to_text(job));
  CHECK(to_text(again) == to_text(job));
  CHECK_THAT(to_text(job), contains("\nsubject-to = peak-beam-stress <= 120000000, peak-axle-load "
                                    "<= 150000, least-sling-tension >= 0\n"));
  CHECK(field_of(again.optimum.objective) == Field::range);
  REQUIRE(again.optimum.constraints.size() == 3);
  CHECK(again.optimum.constraints[1].expression.text == "peak-axle-load");
  CHECK(again.optimum.constraints[1].limit == 1.5e5);
  CHECK(again.optimum.deviation == 0.005);
  CHECK(again.optimum.robust == Robust::worst);
  CHECK(again.optimum.refine);
  CHECK(job_of(text, {{"optimum.subject-to", " "}}).optimum.constraints.empty());
}

TEST_CASE("jobs/paper.cfg and jobs/assess.cfg show every key") {
  const std::string text =
      read_job_file(SOURCE_DIR "/jobs/paper.cfg") + read_job_file(SOURCE_DIR "/jobs/assess.cfg");
  for (const Key& key : job_keys())
    CHECK_THAT(text, contains(key.name.substr(key.name.find('.') + 1) + " "));
}

TEST_CASE("The message about an unknown key lists the known ones") {
  CHECK_THROWS_WITH(job_of("[scene]\ncolour = red\n"),
                    contains("scene.colour") && contains("counterweight-mass"));
  CHECK_THROWS_WITH(job_of("[sceen]\ngravity = 1\n"),
                    contains("sceen.gravity") && contains("scene, lattice, solver, output"));
  CHECK_THROWS_AS(job_of("gravity = 1\n"), InputError);
}

TEST_CASE("A scene key is taken from the first of the option, its file, the job and its file") {
  const SceneFile of_option("job_test_option.cfg", "gravity = 2\nsling-mass = 2\nbeam-side = 2\n");
  const SceneFile of_job("job_test_job.cfg",
                         "gravity = 4\nsling-mass = 4\nbeam-side = 4\nbeam-density = 4\n");
  const std::string own = "gravity = 3\nsling-mass = 3\nbeam-density = 3\n";
  // Every subset of the four sources, for one key; that of the highest precedence gives 1.
  for (unsigned sources = 0; sources < 16; ++sources) {
    INFO(sources);
    Overrides overrides;
    if (sources & 1) overrides["scene.gravity"] = "1";
    if (sources & 2) overrides[scene_file_key] = of_option.path;
    std::string text = "[scene]\n";
    if (sources & 4) text += "gravity = 3\n";
    if (sources & 8) text += "file = job_test_job.cfg\n";
    const double expected = sources == 0 ? 9.8 : 1 + std::countr_zero(sources);
    CHECK(parse_job(text, TEST_DIR "/my.cfg", overrides).scene.gravity == expected);
  }
  // With all four sources, each key comes from the first source that sets it.
  const Job job = parse_job("[scene]\nfile = job_test_job.cfg\n" + own, TEST_DIR "/my.cfg",
                            {{"scene.gravity", "1"}, {scene_file_key, of_option.path}});
  CHECK(job.scene.gravity == 1);
  CHECK(job.scene.sling_mass == 2);
  CHECK(job.scene.beam_side == 2);
  CHECK(job.scene.beam_density == 3);
  CHECK(job.scene_files == std::vector<std::string>{of_option.path, of_job.path});
  CHECK(job_of(to_text(job)).scene.sling_mass == 2);  // the archive needs no other file
}

TEST_CASE("scene_text names the scene files and the keys that differ from their defaults") {
  CHECK(scene_text(job_of("")) == "the paper's (all keys at their defaults)");
  CHECK(scene_text(job_of("[scene]\ngravity = 9.8\nprojectile-mass = 50\n")) ==
        "projectile-mass = 50");
  CHECK(scene_text(job_of("[scene]\nstart-angle = 0.9\ntrough = yes\n")) ==
        "start-angle = 0.9, trough = yes");
  const SceneFile scene("job_test_scene.cfg", "sling-mass = 3\n");
  CHECK(scene_text(job_of("", {{scene_file_key, scene.path}})) ==
        scene.path.string() + ": sling-mass = 3");
}

TEST_CASE("solver_text names the step or tolerance and the release condition") {
  CHECK(solver_text(job_of("").solver) == "vern8, tolerance 8e-09, release at phi1 = pi");
  CHECK(solver_text(read("paper.cfg").solver) ==
        "euler, time step 0.01 s, release at the first step with |pi - phi1| < 0.05");
  const auto release_of = [](const std::string& keys) {
    return solver_text(job_of("[solver]\nrelease = " + keys).solver);
  };
  CHECK_THAT(release_of("crossing\nrelease-angle = 3.5"), contains(", release at phi1 = 3.5"));
  CHECK_THAT(release_of("pin\npin-angle = 0.6"), contains(", release by a pin at 0.6 rad"));
  CHECK_THAT(release_of("farthest"), contains(", release at the largest range"));
  CHECK_THAT(release_of("fastest"), contains(", release at the largest speed"));
}

TEST_CASE("A scene file holds only keys of a scene, and names no other file") {
  const SceneFile nested("job_test_nested.cfg", "file = other.cfg\n");
  CHECK_THROWS_WITH(job_of("", {{scene_file_key, nested.path}}),
                    contains("scene.file = " + nested.path.string() +
                             ": must be a file that does not name another scene file"));
  const SceneFile solver("job_test_solver.cfg", "[solver]\nstepper = rk4\n");
  CHECK_THROWS_WITH(job_of("", {{scene_file_key, solver.path}}),
                    contains("scene.file") && contains("without solver.stepper"));
  CHECK_THROWS_WITH(job_of("[scene]\nfile = nowhere.cfg\n"), contains("some/where/nowhere.cfg"));
}

TEST_CASE(
    "jobs/lab.cfg sweeps the laboratory machine's lattice, of which the built design is a point") {
  const Job job = read("lab.cfg");
  CHECK(job.scene.counterweight_hanger == 0.515);
  CHECK(job.solver.release == Release::farthest);
  const Design<double> built{0.25, 0.87, 0.975};
  const Lattice lattice(job.scene, job.lattice);
  CHECK(lattice.design(lattice.index_of(built)) == built);
}

TEST_CASE("The axes that a trough has by default are part of the job and of its text") {
  const std::string trough = "[scene]\nstart-angle = 0.8\ntrough = yes\n";
  const Job job = job_of(trough);
  const std::string text = to_text(job);
  CHECK_THAT(text, contains("\nincrement = 0.05\n") && contains("\nr3 = 0.6:3.3:0.05\n") &&
                       contains("\nr2 = 0.6:3.3:0.05\n") && !contains("\nr1 = "));
  CHECK(to_text(job_of(text)) == text);
  // The same lattice, given, is the same job, so that its archive can be continued.
  CHECK(to_text(job_of(trough + "[lattice]\nincrement = 0.05\nr3 = 0.6:3.3:0.05\n")) == text);
  CHECK_THAT(to_text(job_of(trough + "[lattice]\nincrement = 0.1\n")),
             contains("\nr3 = 0.6:3.3:0.1\n") && contains("\nr2 = 0.6:3.3:0.1\n"));
  const std::string given = "increment = 0.02\nshortest-sling = 0.3\nr3 = 1.2\nr2 = 1:2:0.5\n";
  CHECK_THAT(to_text(job_of(trough + "[lattice]\n" + given)), contains("[lattice]\n" + given));
  CHECK_FALSE(job_of("[scene]\nstart-angle = 0.8\n").lattice.r3);
}

TEST_CASE("trough_axes_text names the axes that a trough has by default, and no others") {
  const auto axes_of = [](const std::string& lattice) {
    return trough_axes_text(job_of("[scene]\ntrough = yes\n[lattice]\n" + lattice));
  };
  CHECK(axes_of("") == "r3 = 0.6:3.3:0.05, r2 = 0.6:3.3:0.05 m (default with a trough)");
  CHECK(axes_of("r3 = 1.2\n") == "r2 = 0.6:3.3:0.05 m (default with a trough)");
  CHECK(axes_of("r3 = 1.2\nr2 = 1.3\n").empty());
  CHECK(trough_axes_text(job_of("")).empty());
}

TEST_CASE("Every job file in jobs/ is valid") {
  for (const auto& entry : fs::recursive_directory_iterator(SOURCE_DIR "/jobs")) {
    if (entry.path().extension() != ".cfg") continue;
    INFO(entry.path());
    const Job job = parse_job(read_job_file(entry.path()), entry.path(), {});
    CHECK(Lattice(job.scene, job.lattice).designs() > 0);
  }
}

TEST_CASE("In the line about the scene, a long list of values is described") {
  std::string masses = "50";
  for (int mass = 51; mass <= 100; ++mass) masses += fmt::format(", {}", mass);
  CHECK(scene_text(job_of("[scene]\nprojectile-mass = " + masses)) ==
        "projectile-mass = 51 values from 50 to 100");
  CHECK(scene_text(job_of("[scene]\nprojectile-mass = 50, 60")) == "projectile-mass = 50, 60");
}
