#include "trebsweep/optimum/field_values.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Columns of parameters whose variables have the same values.
using Columns = std::vector<Index>;

std::vector<Columns> by_variables(const MatrixXd& parameters) {
  const auto variables = [&](Index column) {
    return std::span(parameters.col(column).data() + length_count,
                     static_cast<std::size_t>(parameters.rows() - length_count));
  };
  Columns all(static_cast<std::size_t>(parameters.cols()));
  std::iota(all.begin(), all.end(), Index{0});
  if (parameters.rows() > length_count)
    std::ranges::stable_sort(all, [&](Index a, Index b) {
      return std::ranges::lexicographical_compare(variables(a), variables(b));
    });
  std::vector<Columns> groups;
  for (const Index column : all) {
    if (groups.empty() || !std::ranges::equal(variables(groups.back().back()), variables(column)))
      groups.emplace_back();
    groups.back().push_back(column);
  }
  return groups;
}

bool are_allowed(const MachineFamily& machine, const Eigen::Ref<const Parameters>& parameters) {
  for (Index i = length_count; const Variable& variable : machine.variables)
    if (!allows(variable, parameters(i++))) return false;
  return true;
}

Solver solver_with(const MachineFamily& machine, Accuracy accuracy) {
  const Solver coarse = coarse_solver(machine.solver);  // of vern8
  return accuracy == Accuracy::check ? checking_solver(machine.scene, coarse) : coarse;
}

}  // namespace

Solver coarse_solver(const Solver& solver) { return solver_of("vern8", 1e-6, solver); }

MachineFamily family_of(const Job& job) { return {job.scene, job.solver, job.optimum.variables}; }

MachineFamily at(const MachineFamily& machine, const Eigen::Ref<const Parameters>& parameters) {
  MachineFamily varied = machine;
  set_variables(machine.variables, {parameters.data() + length_count, machine.variables.size()},
                varied.scene, varied.solver);
  return varied;
}

MatrixXd field_values(const MachineFamily& machine, Accuracy accuracy, const MatrixXd& parameters,
                      std::span<const Field> fields) {
  MatrixXd all = MatrixXd::Constant(static_cast<Index>(fields.size()), parameters.cols(),
                                    std::numeric_limits<double>::quiet_NaN());
  for (const Columns& columns : by_variables(parameters)) {
    const auto& first = parameters.col(columns.front());
    if (!are_allowed(machine, first)) continue;
    std::vector<Design<double>> designs;
    for (const Index column : columns) designs.push_back(to_design(parameters.col(column)));
    std::vector<SwingResult> swings(designs.size());
    std::vector<double> values(fields.size() * designs.size());
    const Batch batch{designs, swings, fields, values};
    const MachineFamily varied = at(machine, first);
    const Solver solver = solver_with(varied, accuracy);
    if (accuracy == Accuracy::coarse)
      integrate(varied.scene, solver, batch);
    else
      integrate_accurately(varied.scene, solver, batch);
    const Eigen::Map<const MatrixXd> found(values.data(), all.rows(), std::ssize(columns));
    for (Index i = 0; i < found.cols(); ++i)
      all.col(columns[static_cast<std::size_t>(i)]) = found.col(i);
  }
  return all;
}

void for_each_design(const MachineFamily& machine, const MatrixXd& parameters,
                     std::span<const Field> fields, const MatrixXd& values,
                     const std::function<void(Index column, const Operands&)>& f) {
  for (const Columns& columns : by_variables(parameters)) {
    const MachineFamily varied = at(machine, parameters.col(columns.front()));
    for (const Index column : columns) {
      const Design<double> design = to_design(parameters.col(column));
      f(column, {varied.scene, design, fields, {values.col(column).data(), fields.size()}});
    }
  }
}

}  // namespace trebsweep
