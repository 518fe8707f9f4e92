#include "trebsweep/job/variable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "trebsweep/job/key.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

constexpr const char* release_angle = "solver.release-angle";
constexpr const char* pin_angle = "solver.pin-angle";

/// The key with a name, if it can be a variable; otherwise null.
const Key* find_key(const std::string& name) {
  const auto has_name = [&](const Key& key) {
    const bool is_number = key.number || key.name == release_angle || key.name == pin_angle;
    return is_number && key.name.substr(key.name.find('.') + 1) == name;
  };
  const auto found = std::ranges::find_if(job_keys(), has_name);
  return found == job_keys().end() ? nullptr : &*found;
}

/// The number that a text gives a key. Throws InputError if the key does not allow it.
double number_of(const Key& key, const std::string& text) {
  Job job;
  key.set(job, text);
  if (key.number) return key.number(job.scene);
  return key.name == pin_angle ? job.solver.pin_angle.value() : job.solver.release_angle;
}

}  // namespace

Variable to_variable(const std::string& key, const std::string& text) {
  const auto space = std::min(text.find_first_of(" \t"), text.size());
  const Key* const found = find_key(text.substr(0, space));
  if (!found)
    refuse(key, text,
           "KEY LOW:HIGH, where KEY is a numeric key of [scene], pin-angle or release-angle");
  std::vector<std::string> bounds;
  boost::split(bounds, text.substr(space), boost::is_any_of(":"));
  for (std::string& bound : bounds) boost::trim(bound);
  if (bounds.size() != 2 || std::ranges::count(bounds, "") > 0)
    refuse(key, text, "KEY LOW:HIGH, two bounds with a colon between them");
  check_units_agree(key, text, bounds);
  const Variable variable{found->name, number_of(*found, bounds[0]), number_of(*found, bounds[1])};
  if (!(variable.lower < variable.upper))
    refuse(key, text, "KEY LOW:HIGH, a lower bound below the upper one");
  return variable;
}

std::string to_text(const Variable& variable) {
  return fmt::format("{} {}:{}", variable.name(), variable.lower, variable.upper);
}

std::string unit_of(const Variable& variable) { return find_key(variable.name())->unit; }

bool allows(const Variable& variable, double value) {
  if (value >= variable.lower && value <= variable.upper) return true;
  try {
    number_of(*find_key(variable.name()), fmt::format("{}", value));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::vector<double>> corners(std::span<const Variable> variables) {
  std::vector<std::vector<double>> all;
  for (std::size_t corner = 0; corner < 1u << variables.size(); ++corner) {
    std::vector<double>& values = all.emplace_back();
    for (std::size_t i = 0; i < variables.size(); ++i)
      values.push_back(corner >> i & 1 ? variables[i].upper : variables[i].lower);
  }
  return all;
}

void set_variables(std::span<const Variable> variables, std::span<const double> values,
                   Scene& scene, Solver& solver) {
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const std::string& key = variables[i].key;
    if (key == pin_angle)
      solver.pin_angle = values[i];
    else if (key == release_angle)
      solver.release_angle = values[i];
    else
      find_key(variables[i].name())->set_number(scene, values[i]);
  }
}

}  // namespace trebsweep
