#pragma once

#include <span>
#include <string>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

/// A key that a search varies besides the lengths: a number of [scene], or an angle of [solver].
struct Variable {
  std::string key;      ///< "scene.counterweight-hanger"
  double lower, upper;  ///< bounds, included, in the unit of the key

  std::string name() const { return key.substr(key.find('.') + 1); }
};

/// The most variables that a job may have.
inline constexpr std::size_t max_variables = 8;

/// The variable with a text such as "counterweight-hanger 0.2:1", where the bounds may have units.
/// Throws InputError naming `key`, the text and what is allowed.
Variable to_variable(const std::string& key, const std::string& text);

/// The variable as in a job file.
std::string to_text(const Variable& variable);

/// The SI unit of a variable; empty if it has none.
std::string unit_of(const Variable& variable);

/// Whether the key of a variable allows a value.
bool allows(const Variable& variable, double value);

/// The values of variables at the corners of their box.
std::vector<std::vector<double>> corners(std::span<const Variable> variables);

/// Gives variables their values in a scene and a solver.
void set_variables(std::span<const Variable> variables, std::span<const double> values,
                   Scene& scene, Solver& solver);

}  // namespace trebsweep
