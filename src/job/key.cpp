#include "trebsweep/job/key.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <span>

#include "trebsweep/base/number.hpp"

namespace trebsweep {
namespace {

/// A key with a number.
template <class Section>
Key number(const std::string& name, const std::string& help, const Range& range,
           Section Job::*section, double Section::*member) {
  return {name, fmt::format("{}; {}", help, range.text()),
          [=](Job& job, const std::string& value) {
            job.*section.*member = to_number(name, value, range);
          },
          [=](const Job& job) { return fmt::format("{}", job.*section.*member); }};
}

template <class Section, class Integer>
Key whole_number(const std::string& name, const std::string& help, std::uint64_t low,
                 std::uint64_t high, Section Job::*section, Integer Section::*member) {
  const std::string allowed = fmt::format("a whole number from {} to {}", low, high);
  return {name, fmt::format("{}; {}", help, allowed),
          [=](Job& job, const std::string& value) {
            std::uint64_t n = 0;
            if (!parses(value, n) || n < low || n > high) refuse(name, value, allowed);
            job.*section.*member = static_cast<Integer>(n);
          },
          [=](const Job& job) { return fmt::format("{}", job.*section.*member); }};
}

using Names = std::span<const std::string_view>;

std::size_t to_choice(const std::string& key, const std::string& value, Names names) {
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end()) refuse(key, value, fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

/// A key with one of the names of an enumeration, in its order.
template <class Section, class Enum>
Key choice(const std::string& name, const std::string& help, Names names, Section Job::*section,
           Enum Section::*member) {
  return {name, fmt::format("{}; one of {}", help, fmt::join(names, ", ")),
          [=](Job& job, const std::string& value) {
            job.*section.*member = static_cast<Enum>(to_choice(name, value, names));
          },
          [=](const Job& job) {
            return std::string(names[static_cast<std::size_t>(job.*section.*member)]);
          }};
}

/// The words of a list, which commas, blanks or both separate.
std::vector<std::string> to_words(const std::string& value) {
  std::vector<std::string> words;
  boost::split(words, boost::trim_copy(value), boost::is_any_of(", "), boost::token_compress_on);
  return words;
}

/// The places of a list's words among `names`; none may be repeated.
std::vector<std::size_t> to_choices(const std::string& key, const std::string& value, Names names) {
  std::vector<std::size_t> places;
  for (const std::string& word : to_words(value)) {
    places.push_back(to_choice(key, word, names));
    if (std::count(places.begin(), places.end(), places.back()) > 1)
      refuse(key, word, "listed only once");
  }
  return places;
}

/// A key with a list of numbers, at least one.
Key numbers(const std::string& name, const std::string& help, const Range& range,
            std::vector<double> Assessment::*member) {
  return {name, fmt::format("{}; a list, each {}", help, range.text()),
          [=](Job& job, const std::string& value) {
            (job.assess.*member).clear();
            for (const std::string& word : to_words(value))
              (job.assess.*member).push_back(to_number(name, word, range));
          },
          [=](const Job& job) { return fmt::format("{}", fmt::join(job.assess.*member, ", ")); }};
}

/// Whether a path stays the same in the text of a job, where a # begins a comment.
bool can_be_read_back(const std::string& path) {
  return !path.empty() && path == boost::trim_copy(path) &&
         path.find_first_of("#\n\r\"") == std::string::npos;
}

/// A key with a list of paths.
Key paths(const std::string& name, const std::string& help,
          std::vector<std::string> Assessment::*member) {
  return {name, help,
          [=](Job& job, const std::string& value) {
            (job.assess.*member).clear();
            for (const std::string& word : to_words(value)) {
              if (word.empty()) continue;
              if (!can_be_read_back(word)) refuse(name, word, "a path without # and quotes");
              (job.assess.*member).push_back(word);
            }
          },
          [=](const Job& job) { return fmt::format("{}", fmt::join(job.assess.*member, ", ")); }};
}

Key stepper_key() {
  return {"solver.stepper",
          fmt::format("method of integration; one of {}", fmt::join(stepper_names, ", ")),
          [](Job& job, const std::string& value) {
            job.solver.stepper = stepper_names[to_choice("solver.stepper", value, stepper_names)];
          },
          [](const Job& job) { return job.solver.stepper; }};
}

Key target_key() {
  const std::string name = "solver.target-error";
  return {name,
          fmt::format("largest error of the speeds, m/s; chooses the tolerance by a sample; {}",
                      positive.text()),
          [=](Job& job, const std::string& value) {
            job.solver.target_error = to_number(name, value, positive);
          },
          [](const Job& job) {
            return job.solver.target_error > 0 ? fmt::format("{}", job.solver.target_error) : "";
          }};
}

Key steppers_key() {
  const std::string name = "assess.steppers";
  return {name, fmt::format("a list of {}", fmt::join(stepper_names, ", ")),
          [=](Job& job, const std::string& value) {
            job.assess.steppers.clear();
            for (const std::size_t place : to_choices(name, value, stepper_names))
              job.assess.steppers.emplace_back(stepper_names[place]);
          },
          [](const Job& job) { return fmt::format("{}", fmt::join(job.assess.steppers, ", ")); }};
}

/// Refuses an axis that does not end with its last value.
void check_steps(const std::string& key, const std::string& value, const AxisRange& axis) {
  const double steps = (axis.last - axis.first) / axis.step;
  const double rounding = 1e-9 + 1e-15 * axis.last / axis.step;  // of decimals, in steps
  if (std::abs(steps - std::round(steps)) <= rounding) return;
  const auto at = [&](double n) { return axis.first + n * axis.step; };
  refuse(key, value,
         fmt::format("a range whose last value lies a whole number of steps from the first; the "
                     "nearest are {:.15g} and {:.15g}",
                     at(std::floor(steps)), at(std::ceil(steps))));
}

AxisRange to_axis(const std::string& key, const std::string& value) {
  const std::string allowed =
      "first:last:step or a single value, in metres, each from 1e-12 to 1e+12, with first <= last";
  std::vector<std::string> parts;
  boost::split(parts, value, boost::is_any_of(":"));
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    double x = 0;
    if (!parses(part, x) || !physical.contains(x)) refuse(key, value, allowed);
    numbers.push_back(x);
  }
  if (numbers.size() == 1) return {numbers[0], numbers[0], 1};
  if (numbers.size() != 3 || numbers[0] > numbers[1]) refuse(key, value, allowed);
  const AxisRange axis{numbers[0], numbers[1], numbers[2]};
  check_steps(key, value, axis);
  return axis;
}

Key axis(const std::string& name, const std::string& help,
         std::optional<AxisRange> LatticeSpec::*member) {
  return {name, help + ", as first:last:step (both ends included) or a single value, m",
          [=](Job& job, const std::string& value) { job.lattice.*member = to_axis(name, value); },
          [=](const Job& job) -> std::string {
            const auto& range = job.lattice.*member;
            if (!range) return "";
            if (range->first == range->last) return fmt::format("{}", range->first);
            return fmt::format("{}:{}:{}", range->first, range->last, range->step);
          }};
}

Key fields_key() {
  static const auto names = [] {
    std::array<std::string_view, field_info.size()> all;
    std::transform(field_info.begin(), field_info.end(), all.begin(),
                   [](const FieldInfo& field) { return field.name; });
    return all;
  }();
  const std::string name = "output.fields";
  return {name, fmt::format("maps to store; a list of {}", fmt::join(names, ", ")),
          [=](Job& job, const std::string& value) {
            job.output.fields.clear();
            for (const std::size_t place : to_choices(name, value, names))
              job.output.fields.push_back(static_cast<Field>(place));
          },
          [](const Job& job) {
            std::vector<std::string_view> chosen;
            for (const Field field : job.output.fields) chosen.push_back(info(field).name);
            return fmt::format("{}", fmt::join(chosen, ", "));
          }};
}

Key file_key() {
  return {"output.file",
          "path of the archive; by default the job file's name with .h5, in the current folder",
          [](Job& job, const std::string& value) {
            if (!can_be_read_back(value))
              refuse("output.file", value,
                     "a path without #, quotes and line breaks, and without blanks at its ends");
            job.output.file = value;
          },
          [](const Job& job) { return job.output.file; }};
}

std::vector<Key> scene_keys() {
  constexpr double pi = boost::math::double_constants::pi;
  const auto scene = [](const std::string& name, const std::string& help, const Range& range,
                        double Scene::*member) {
    return number("scene." + name, help, range, &Job::scene, member);
  };
  return {
      scene("gravity", "gravitational acceleration g, m/s^2", physical, &Scene::gravity),
      scene("counterweight-mass", "m1, kg", physical, &Scene::counterweight_mass),
      scene("projectile-mass", "m3, kg", physical, &Scene::projectile_mass),
      scene("release-height", "height h of the counterweight at the start, m", physical,
            &Scene::release_height),
      scene("fulcrum-height", "height h0 of the fulcrum, m", physical, &Scene::fulcrum_height),
      scene("beam-density", "density of the beam, kg/m^3", physical_or_zero, &Scene::beam_density),
      scene("beam-side", "side of the beam's square section, m", physical_or_zero,
            &Scene::beam_side),
      choice("scene.beam-inertia", "moment of inertia of the beam", beam_inertia_names, &Job::scene,
             &Scene::beam_inertia),
      scene("sling-angle", "phi2 at the start, rad; 0 hangs straight down", Range{-pi, pi},
            &Scene::sling_angle),
      scene("pivot-viscosity", "viscous torque of the pivot per rate of the beam, N m s/rad",
            physical_or_zero, &Scene::pivot_viscosity),
      scene("pivot-friction", "dry torque of the pivot, which also holds a beam at rest, N m",
            physical_or_zero, &Scene::pivot_friction),
      scene("sling-mass", "mass of the sling, spread evenly, kg", physical_or_zero,
            &Scene::sling_mass),
      scene("sling-stiffness", "force of an elastic sling per stretch, N/m; 0: rigid",
            physical_or_zero, &Scene::sling_stiffness),
      scene("sling-damping", "force of an elastic sling per rate of its stretch, N s/m",
            physical_or_zero, &Scene::sling_damping),
  };
}

std::vector<Key> lattice_keys() {
  return {
      number("lattice.increment", "step of the lattice dr, m", physical, &Job::lattice,
             &LatticeSpec::increment),
      number("lattice.shortest-sling", "where r3 begins, m", physical, &Job::lattice,
             &LatticeSpec::shortest_sling),
      axis("lattice.r1", "counterweight arms instead of h - h0 < r1 < h0", &LatticeSpec::r1),
      axis("lattice.r3", "slings instead of shortest-sling <= r3 < h0", &LatticeSpec::r3),
      axis("lattice.r2", "throwing arms instead of 0 < r2 < h0 - r3", &LatticeSpec::r2),
  };
}

std::vector<Key> solver_keys() {
  constexpr double half_pi = boost::math::double_constants::half_pi;
  return {
      stepper_key(),
      number("solver.time-step", "step of a fixed stepper, s", positive, &Job::solver,
             &Solver::time_step),
      number("solver.tolerance",
             "error allowed in a step of an adaptive stepper, absolute and relative",
             Range{1e-15, 0.1}, &Job::solver, &Solver::tolerance),
      target_key(),
      choice("solver.release",
             "crossing: phi1 = pi, located exactly; window: the paper's rule, the first step with "
             "|pi - phi1| < release-window, for fixed steppers only",
             release_names, &Job::solver, &Solver::release),
      number("solver.release-window", "half width of the paper's window, rad",
             Range{0, half_pi, false}, &Job::solver, &Solver::release_window),
      number("solver.max-time", "a swing not released by then counts as not_released, s", positive,
             &Job::solver, &Solver::max_time),
      whole_number("solver.max-steps", "steps tried per swing before it counts as step_budget", 1,
                   1000000000000, &Job::solver, &Solver::max_steps),
  };
}

std::vector<Key> output_keys() {
  return {
      file_key(),
      fields_key(),
      choice("output.optimum",
             "designs that compete for the optimum: all, or those whose sling stays taut",
             optimum_filter_names, &Job::output, &Output::optimum_filter),
      choice("output.storage", "number type of the maps", storage_names, &Job::output,
             &Output::storage),
      whole_number("output.compression", "deflate level of the maps, 0 = off", 0, 9, &Job::output,
                   &Output::compression),
  };
}

std::vector<Key> assess_keys() {
  return {
      paths("assess.scenes", "scene or job files to assess; by default the job's own scene",
            &Assessment::scenes),
      paths("assess.extremes", "the same, with one setting per stepper", &Assessment::extremes),
      steppers_key(),
      numbers("assess.time-steps", "steps to try, s", positive, &Assessment::time_steps),
      numbers("assess.tolerances", "tolerances to try", Range{1e-15, 0.1}, &Assessment::tolerances),
      whole_number("assess.designs",
                   "designs of a scene's lattice, in addition to its corners and its optimum", 1,
                   100000, &Job::assess, &Assessment::designs),
      whole_number("assess.repeats", "runs of which the median time counts", 1, 1000, &Job::assess,
                   &Assessment::repeats),
      number("assess.target-error", "error of the speed that advice is given for, m/s", positive,
             &Job::assess, &Assessment::target_error),
      number("assess.lattice-seconds",
             "longest run over the first scene's whole lattice, s; 0: none", not_negative,
             &Job::assess, &Assessment::lattice_seconds),
  };
}

}  // namespace

const std::vector<Key>& job_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> all;
    for (auto& section :
         {scene_keys(), lattice_keys(), solver_keys(), output_keys(), assess_keys()})
      all.insert(all.end(), section.begin(), section.end());
    return all;
  }();
  return keys;
}

}  // namespace trebsweep
