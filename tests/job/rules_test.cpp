#include "trebsweep/job/rules.hpp"

#include <fmt/format.h>

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

Job parse_scene(const std::string& keys) { return parse("[scene]\n" + keys); }

const std::string beam = "beam-mass = 4.86\nbeam-centre = 0.465\nbeam-moment = 1.85\n";

}  // namespace

TEST_CASE(
    "The default release is the crossing for every stepper; adaptive ones refuse the window") {
  for (const std::string_view stepper : stepper_names)
    CHECK(parse(fmt::format("[solver]\nstepper = {}\n", stepper)).solver.release ==
          Release::crossing);
  CHECK_THROWS_WITH(parse("[solver]\nstepper = dopri5\nrelease = window\n"),
                    contains("solver.release = window: must be crossing"));
  CHECK(parse("[solver]\nstepper = rk4\nrelease = window\n").solver.release == Release::window);
}

TEST_CASE(
    "An elastic sling that would start far below the ground is refused with the least stiffness") {
  // The paper's: 100 kg * 9.8 m/s^2 = 980 N, and 10 * 1.5 m: 65.3 N/m.
  const std::string message =
      "must be 0 (rigid), or at least 66 N/m: at the start, the weight that the sling carries must "
      "not stretch it by more than 10 times scene.fulcrum-height = 1.5";
  CHECK_THROWS_WITH(parse_scene("sling-stiffness = 1e-12\n"),
                    contains("scene.sling-stiffness = 1e-12: " + message));
  CHECK_THROWS_WITH(parse_scene("sling-stiffness = 65\n"),
                    contains("scene.sling-stiffness = 65: " + message));
  for (const std::string scene :
       {"sling-stiffness = 66\n", "sling-stiffness = 65\nfulcrum-height = 1.6\n",
        "sling-stiffness = 1e-12\nsling-angle = 2\n",
        "sling-stiffness = 60\nstart-angle = 1\nprojectile-mass = 90\n"})
    CHECK_NOTHROW(parse_scene(scene));
  CHECK_THROWS_WITH(parse_scene("sling-stiffness = 0, 50, 100\n"),
                    contains("(in the scene with sling-stiffness = 50 N/m)"));
}

TEST_CASE("The message about a key that the solver does not use says what to do") {
  CHECK_THROWS_WITH(parse("[solver]\nstepper = euler\ntolerance = 1e-9\n"),
                    contains("solver.tolerance = 1e-9: must be left out") &&
                        contains("give solver.time-step or choose one of cash_karp54"));
  CHECK_THROWS_WITH(parse("[solver]\ntime-step = 0.1\n"),
                    contains("solver.time-step = 0.1: must be left out") &&
                        contains("give solver.tolerance or choose one of euler"));
  CHECK_THROWS_WITH(
      parse("[solver]\nstepper = euler\nrelease = window\n", {{"solver.stepper", "dopri5"}}),
      contains("solver.release = window"));
  CHECK(parse("[solver]\nstepper = rk4\nrelease = window\nrelease-window = 0.1\ntime-step = 1e-3\n")
            .solver.release_window == 0.1);
}

TEST_CASE("Only the rule of release that a key belongs to uses it") {
  struct Rule {
    std::string release, key, value;
  };
  const std::vector<Rule> rules{{"crossing", "release-angle", "3.5"},
                                {"pin", "pin-angle", "0.6"},
                                {"window", "release-window", "0.1"}};
  for (const auto& [owner, key, value] : rules)
    for (const std::string_view release : release_names) {
      const std::string job =
          fmt::format("[solver]\nstepper = rk4\nrelease = {}\n{} = {}\n{}", release, key, value,
                      release == "pin" && owner != "pin" ? "pin-angle = 0.6\n" : "");
      INFO(job);
      if (release == owner)
        CHECK_NOTHROW(parse(job));
      else
        CHECK_THROWS_WITH(parse(job),
                          contains(fmt::format("solver.{} = {}: must be left out unless "
                                               "solver.release is {}",
                                               key, value, owner)));
    }
}

TEST_CASE("A release by a pin needs the pin's angle") {
  CHECK_THROWS_WITH(parse("[solver]\nrelease = pin\n"),
                    "solver.pin-angle: must be given with solver.release = pin");
}

TEST_CASE("A sling without stiffness has no damping") {
  CHECK_THROWS_WITH(parse_scene("sling-damping = 5\n"),
                    contains("scene.sling-damping = 5: must be 0 unless scene.sling-stiffness"));
  CHECK(parse_scene("sling-stiffness = 1e5\nsling-damping = 5\n").scene.sling_damping == 5);
}

TEST_CASE("The message about an incomplete measured beam names what is missing and what is given") {
  CHECK_THROWS_WITH(
      parse_scene("beam-centre = 1\nbeam-moment = 2\n"),
      contains("scene.beam-mass: must be given with scene.beam-centre, scene.beam-m"));
  CHECK_THROWS_WITH(
      parse_scene("beam-mass = 1\nbeam-moment = 2\n"),
      contains("scene.beam-centre: must be given with scene.beam-mass, scene.beam-m"));
  CHECK_THROWS_WITH(
      parse_scene("beam-mass = 1\nbeam-centre = 0\n"),
      contains("scene.beam-moment: must be given with scene.beam-mass, scene.beam-c"));
  CHECK_THROWS_WITH(
      parse_scene("beam-moment = 2\n"),
      contains("scene.beam-mass, scene.beam-centre: must be given with scene.beam-moment: "));
  CHECK(parse_scene(beam).scene.beam_moment == 1.85);
}

TEST_CASE("A measured beam has no density, section or rule of inertia, and no stress") {
  for (const std::string key : {"beam-density = 7850", "beam-side = 0.1", "beam-inertia = prism"})
    CHECK_THROWS_WITH(parse_scene(beam + key),
                      contains("scene." + key + ": must be left out with scene.beam-mass"));
  const std::string stress = "[output]\nfields = peak-beam-stress\n";
  CHECK_THROWS_WITH(
      parse_scene(beam + stress),
      contains("output.fields = peak-beam-stress: must be left out with scene.beam-mass"));
  CHECK_THROWS_WITH(
      parse_scene("beam-side = 0\n" + stress),
      contains("output.fields = peak-beam-stress: must be left out if scene.beam-side is 0"));
  CHECK_NOTHROW(parse_scene(stress));
  CHECK_NOTHROW(parse_scene(beam + "beam-section-modulus = 6.77e-5\n" + stress));
  CHECK_THROWS_WITH(
      parse_scene("beam-section-modulus = 6.77e-5\n"),
      contains("scene.beam-section-modulus = 6.77e-5: must be left out unless scene.beam-mass is"));
}

TEST_CASE("A section is a width and a depth, or a side") {
  CHECK_THROWS_WITH(
      parse_scene("beam-width = 0.045\n"),
      contains("scene.beam-depth: must be given with scene.beam-width: a section has both"));
  CHECK_THROWS_WITH(
      parse_scene("beam-width = 0.045\nbeam-depth = 0.095\nbeam-side = 0.1\n"),
      contains("scene.beam-side = 0.1: must be left out with scene.beam-width and beam-depth"));
  CHECK_THROWS_WITH(parse_scene(beam + "beam-width = 0.045\nbeam-depth = 0.095\n"),
                    contains("scene.beam-depth = 0.095: must be left out with scene.beam-mass"));
  const Job job = parse_scene("beam-width = 0.045\nbeam-depth = 0.095\n");
  CHECK(to_text(job).find("beam-side") == std::string::npos);
}

TEST_CASE("Fields of the trough and of the hanger are refused in a scene without them") {
  const auto fields = [](const std::string& field) { return "[output]\nfields = " + field + "\n"; };
  CHECK_THROWS_WITH(parse(fields("speed, lift-off-time")),
                    contains("output.fields = lift-off-time: must be left out unless scene.trough "
                             "is yes"));
  CHECK_THROWS_WITH(parse(fields("peak-hanger-tension")),
                    contains("output.fields = peak-hanger-tension: must be left out unless "
                             "scene.counterweight-hanger is above 0"));
  CHECK_NOTHROW(parse_scene("trough = yes\n" + fields("lift-off-time")));
  CHECK_NOTHROW(parse_scene("counterweight-hanger = 0.3\n" + fields("peak-hanger-tension")));
}

TEST_CASE("An objective or constraint on a field that the scene does not have is refused") {
  const std::string stress = "peak-beam-stress <= 120000000";
  for (const std::string& scene : {beam, std::string("beam-side = 0\n")}) {
    CHECK_THROWS_WITH(parse_scene(scene + "[optimum]\nsubject-to = speed >= 1, " + stress),
                      contains("optimum.subject-to = " + stress + ": must be left out ") &&
                          contains("scene.beam-"));
    CHECK_THROWS_WITH(parse_scene(scene + "[optimum]\nobjective = peak-beam-stress\n"),
                      contains("optimum.objective = peak-beam-stress: must be another field "));
  }
  CHECK_THROWS_WITH(parse("[optimum]\nobjective = lift-off-time\n"),
                    contains("optimum.objective = lift-off-time: must be another field unless "
                             "scene.trough is yes"));
  CHECK_THROWS_WITH(parse("[optimum]\nsubject-to = peak-hanger-tension <= 5e4\n"),
                    contains("optimum.subject-to = peak-hanger-tension <= 50000: must be left out "
                             "unless scene.counterweight-hanger is above 0"));
  CHECK_NOTHROW(parse("[optimum]\nsubject-to = " + stress));
  CHECK_NOTHROW(parse_scene("trough = yes\n[optimum]\nobjective = lift-off-time\n"));
  CHECK_NOTHROW(parse_scene(
      "counterweight-hanger = 0.3\n[optimum]\nsubject-to = peak-hanger-tension <= 5e4"));
}

TEST_CASE("Two constraints on a field are a lower limit and a larger upper limit") {
  const auto subject_to = [](const std::string& list) {
    return parse("", {{"optimum.subject-to", list}});
  };
  CHECK_THROWS_WITH(subject_to("speed >= 4, apex <= 9, speed <= 3"),
                    "optimum.subject-to = speed >= 4, speed <= 3: must be a lower limit below the "
                    "upper limit: no design satisfies both");
  CHECK_THROWS_WITH(subject_to("speed <= 3, speed >= 3"),
                    "optimum.subject-to = speed <= 3, speed >= 3: must be a lower limit below the "
                    "upper limit: equal limits leave no room for a search");
  CHECK_THROWS_WITH(subject_to("speed <= 3, range >= 2, speed <= 4"),
                    "optimum.subject-to = speed <= 4: must be the only upper limit of speed; speed "
                    "<= 3 is another");
  CHECK_THROWS_WITH(
      subject_to("apex >= 3, apex >= 3"),
      "optimum.subject-to = apex >= 3: must be the only lower limit of apex; apex >= 3 "
      "is another");
  CHECK(subject_to("speed <= 4, apex >= 9, speed >= 3").optimum.constraints.size() == 3);
}

TEST_CASE("A robust optimum needs a deviation") {
  for (const std::string robust : {"worst", "expected"})
    for (const std::string deviation : {"", "deviation = 0\n"})
      CHECK_THROWS_WITH(
          parse("[optimum]\nrobust = " + robust + "\n" + deviation),
          "optimum.robust = " + robust + ": must be no unless optimum.deviation is above 0");
  CHECK(parse("[optimum]\nrobust = worst\ndeviation = 0.01\n").optimum.robust == Robust::worst);
  CHECK(parse("[optimum]\nrobust = no\ndeviation = 0.01\n").optimum.deviation == 0.01);
}

TEST_CASE("The moment of inertia of a measured beam is at least that of a point at its centre") {
  CHECK_THROWS_WITH(
      parse_scene("beam-mass = 2\nbeam-centre = -3\nbeam-moment = 17.99\n"),
      contains("scene.beam-moment = 17.99: must be at least ") && contains("= 18 kg m^2"));
  CHECK_NOTHROW(parse_scene("beam-mass = 2\nbeam-centre = -3\nbeam-moment = 18\n"));
  // 3 * 0.1 * 0.1 is not quite 0.03.
  CHECK_NOTHROW(parse_scene("beam-mass = 3\nbeam-centre = 0.1\nbeam-moment = 0.03\n"));
}

TEST_CASE("A start angle replaces the height of the counterweight") {
  CHECK_THROWS_WITH(parse_scene("start-angle = 0.55\nrelease-height = 2\n"),
                    contains("scene.release-height = 2: must be left out with scene.start-angle"));
  CHECK(parse_scene("start-angle = -0.55\n").scene.start_angle == -0.55);
  for (const std::string key : {"start-angle = 0.5", "release-height = 2"})
    CHECK_THROWS_WITH(parse_scene("start-tip-height = 0\n" + key),
                      contains("scene." + key + ": must be left out with scene.start-tip-height"));
  CHECK(parse_scene("start-tip-height = 0\n").scene.start_tip_height == 0);
}

TEST_CASE("A trough is below the fulcrum and determines the angle of the sling") {
  CHECK_THROWS_WITH(parse_scene("trough = yes\nsling-angle = -1\n"),
                    contains("scene.sling-angle = -1: must be left out with scene.trough = yes"));
  for (const std::string height : {"1.5", "2"})
    CHECK_THROWS_WITH(
        parse_scene("trough = yes\ntrough-height = " + height),
        contains("scene.trough-height = " + height + ": must be below scene.fulcrum-height = 1.5"));
  CHECK(parse_scene("trough = yes\ntrough-height = 1.4\n").scene.trough_height == 1.4);
  for (const std::string trough : {"", "trough = no\n"})
    CHECK_THROWS_WITH(
        parse_scene(trough + "trough-height = 0.1\n"),
        contains("scene.trough-height = 0.1: must be left out unless scene.trough is yes"));
}

TEST_CASE("Only a projectile with a diameter uses the keys of the air") {
  for (const std::string key : {"drag-coefficient", "air-density", "wind"}) {
    CHECK_THROWS_WITH(
        parse_scene(key + " = 0.5\n"),
        contains("scene." + key +
                 " = 0.5: must be left out unless scene.projectile-diameter is above 0"));
    CHECK_THROWS_AS(parse_scene("projectile-diameter = 0\n" + key + " = 0.5\n"), InputError);
    CHECK_NOTHROW(parse_scene("projectile-diameter = 0.05\n" + key + " = 0.5\n"));
  }
}

TEST_CASE("The shortest sling is refused where a trough has its axis of r3 by default") {
  const std::string lattice = "[lattice]\nshortest-sling = 0.5\n";
  CHECK_THROWS_WITH(parse_scene("trough = yes\n" + lattice),
                    contains("lattice.shortest-sling = 0.5: must be left out with scene.trough = "
                             "yes; give lattice.r3"));
  CHECK_NOTHROW(parse_scene("trough = yes\n" + lattice + "r3 = 1.2\n"));
  CHECK_NOTHROW(parse_scene(lattice));
}

TEST_CASE("An elastic sling is refused with a hanger and with a trough") {
  for (const std::string other : {"counterweight-hanger = 0.3", "trough = yes"}) {
    CHECK_THROWS_WITH(parse_scene("sling-stiffness = 3e5\n" + other),
                      contains("scene.sling-stiffness = 300000: must be 0 with scene." +
                               other.substr(0, other.find(' '))));
    CHECK_NOTHROW(parse_scene("sling-stiffness = 0\n" + other));
  }
  CHECK_NOTHROW(parse_scene("sling-stiffness = 3e5\ncounterweight-hanger = 0\ntrough = no\n"));
}

TEST_CASE("The window rule is allowed with a hanger and with a trough") {
  for (const std::string key : {"counterweight-hanger = 0.3", "trough = yes"})
    CHECK_NOTHROW(parse_scene(key + "\n[solver]\nstepper = euler\nrelease = window\n"));
}

TEST_CASE("A key makes at most a million scenes with those before it") {
  CHECK_THROWS_WITH(parse_scene("gravity = 1:1001:1\nwind = -500:500:1\nprojectile-diameter = 1\n"),
                    contains("scene.wind = -500:500:1: must be fewer values") &&
                        contains("1002001 scenes; at most 1000000 are allowed"));
  CHECK_THROWS_WITH(
      parse_scene("gravity = 1:1e6:1\nprojectile-mass = 1:1e6:1\nsling-mass = 1:1e6:1\n"),
      contains("scene.projectile-mass = 1:1e6:1"));
  CHECK(parse_scene("gravity = 1:1000:1\nsling-mass = 1:1000:1\n").outer_axes.size() == 2);
}

TEST_CASE("The message about a rule that a scene breaks names the scene") {
  CHECK_THROWS_WITH(parse_scene("sling-stiffness = 0, 1e6\nsling-damping = 5\n"),
                    contains("scene.sling-damping = 5: must be 0") &&
                        contains("(in the scene with sling-stiffness = 0 N/m)"));
  CHECK_THROWS_WITH(parse("[scene]\nbeam-side = 0, 0.1\n[output]\nfields = peak-beam-stress\n"),
                    contains("output.fields") && contains("(in the scene with beam-side = 0 m)"));
  CHECK_THROWS_WITH(
      parse_scene("sling-damping = 5\n"),
      contains("scene.sling-damping = 5: must be 0") && !contains("(in the scene with"));
}

TEST_CASE("A target error is refused with several scenes") {
  CHECK_THROWS_WITH(parse("[scene]\nwind = 1, 2\nprojectile-diameter = 0.1\n"
                          "[solver]\ntarget-error = 1e-6\n"),
                    contains("solver.target-error = 1e-06: must be left out if scene.wind has "
                             "several values") &&
                        contains("give solver.tolerance"));
}

TEST_CASE("A key that only some scenes use is allowed") {
  CHECK(parse_scene("projectile-diameter = 0, 0.1\nwind = 3\n").outer_axes.size() == 1);
  CHECK_THROWS_WITH(parse_scene("wind = 0, 3\n"), contains("scene.wind = 0, 3: must be left out"));
}

TEST_CASE("A field whose map would have the name of an outer axis is refused") {
  const std::string text = "[scene]\nsling-angle = 0, 0.1\n[output]\nfields = speed, sling-angle\n";
  CHECK_THROWS_WITH(parse_job(text, "a.cfg", {}),
                    contains("output.fields = sling-angle: must be left out if scene.sling-angle "
                             "has several values"));
  CHECK_NOTHROW(parse_job(text + "maps = none\n", "a.cfg", {}));
}
