#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trebsweep/assess/measurement.hpp"
#include "trebsweep/assess/table.hpp"

// The tables of an assessment. analysis/assess.py reads them by the names of tables and columns.
// Where a measurement was not made, its table has no columns.

namespace trebsweep {

/// Error bounds of the references.
Table reference_table(const std::vector<Case>& cases);

/// Errors and costs, a row per measurement.
Table accuracy_table(const std::string& name, const std::vector<Measurement>& measured);

/// Outcomes of the extreme cases with a single design: a row per case, a column per stepper.
Table outcome_table(const std::vector<Case>& cases, const std::vector<Measurement>& measured);

Table order_table(const Case& c, const std::vector<ConvergenceOrder>& orders);

Table stability_table(const std::vector<StepLimitMeasurement>& measured);

Table growth_table(const Case& c, const std::optional<std::vector<OscillationGrowth>>& growths);

Table lattice_table(const Case& c, const std::optional<std::vector<LatticeMeasurement>>& measured);

/// For each case that is not extreme, the fastest solver with all speed errors within `target`
/// (m/s).
Table advice_table(const std::vector<Case>& cases, const std::vector<Measurement>& measured,
                   double target);

}  // namespace trebsweep
