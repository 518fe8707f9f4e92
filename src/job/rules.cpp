#include "trebsweep/job/rules.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/model/start.hpp"

namespace trebsweep {
namespace {

[[noreturn]] void refuse_number(const std::string& key, double value, const std::string& allowed) {
  refuse(key, fmt::format("{}", value), allowed);
}

std::vector<std::string_view> steppers_with(bool tolerance) {
  std::vector<std::string_view> names;
  std::copy_if(stepper_names.begin(), stepper_names.end(), std::back_inserter(names),
               [=](std::string_view name) { return follows_tolerance(name) == tolerance; });
  return names;
}

/// Checks that a section is complete, and a measured beam also physically possible.
void check_beam(const Scene& scene) {
  if (scene.beam_width.has_value() != scene.beam_depth.has_value())
    throw InputError(fmt::format("{}: must be given with {}: a section has both",
                                 scene.beam_width ? "scene.beam-depth" : "scene.beam-width",
                                 scene.beam_width ? "scene.beam-width" : "scene.beam-depth"));
  std::vector<std::string_view> given, missing;
  const auto sort_in = [&](const char* key, const std::optional<double>& value) {
    (value ? given : missing).push_back(key);
  };
  sort_in("scene.beam-mass", scene.beam_mass);
  sort_in("scene.beam-centre", scene.beam_centre);
  sort_in("scene.beam-moment", scene.beam_moment);
  if (given.empty()) return;
  if (!missing.empty())
    throw InputError(
        fmt::format("{}: must be given with {}: a measured beam has a mass, a centre "
                    "and a moment of inertia",
                    fmt::join(missing, ", "), fmt::join(given, ", ")));
  constexpr double rounding = 1e-12;
  const double least = *scene.beam_mass * *scene.beam_centre * *scene.beam_centre;
  if (*scene.beam_moment < least * (1 - rounding))
    refuse_number(
        "scene.beam-moment", *scene.beam_moment,
        fmt::format("at least beam-mass * beam-centre^2 = {} kg m^2, that of a point mass", least));
}

void check_trough(const Scene& scene) {
  if (scene.trough && scene.trough_height >= scene.fulcrum_height)
    refuse_number("scene.trough-height", scene.trough_height,
                  fmt::format("below scene.fulcrum-height = {}", scene.fulcrum_height));
}

/// By how much the weight that an elastic sling carries stretches it at the start, m.
double start_stretch(const Scene& scene) {
  const Design<double> any{std::abs(start_height(scene)), 0,
                           1};  // r3 = 0: the length is the stretch
  return start<double, Effects{.elastic = true}>(scene, any)[length];
}

/// Checks that an elastic sling is not so soft that it starts far below the ground.
void check_start_stretch(const Scene& scene) {
  constexpr double most = 10;  // fulcrum heights: more than any machine's arm reaches up
  if (scene.sling_stiffness == 0) return;
  const double ratio = start_stretch(scene) / (most * scene.fulcrum_height);
  if (ratio > 1)
    refuse_number("scene.sling-stiffness", scene.sling_stiffness,
                  fmt::format("0 (rigid), or at least {:.3g} N/m: at the start, the weight that "
                              "the sling carries must not stretch it by more than {} times "
                              "scene.fulcrum-height = {}",
                              1.01 * ratio * scene.sling_stiffness, most, scene.fulcrum_height));
}

void check_sling(const Scene& scene) {
  if (scene.sling_damping > 0 && scene.sling_stiffness == 0)
    refuse_number("scene.sling-damping", scene.sling_damping,
                  "0 unless scene.sling-stiffness is above 0: a rigid sling does not stretch");
  const bool hanger = scene.counterweight_hanger > 0;
  if (scene.sling_stiffness > 0 && (hanger || scene.trough))
    refuse_number("scene.sling-stiffness", scene.sling_stiffness,
                  fmt::format("0 with {}: the equations of an elastic sling do not include {}",
                              hanger ? "scene.counterweight-hanger above 0" : "scene.trough = yes",
                              hanger ? "a hanger" : "a trough"));
  check_start_stretch(scene);
}

void check_release(const Solver& solver) {
  if (follows_tolerance(solver.stepper) && solver.release == Release::window)
    refuse("solver.release", "window",
           fmt::format("crossing, pin, farthest or fastest for the adaptive stepper {}, whose "
                       "steps may skip the window",
                       solver.stepper));
  if (solver.release == Release::pin && !solver.pin_angle)
    throw InputError("solver.pin-angle: must be given with solver.release = pin");
}

/// Why a scene does not have a field, as the rest of a message; empty if it has it.
std::string why_absent(Field field, const Scene& scene) {
  if (field == Field::peak_beam_stress && !has_beam_stress(scene))
    return scene.beam_mass
               ? "with scene.beam-mass, unless scene.beam-section-modulus is given: the "
                 "cross-section of a measured beam is not known"
               : "if scene.beam-side is 0: the beam then has no cross-section";
  if (field == Field::lift_off_time && !scene.trough)
    return "unless scene.trough is yes: there is no lift-off without a trough";
  if ((field == Field::peak_hanger_tension || field == Field::least_hanger_tension) &&
      scene.counterweight_hanger == 0)
    return "unless scene.counterweight-hanger is above 0: there is no hanger";
  return "";
}

/// Checks that the scene has every field, and uses every key, that the job asks for.
void check_fields(const Job& job, const Scene& scene,
                  const std::map<std::string, std::string>& unused) {
  const auto check = [&](Field field, const char* key, const std::string& value,
                         const char* allowed) {
    if (const std::string why = why_absent(field, scene); !why.empty())
      refuse(key, value, fmt::format("{} {}", allowed, why));
  };
  const auto name = [](Field field) { return std::string(info(field).name); };
  for (const Field field : job.output.fields)
    check(field, "output.fields", name(field), "left out");
  const auto check_expression = [&](const Expression& expression, const char* key,
                                    const std::string& text, const char* allowed) {
    for (const Field field : expression.fields) check(field, key, text, allowed);
    for (const std::string& operand : expression.keys) {
      if (const auto why = unused.find(operand); why != unused.end())
        refuse(key, text, fmt::format("without {}, which must be {}", operand, why->second));
      if (std::isnan(std::ranges::find(job_keys(), operand, &Key::name)->number(scene)))
        refuse(key, text, fmt::format("{} unless {} is given", allowed, operand));
    }
  };
  const Expression& objective = job.optimum.objective;
  check_expression(objective, "optimum.objective", objective.text, "another field");
  for (const Constraint& constraint : job.optimum.constraints)
    check_expression(constraint.expression, "optimum.subject-to", to_text(constraint), "left out");
}

/// Checks that two constraints on the same expression are a lower limit and a larger upper limit.
void check_pair(const Constraint& a, const Constraint& b) {
  if (a.is_upper == b.is_upper)
    refuse("optimum.subject-to", to_text(b),
           fmt::format("the only {} limit of {}; {} is another", a.is_upper ? "upper" : "lower",
                       a.expression.text, to_text(a)));
  const double low = (a.is_upper ? b : a).limit, high = (a.is_upper ? a : b).limit;
  if (low >= high)
    refuse("optimum.subject-to", fmt::format("{}, {}", to_text(a), to_text(b)),
           fmt::format("a lower limit below the upper limit: {}",
                       low == high ? "equal limits leave no room for a search"
                                   : "no design satisfies both"));
}

void check_optimum(const OptimumSpec& optimum) {
  const auto& constraints = optimum.constraints;
  for (auto b = constraints.begin(); b != constraints.end(); ++b)
    for (auto a = constraints.begin(); a != b; ++a)
      if (a->expression.text == b->expression.text) check_pair(*a, *b);
  if (optimum.robust != Robust::no && optimum.deviation == 0)
    refuse("optimum.robust", std::string(robust_names[static_cast<std::size_t>(optimum.robust)]),
           "no unless optimum.deviation is above 0");
}

/// Checks what a job with several scenes may ask for.
void check_study(const Job& job) {
  if (!is_study(job)) return;
  if (job.solver.target_error > 0)
    refuse_number("solver.target-error", job.solver.target_error,
                  fmt::format("left out if {} has several values: each scene would need its own "
                              "tolerance; give solver.tolerance",
                              job.outer_axes.back().key));
  for (const OuterAxis& axis : job.outer_axes)
    for (const Field field : stored_fields(job.output))
      if (info(field).name == axis.name())
        refuse("output.fields", axis.name(),
               fmt::format("left out if {} has several values: the archive has that axis under the "
                           "same name",
                           axis.key));
}

void check_scene(const Job& job, const Scene& scene,
                 const std::map<std::string, std::string>& unused) {
  check_beam(scene);
  check_trough(scene);
  check_sling(scene);
  check_fields(job, scene, unused);
}

void check_unused(const std::map<std::string, std::string>& unused,
                  const std::map<std::string, std::string>& given) {
  for (const auto& [key, why] : unused)
    if (const auto found = given.find(key); found != given.end()) refuse(key, found->second, why);
}

/// Checks the variables, and the scenes at the corners of their box: rules are about the sign of a
/// key, or order two of them.
void check_variables(const Job& job, const std::map<std::string, std::string>& given) {
  const auto& variables = job.optimum.variables;
  if (variables.size() > max_variables)
    refuse("optimum.variables", to_text(variables.back()),
           fmt::format("one of at most {} variables", max_variables));
  for (auto v = variables.begin(); v != variables.end(); ++v) {
    const auto check = [&](bool valid, const std::string& allowed) {
      if (!valid) refuse("optimum.variables", to_text(*v), allowed);
    };
    check(std::ranges::count(variables, v->key, &Variable::key) == 1, "given only once");
    check(std::ranges::count(job.outer_axes, v->key, &OuterAxis::key) == 0,
          fmt::format("left out with several values of {}", v->key));
    check(!is_absent_at_zero(v->key) || v->lower > 0, "above 0, where the scene lacks the effect");
  }
  if (variables.empty()) return;
  for (const std::vector<double>& values : corners(variables)) {
    Job at = job;
    at.outer_axes.clear();
    set_variables(variables, values, at.scene, at.solver);
    const auto unused = unused_keys(at);
    check_unused(unused, given);
    for (const Variable& v : variables)
      if (const auto why = unused.find(v.key); why != unused.end())
        refuse("optimum.variables", to_text(v),
               fmt::format("without {}, which must be {}", v.key, why->second));
    check_scene(at, at.scene, unused);
  }
}

}  // namespace

std::map<std::string, std::string> unused_keys(const Job& job) {
  // The scene with the largest values uses a key if any scene does.
  const Scene scene = scene_at(job, count_scenes(job) - 1);
  const Solver& solver = job.solver;
  std::map<std::string, std::string> unused;
  const auto leave_out = [&](std::initializer_list<const char*> keys, const std::string& why) {
    for (const char* const key : keys) unused.emplace(key, "left out" + why);
  };
  if (scene.start_angle)
    leave_out({"scene.release-height"}, " with scene.start-angle, which determines it");
  if (scene.start_tip_height)
    leave_out({"scene.release-height", "scene.start-angle"},
              " with scene.start-tip-height, which determines it");
  if (scene.beam_mass)
    leave_out({"scene.beam-density", "scene.beam-side", "scene.beam-width", "scene.beam-depth",
               "scene.beam-inertia"},
              " with scene.beam-mass, beam-centre and beam-moment, which describe the whole beam");
  else
    leave_out({"scene.beam-section-modulus"},
              " unless scene.beam-mass is given: it follows from the section of other beams");
  if (scene.beam_width || scene.beam_depth)
    leave_out({"scene.beam-side"}, " with scene.beam-width and beam-depth, which determine it");
  if (scene.trough)
    leave_out({"scene.sling-angle"}, " with scene.trough = yes, which determines it");
  if (scene.trough && !job.lattice.r3)
    leave_out({"lattice.shortest-sling"}, " with scene.trough = yes; give lattice.r3");
  if (!scene.trough) leave_out({"scene.trough-height"}, " unless scene.trough is yes");
  if (scene.projectile_diameter == 0)
    leave_out({"scene.drag-coefficient", "scene.air-density", "scene.wind"},
              " unless scene.projectile-diameter is above 0");

  const auto not_used = [&](const char* kind, const char* instead, bool tolerance) {
    return fmt::format(": the {} stepper {} does not use it; give {} or choose one of {}", kind,
                       solver.stepper, instead, fmt::join(steppers_with(tolerance), ", "));
  };
  if (follows_tolerance(solver.stepper))
    leave_out({"solver.time-step"}, not_used("adaptive", "solver.tolerance", false));
  else
    leave_out({"solver.tolerance", "solver.target-error"},
              not_used("fixed-step", "solver.time-step", true));
  if (solver.target_error > 0)
    leave_out({"solver.tolerance"}, " with solver.target-error, which determines it");
  if (solver.release != Release::crossing)
    leave_out({"solver.release-angle"}, " unless solver.release is crossing");
  if (solver.release != Release::pin)
    leave_out({"solver.pin-angle"}, " unless solver.release is pin");
  if (solver.release != Release::window)
    leave_out({"solver.release-window"}, " unless solver.release is window");
  return unused;
}

void check_rules(const Job& job, const std::map<std::string, std::string>& given) {
  check_release(job.solver);
  check_study(job);
  check_variables(job, given);
  if (given.contains("optimum.objective") && given.contains("optimum.minimize"))
    refuse(
        "optimum.minimize", given.at("optimum.minimize"),
        "left out with optimum.objective; --unset optimum.objective leaves out that of a job file");
  const auto unused = unused_keys(job);
  check_unused(unused, given);
  for (std::uint64_t n = 0; n < count_scenes(job); ++n)
    name_scene_in_errors(job, n, [&] { check_scene(job, scene_at(job, n), unused); });
  check_optimum(job.optimum);
}

}  // namespace trebsweep
