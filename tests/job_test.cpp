#include "trebsweep/job.hpp"

#include <filesystem>
#include <fstream>

#include "catch.hpp"
#include "trebsweep/error.hpp"

using namespace trebsweep;

namespace {

Job parse(const std::string& text, const Overrides& overrides = {}) {
  return parse_job(text, "some/where/my.cfg", overrides);
}

}  // namespace

TEST_CASE("An empty job is the paper's") {
  const Job job = parse("");
  CHECK(job.scene.gravity == 9.8);
  CHECK(job.scene.counterweight_mass == 5000);
  CHECK(job.lattice.increment == 0.01);
  CHECK(job.solver.stepper == "euler");
  CHECK(job.solver.release == Release::window);
  CHECK(job.output.fields == std::vector{Field::speed, Field::release_time, Field::status});
  CHECK(job.output.file == "my.h5");
  CHECK(to_text(job) == to_text(parse(read_job_file(SOURCE_DIR "/jobs/paper.cfg"))));
}

TEST_CASE("The command line wins over the file, and the file over the defaults") {
  const Job job = parse("[scene]\ngravity = 1.6 # on the Moon\nprojectile-mass = 50\n",
                        {{"scene.gravity", "3.7"}, {"output.file", "mars.h5"}});
  CHECK(job.scene.gravity == 3.7);
  CHECK(job.scene.projectile_mass == 50);
  CHECK(job.scene.release_height == 2);
  CHECK(job.output.file == "mars.h5");
}

TEST_CASE("A job's text is read back as the same job") {
  const std::string text = R"([scene]
gravity = 9.81
beam-inertia = prism
[lattice]
r1 = 0.51:0.9:0.003
r3 = 0.58
[solver]
stepper = fehlberg78
tolerance = 1.25e-11
release = crossing
max-steps = 12345
[output]
fields = status,speed
storage = float32
compression = 4
)";
  const Job job = parse(text);
  CHECK(to_text(parse(to_text(job))) == to_text(job));
  CHECK(job.scene.beam_inertia == BeamInertia::prism);
  CHECK(job.lattice.r1->step == 0.003);
  CHECK(job.lattice.r3->first == 0.58);
  CHECK(job.lattice.r3->last == 0.58);
  CHECK_FALSE(job.lattice.r2);
  CHECK(job.output.fields == std::vector{Field::status, Field::speed});
  CHECK(job.output.storage == Storage::float32);
}

TEST_CASE("Every key is refused by its name and value when the value is nonsense") {
  for (const Key& key : job_keys()) {
    if (key.name == "output.file" || key.name == "assess.scenes" || key.name == "assess.extremes")
      continue;  // any text can be a path
    INFO(key.name);
    CHECK_THROWS_WITH(parse("", {{key.name, "nonsense"}}),
                      contains(key.name + " = nonsense: must be "));
    CHECK_THROWS_AS(parse("", {{key.name, ""}}), InputError);
  }
}

TEST_CASE("Masses, heights and gravity must be finite and above zero") {
  for (const std::string key :
       {"gravity", "counterweight-mass", "projectile-mass", "release-height", "fulcrum-height"})
    for (const std::string value :
         {"0", "-1", "nan", "inf", "-inf", "1e999", "1 kg", "0x10", "1,5"}) {
      INFO(key << " = " << value);
      CHECK_THROWS_WITH(
          parse("[scene]\n" + key + " = " + value),
          contains("scene." + key + " = " + value + ": must be a finite number above 0"));
    }
}

TEST_CASE("Values out of range are refused") {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"scene.beam-density", "-1"},
      {"scene.sling-angle", "4"},
      {"lattice.increment", "0"},
      {"lattice.increment", "-0.01"},
      {"lattice.r1", "1:0.5:0.1"},
      {"lattice.r1", "0.5:1:0"},
      {"lattice.r1", "0.5:1:-0.1"},
      {"lattice.r1", "0.5:1"},
      {"lattice.r1", "0.5:x:0.1"},
      {"lattice.r1", "0:1:0.1"},
      {"lattice.r1", "nan"},
      {"solver.stepper", "Euler"},
      {"solver.tolerance", "0"},
      {"solver.tolerance", "1e-16"},
      {"solver.tolerance", "1"},
      {"solver.max-steps", "0"},
      {"solver.max-steps", "1e6"},
      {"solver.max-steps", "-5"},
      {"output.compression", "10"},
      {"output.compression", "-1"},
      {"output.compression", "1.5"},
      {"output.storage", "float16"},
      {"output.fields", "speed,sped"},
      {"output.fields", "speed,speed"},
      {"output.file", "a#b.h5"},
      {"output.optimum", "slack"},
      {"scene.sling-stiffness", "-1"},
      {"scene.sling-damping", "-1"},
      {"scene.pivot-viscosity", "-1"},
      {"scene.pivot-friction", "-0.1"},
      {"scene.sling-mass", "-2"},
      {"solver.target-error", "0"},
      {"assess.steppers", "leapfrog"},
      {"assess.steppers", "rk4, rk4"},
      {"assess.tolerances", "1"},
      {"assess.time-steps", "0"},
      {"assess.designs", "0"},
      {"assess.target-error", "-1"},
      {"assess.lattice-seconds", "-1"},
  };
  for (const auto& [key, value] : bad)
    CHECK_THROWS_WITH(parse("", {{key, value}}), contains(key + " = " + value + ": must be "));
}

TEST_CASE("Adaptive steppers use the crossing, and refuse the window") {
  CHECK(parse("[solver]\nstepper = dopri5\n").solver.release == Release::crossing);
  CHECK(parse("[solver]\nstepper = rk4\n").solver.release == Release::window);
  CHECK_THROWS_WITH(parse("[solver]\nstepper = dopri5\nrelease = window\n"),
                    contains("solver.release = window: must be crossing"));
}

TEST_CASE("A line that says nothing is told with its number") {
  for (const std::string line : {"increment 0.1", "[scene", "%invalid_line%"})
    CHECK_THROWS_WITH(parse("[lattice]\n # a comment\n" + line + " # and another\n"),
                      contains("line 3, '" + line + "'"));
}

TEST_CASE("A job file whose name cannot be an archive's is told so") {
  CHECK_THROWS_WITH(parse_job("", "#1.cfg", {}), contains("output.file = #1.h5"));
  CHECK(parse_job("", "#1.cfg", {{"output.file", "a.h5"}}).output.file == "a.h5");
}

TEST_CASE("A target error stands for a tolerance, of a stepper that follows one") {
  const std::string text = to_text(parse("[solver]\nstepper = dopri5\ntarget-error = 1e-6\n"));
  CHECK(to_text(parse(text)) == text);
  CHECK(parse("[solver]\nstepper = dopri5\ntarget-error = 1e-6\n").solver.target_error == 1e-6);
  CHECK_THROWS_WITH(parse("[solver]\nstepper = rk4\ntarget-error = 1e-6\n"), contains("rk4"));
  CHECK_THROWS_WITH(
      parse("[solver]\nstepper = dopri5\ntolerance = 1e-9\ntarget-error = 1e-6\n"),
      contains("solver.target-error = 1e-06: must be given without solver.tolerance"));
}

TEST_CASE("An assessment's lists are read; its files lie beside the job, or where the user is") {
  const std::string text = "[assess]\nscenes = a.cfg, b/c.cfg\ntime-steps = 0.1 0.01\n";
  const Job job = parse_job(text, "jobs/my.cfg", {});
  CHECK(job.assess.scenes == std::vector<std::string>{"jobs/a.cfg", "jobs/b/c.cfg"});
  CHECK(job.assess.time_steps == std::vector{0.1, 0.01});
  CHECK(parse(text, {{"assess.scenes", "d.cfg"}}).assess.scenes ==
        std::vector<std::string>{"d.cfg"});
  CHECK(parse(text, {{"assess.scenes", ""}}).assess.scenes.empty());
  CHECK_THAT(to_text(job, true), contains("time-steps = 0.1, 0.01"));
  CHECK_THAT(to_text(job), !contains("assess"));
}

TEST_CASE("Blanks around a number, a leading + and a byte-order mark do no harm") {
  CHECK(parse("", {{"scene.gravity", " +9.5 "}}).scene.gravity == 9.5);
  CHECK_THROWS_AS(parse("", {{"scene.gravity", "+-9.5"}}), InputError);
  const std::filesystem::path file = TEST_DIR "/job_test_bom.cfg";
  std::ofstream(file) << "\xef\xbb\xbf[scene]\ngravity = 9.5\n";
  CHECK(parse(read_job_file(file)).scene.gravity == 9.5);
  std::filesystem::remove(file);
}

TEST_CASE("jobs/paper.cfg and jobs/assess.cfg show every key") {
  const std::string text =
      read_job_file(SOURCE_DIR "/jobs/paper.cfg") + read_job_file(SOURCE_DIR "/jobs/assess.cfg");
  for (const Key& key : job_keys())
    CHECK_THAT(text, contains(key.name.substr(key.name.find('.') + 1) + " "));
}

TEST_CASE("Unknown keys are refused with the known ones") {
  CHECK_THROWS_WITH(parse("[scene]\ncolour = red\n"),
                    contains("scene.colour") && contains("counterweight-mass"));
  CHECK_THROWS_WITH(parse("[sceen]\ngravity = 1\n"),
                    contains("sceen.gravity") && contains("scene, lattice, solver, output"));
  CHECK_THROWS_AS(parse("gravity = 1\n"), InputError);
}

TEST_CASE("Text that is no job is refused with the file's name") {
  CHECK_THROWS_WITH(parse("what is this?\n"), contains("my.cfg"));
  CHECK_THROWS_AS(parse("[scene]\ngravity = 1\ngravity = 2\n"), InputError);
}

TEST_CASE("Missing, unreadable and binary files are refused by name") {
  namespace fs = std::filesystem;
  CHECK_THROWS_WITH(read_job_file("/nowhere/job.cfg"), contains("/nowhere/job.cfg"));
  CHECK_THROWS_WITH(read_job_file("/"), contains("is a directory"));
  const fs::path file = TEST_DIR "/job_test.cfg";
  std::ofstream(file) << std::string("[scene]\n\0\1\2", 11);
  CHECK_THROWS_WITH(read_job_file(file), contains("not a text file"));
  std::ofstream(file) << std::string(2 << 20, '#');
  CHECK_THROWS_WITH(read_job_file(file), contains("longer than 1 MiB"));
  fs::remove(file);
}

TEST_CASE("A job may name a scene file, over which its own keys win") {
  namespace fs = std::filesystem;
  const fs::path scene = TEST_DIR "/job_test_scene.cfg";
  std::ofstream(scene) << "[scene]\nsling-mass = 3\ngravity = 1.6\n";
  const std::string job_file = TEST_DIR "/job.cfg";
  const std::string text = "[scene]\nfile = job_test_scene.cfg\ngravity = 9\n";
  const Job job = parse_job(text, job_file, {});
  CHECK(job.scene.sling_mass == 3);
  CHECK(job.scene.gravity == 9);
  CHECK(parse("", {{"scene.file", scene.string()}}).scene.gravity == 1.6);
  CHECK(parse(to_text(job)).scene.sling_mass == 3);  // the archive needs no other file
  std::ofstream(scene) << "[solver]\nstepper = rk4\n";
  CHECK_THROWS_WITH(parse_job(text, job_file, {}), contains("scene.file") && contains("stepper"));
  fs::remove(scene);
  CHECK_THROWS_WITH(parse_job(text, job_file, {}), contains("job_test_scene.cfg"));
}

TEST_CASE("Effects that make no sense are refused") {
  CHECK_THROWS_WITH(parse("[scene]\nsling-damping = 5\n"),
                    contains("scene.sling-damping = 5: must be 0 without a sling-stiffness"));
  CHECK_THROWS_WITH(parse("[scene]\nbeam-side = 0\n[output]\nfields = peak-beam-stress\n"),
                    contains("output.fields = peak-beam-stress: must be"));
  CHECK(parse("[scene]\nsling-stiffness = 1e5\nsling-damping = 5\n").scene.sling_damping == 5);
}

TEST_CASE("The job files that come with the program are valid") {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SOURCE_DIR "/jobs")) {
    if (entry.path().extension() != ".cfg") continue;
    INFO(entry.path());
    const Job job = parse_job(read_job_file(entry.path()), entry.path(), {});
    CHECK(Lattice(job.scene, job.lattice).designs() > 0);
  }
}
