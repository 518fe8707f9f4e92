#include "trebsweep/job/key.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <type_traits>

#include "trebsweep/job/key_kinds.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {
namespace {

constexpr double pi = boost::math::double_constants::pi;
constexpr double half_pi = boost::math::double_constants::half_pi;
// 2 pi, rounded up to the digits of messages, so that the bound that they give is allowed.
constexpr Range turn{physical.low, 6.28318531};
constexpr Range half_turn{-pi, pi, false};
constexpr Range lengths{-physical.high, physical.high};
constexpr Range winds{-1000, 1000};
constexpr Range tolerances{1e-15, 0.1};

constexpr auto field_names = [] {
  std::array<std::string_view, field_info.size()> names;
  std::transform(field_info.begin(), field_info.end(), names.begin(),
                 [](const FieldInfo& field) { return field.name; });
  return names;
}();

/// The section of a job that is of a type.
template <class Section>
constexpr Section Job::*section_of = nullptr;
template <>
constexpr Scene Job::*section_of<Scene> = &Job::scene;
template <>
constexpr LatticeSpec Job::*section_of<LatticeSpec> = &Job::lattice;
template <>
constexpr Solver Job::*section_of<Solver> = &Job::solver;
template <>
constexpr Output Job::*section_of<Output> = &Job::output;
template <>
constexpr OptimumSpec Job::*section_of<OptimumSpec> = &Job::optimum;
template <>
constexpr Assessment Job::*section_of<Assessment> = &Job::assess;

/// The key for a member of a section.
template <class Section, class T>
Key key(const std::string& name, const std::string& meaning, const KeyKind<T>& kind,
        T Section::*member) {
  return {name,
          kind.placeholder,
          meaning,
          kind.unit,
          kind.allowed,
          [=](Job& job, const std::string& value) {
            job.*section_of<Section>.*member = kind.parse(name, value);
          },
          [=](const Job& job) { return kind.print(job.*section_of<Section>.*member); }};
}

/// The key for a number of [scene], which can be an outer axis.
template <class T>
Key outer_key(const std::string& name, const std::string& meaning, const KeyKind<T>& kind,
              T Scene::*member) {
  Key outer = key(name, meaning, kind, member);
  const auto is_own = [=](const OuterAxis& axis) { return axis.key == name; };
  outer.set_number = [=](Scene& scene, double value) { scene.*member = value; };
  outer.number = [=](const Scene& scene) {
    return std::optional<double>(scene.*member).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  outer.set = [=, set_one = outer.set](Job& job, const std::string& value) {
    if (!has_several_values(value)) return set_one(job, value);
    const auto parse = [&](const std::string& text) {
      if constexpr (std::is_same_v<T, double>)
        return kind.parse(name, text);
      else
        return kind.parse(name, text).value();
    };
    OuterAxis axis = to_outer_axis(name, value, kind.unit, parse);
    job.scene.*member = axis.values.front();
    job.outer_axes.push_back(std::move(axis));
    check_scene_count(job);  // before there is memory for the values of more axes
  };
  outer.get = [=, get_one = outer.get](const Job& job) {
    const auto axis = std::ranges::find_if(job.outer_axes, is_own);
    return axis == job.outer_axes.end() ? get_one(job) : axis->text;
  };
  return outer;
}

/// The key for an objective with the opposite sign.
Key minimize_key() {
  Key minimize = key("optimum.minimize",
                     "field or formula whose smallest value is the optimum, instead of objective",
                     expression(), &OptimumSpec::objective);
  minimize.set = [set = minimize.set](Job& job, const std::string& value) {
    set(job, value);
    job.optimum.objective = negative(job.optimum.objective);
  };
  minimize.get = [](const Job&) { return std::string(); };  // it is that of the objective
  return minimize;
}

}  // namespace

bool is_absent_at_zero(std::string_view name) {
  return name == "scene.sling-stiffness" || name == "scene.counterweight-hanger" ||
         name == "scene.projectile-diameter";
}

std::string Key::help() const {
  return fmt::format("{}{}{}; {}", meaning, unit.empty() ? "" : ", ", unit, allowed);
}

// clang-format off
const std::vector<Key>& job_keys() {
  static const std::vector<Key> keys{
      outer_key("scene.gravity", "gravitational acceleration g",
          number(physical, "m/s^2"), &Scene::gravity),
      outer_key("scene.counterweight-mass", "mass m1 of the counterweight",
          number(physical, "kg"), &Scene::counterweight_mass),
      outer_key("scene.projectile-mass", "mass m3 of the projectile",
          number(physical, "kg"), &Scene::projectile_mass),
      outer_key("scene.release-height",
          "height h of the counterweight above the ground at the start (not at the projectile's "
          "release)",
          number(physical, "m"), &Scene::release_height),
      outer_key("scene.fulcrum-height", "height h0 of the fulcrum above the ground",
          number(physical, "m"), &Scene::fulcrum_height),
      outer_key("scene.beam-density", "density of the beam",
          number(physical_or_zero, "kg/m^3"), &Scene::beam_density),
      outer_key("scene.beam-side", "side of the beam's square cross-section",
          number(physical_or_zero, "m"), &Scene::beam_side),
      outer_key("scene.beam-width",
          "width of the beam's rectangular cross-section, given with beam-depth instead of "
          "beam-side",
          optional_of(number(physical, "m")), &Scene::beam_width),
      outer_key("scene.beam-depth",
          "depth of the beam's rectangular cross-section, in the plane of the swing",
          optional_of(number(physical, "m")), &Scene::beam_depth),
      key("scene.beam-inertia",
          "moment of inertia of the beam: that of a slender rod (the paper's), the exact one of a "
          "prism, or none",
          choice<BeamInertia>(beam_inertia_names), &Scene::beam_inertia),
      outer_key("scene.sling-angle",
          "initial angle phi2 of the sling, where 0 hangs straight down",
          number(Range{-pi, pi}, "rad"), &Scene::sling_angle),
      outer_key("scene.pivot-viscosity",
          "viscous friction of the pivot: torque per angular velocity of the beam",
          number(physical_or_zero, "N m s/rad"), &Scene::pivot_viscosity),
      outer_key("scene.pivot-friction",
          "dry friction of the pivot: torque that opposes the motion and can hold a beam at rest",
          number(physical_or_zero, "N m"), &Scene::pivot_friction),
      outer_key("scene.sling-mass", "mass of the sling, distributed evenly along it",
          number(physical_or_zero, "kg"), &Scene::sling_mass),
      outer_key("scene.sling-stiffness",
          "stiffness of an elastic sling: force per elongation, where 0 means a rigid sling",
          number(physical_or_zero, "N/m"), &Scene::sling_stiffness),
      outer_key("scene.sling-damping",
          "damping of an elastic sling: force per rate of elongation",
          number(physical_or_zero, "N s/m"), &Scene::sling_damping),
      outer_key("scene.beam-mass",
          "mass m2 of a measured beam, given with beam-centre and beam-moment instead of "
          "those of its density, section and inertia",
          optional_of(number(physical_or_zero, "kg")), &Scene::beam_mass),
      outer_key("scene.beam-centre",
          "distance from the fulcrum to the measured beam's centre of mass, positive towards the "
          "sling",
          optional_of(number(lengths, "m")), &Scene::beam_centre),
      outer_key("scene.beam-moment",
          "moment of inertia of the measured beam about the fulcrum",
          optional_of(number(physical_or_zero, "kg m^2")), &Scene::beam_moment),
      outer_key("scene.beam-section-modulus",
          "section modulus of the measured beam at the fulcrum, for its stress",
          optional_of(number(physical, "m^3")), &Scene::beam_section_modulus),
      outer_key("scene.counterweight-inertia",
          "moment of inertia of the counterweight about its own centre",
          number(physical_or_zero, "kg m^2"), &Scene::counterweight_inertia),
      outer_key("scene.start-angle",
          "initial angle phi1 of the counterweight arm, where 0 points straight up, instead of "
          "release-height",
          optional_of(number(half_turn, "rad")), &Scene::start_angle),
      outer_key("scene.start-tip-height",
          "height above the ground of the throwing arm's tip at the start, which determines phi1, "
          "instead of release-height",
          optional_of(number(physical_or_zero, "m")), &Scene::start_tip_height),
      outer_key("scene.counterweight-hanger",
          "length r4 of the hinged link on which the counterweight hangs from its arm, where 0 "
          "means that it is fixed to the arm",
          number(physical_or_zero, "m"), &Scene::counterweight_hanger),
      key("scene.trough",
          "whether the projectile starts in a frictionless, horizontal trough under the beam, with "
          "the sling taut",
          yes_no(), &Scene::trough),
      outer_key("scene.trough-height", "height of the trough above the ground, below fulcrum-height",
          number(physical_or_zero, "m"), &Scene::trough_height),
      outer_key("scene.projectile-diameter",
          "diameter of a projectile that feels drag in flight, where 0 means no drag",
          number(physical_or_zero, "m"), &Scene::projectile_diameter),
      outer_key("scene.drag-coefficient", "drag coefficient of the projectile",
          number(physical_or_zero), &Scene::drag_coefficient),
      outer_key("scene.air-density", "density of the air",
          number(physical_or_zero, "kg/m^3"), &Scene::air_density),
      outer_key("scene.wind",
          "horizontal speed of the wind, positive in the direction of the throw",
          number(winds, "m/s"), &Scene::wind),

      key("lattice.increment",
          "spacing dr of the lattice along every axis not given below; with a trough, unless r3 and "
          "r2 are given, the default is h0 / 30, rounded up to one digit",
          number(physical, "m"), &LatticeSpec::increment),
      key("lattice.shortest-sling", "smallest value of r3",
          number(physical, "m"), &LatticeSpec::shortest_sling),
      key("lattice.r1",
          "lengths of the counterweight arm, instead of h - h0 + r4 < r1 < h0 - r4",
          optional_of(axis_range()), &LatticeSpec::r1),
      key("lattice.r3",
          "lengths of the sling, instead of shortest-sling <= r3 < h0, or about 0.4 h0 <= r3 <= 2.2 "
          "h0 with a trough",
          optional_of(axis_range()), &LatticeSpec::r3),
      key("lattice.r2",
          "lengths of the throwing arm, instead of 0 < r2 < h0 - r3, or about 0.4 h0 <= r2 <= 2.2 h0 "
          "with a trough",
          optional_of(axis_range()), &LatticeSpec::r2),

      key("solver.stepper", "stepper (integration method)",
          choice(stepper_names), &Solver::stepper),
      key("solver.time-step", "step of a fixed-step stepper",
          number(positive, "s"), &Solver::time_step),
      key("solver.tolerance",
          "error allowed per step of an adaptive stepper, both absolute and relative",
          number(tolerances), &Solver::tolerance),
      key("solver.target-error",
          "largest error allowed in the speeds; the tolerance of the adaptive stepper is chosen "
          "to meet it on a sample of the designs",
          optional_number(positive, "m/s"), &Solver::target_error),
      key("solver.release",
          "release condition. crossing: phi1 = release-angle, located by root finding. window: the "
          "paper's rule, the first step with |pi - phi1| < release-window, for fixed-step steppers "
          "only. pin: the sling slips off its pin, where phi1 - phi2 first falls to pin-angle after "
          "lift-off from the trough, if there is one, and before phi1 = 3 pi/2. farthest and fastest: "
          "the largest range and speed of all pin angles between -pi and pi",
          choice<Release>(release_names), &Solver::release),
      key("solver.release-angle", "angle phi1 of release = crossing",
          number(turn, "rad"), &Solver::release_angle),
      key("solver.pin-angle",
          "angle phi1 - phi2, between the sling and the arm's continuation, of release = pin",
          optional_of(number(half_turn, "rad")), &Solver::pin_angle),
      key("solver.release-window", "half width of the window of release = window",
          number(Range{0, half_pi, false}, "rad"), &Solver::release_window),
      key("solver.max-time",
          "time after which a swing without a release ends with status not_released, or never_lifted "
          "if the projectile is still in the trough",
          number(positive, "s"), &Solver::max_time),
      key("solver.max-steps",
          "maximum number of steps per swing, including rejected ones; a swing that needs more "
          "ends with status step_budget",
          integer<std::uint64_t>(1, 1'000'000'000'000), &Solver::max_steps),
      key("solver.check",
          "whether a sweep measures the error of its speeds, by integrating a sample of the lattice "
          "again far more accurately",
          yes_no(), &Solver::check),

      key("output.file",
          "path of the archive (default: the job file's name with the extension .h5, for an "
          "assessment with -assess.h5, or job.h5 and job-assess.h5 if the job is read from stdin; in "
          "the working directory)",
          path(), &Output::file),
      key("output.fields", "maps to store",
          set_of(choice<Field>(field_names)), &Output::fields),
      key("output.optimum",
          "designs that compete for the optimum: all, or those whose sling stays taut",
          choice<OptimumFilter>(optimum_filter_names), &Output::optimum_filter),
      key("output.maps", "whether the maps are stored, or only the optimum of each scene",
          choice<Maps>(maps_names), &Output::maps),
      key("output.storage", "number type of the maps",
          choice<Storage>(storage_names), &Output::storage),
      key("output.compression", "deflate level of the maps, where 0 means no compression",
          integer<int>(0, 9), &Output::compression),

      key("optimum.objective", "field or formula whose largest value is the optimum",
          expression(), &OptimumSpec::objective),
      minimize_key(),
      key("optimum.subject-to",
          "constraints that the optimum satisfies (default: none)",
          constraints(), &OptimumSpec::constraints),
      key("optimum.variables",
          "keys that trebsweep optimum searches besides the lengths, with their bounds; where the job "
          "does not give such a key a value, other commands take the middle (default: none)",
          variables(), &OptimumSpec::variables),
      key("optimum.deviation",
          "largest deviation of each built length from the optimum's, where 0 means exact "
          "lengths",
          number(physical_or_zero, "m"), &OptimumSpec::deviation),
      key("optimum.robust",
          "what is made as large as possible: the objective of the exact lengths (no), or its "
          "worst or expected value under the deviation",
          choice<Robust>(robust_names), &OptimumSpec::robust),
      key("optimum.refine",
          "whether a sweep also searches for the optimum between the designs of its lattice",
          yes_no(), &OptimumSpec::refine),
      key("optimum.buildable",
          "whether trebsweep optimum searches only among designs that can be built: whose arm, "
          "counterweight and projectile stay above the ground, whose rigid sling stays taut, and "
          "whose release a pin can make",
          yes_no(), &OptimumSpec::buildable),

      key("assess.scenes", "scene or job files to assess (default: the job's own scene)",
          paths(), &Assessment::scenes),
      key("assess.extremes",
          "scene or job files of extreme cases, each tried with one setting per stepper",
          paths(), &Assessment::extremes),
      key("assess.steppers", "steppers to compare",
          set_of(choice(stepper_names)), &Assessment::steppers),
      key("assess.time-steps", "steps to try with fixed-step steppers",
          list_of(number(positive, "s")), &Assessment::time_steps),
      key("assess.tolerances", "tolerances to try with adaptive steppers",
          list_of(number(tolerances)), &Assessment::tolerances),
      key("assess.designs",
          "designs sampled from a scene's lattice, in addition to its corners and its optimum",
          integer<std::uint64_t>(1, 100'000), &Assessment::designs),
      key("assess.repeats", "runs per time measurement, of which the median is reported",
          integer<std::uint64_t>(1, 1000), &Assessment::repeats),
      key("assess.target-error",
          "error of the speed for which the cheapest solver is recommended",
          number(positive, "m/s"), &Assessment::target_error),
      key("assess.lattice-seconds",
          "longest run allowed over the whole lattice of the first scene, where 0 means no such "
          "run",
          number(not_negative, "s"), &Assessment::lattice_seconds),
  };
  return keys;
}
// clang-format on

}  // namespace trebsweep
