#include "trebsweep/assess/assess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/layout.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/assess/assessment_tables.hpp"
#include "trebsweep/assess/cases.hpp"
#include "trebsweep/assess/measurement.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"

namespace trebsweep {
namespace {

/// Writes the tables under a temporary name, then renames the file.
void write_file(const OutputFile& output, const std::vector<Table>& tables, const Job& job,
                const AssessOptions& options, int ranks) {
  const auto path = unfinished_archive(partial_path(output.path));
  const std::string what = "write " + path.string();
  hdf5::silence();
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), what);
  hdf5::write_attribute(file, "title", "Trebuchet assessment");
  hdf5::write_attribute(file, "source", version_text());
  hdf5::write_attribute(file, "history", history_line(options.command, ranks));
  hdf5::write_attribute(file, "job", to_text(job, true));
  for (const Table& table : tables) write(file, table);
  file.close(what);
  finish_output(output);
}

}  // namespace

std::vector<Table> assess(const Job& job, const AssessOptions& options, MPI_Comm comm) {
  const Assessment& assessment = job.assess;
  const double start = MPI_Wtime();
  const bool reports = options.progress && mpi::rank(comm) == 0;
  const auto report = [&](const std::string& stage) {
    if (reports) print_message(fmt::format("{:6.1f} s  {}\n", MPI_Wtime() - start, stage));
  };
  OutputFile output;  // on rank 0 only
  mpi::on_root(comm, [&] { output = reserve_output(job, options.overwrite); });
  std::vector<Case> cases = make_cases(job, options.job_name, comm);

  report("references in extended precision");
  compute_references(cases, comm);
  std::vector<Table> tables{reference_table(cases)};

  report(fmt::format("{} steppers on {} scenes", assessment.steppers.size(), cases.size()));
  const auto measured = measure(cases, assessment, comm);
  std::vector<Measurement> regular, extreme;
  std::partition_copy(measured.begin(), measured.end(), std::back_inserter(extreme),
                      std::back_inserter(regular),
                      [](const Measurement& m) { return m.test_case->extreme; });
  tables.push_back(accuracy_table("accuracy", regular));
  tables.push_back(outcome_table(cases, extreme));
  tables.push_back(accuracy_table("extremes", extreme));
  // The table of outcomes is their printed summary.
  for (Column& column : tables.back().columns) column.printed = false;

  report("orders of convergence");
  const Case& first = cases.front();
  tables.push_back(order_table(first, measure_orders(first, assessment, comm)));

  report("stability");
  tables.push_back(stability_table(measure_step_limits(cases, assessment, comm)));
  tables.push_back(growth_table(first, measure_growth(first, assessment)));

  report("the whole lattice");
  tables.push_back(lattice_table(first, measure_lattice(first, measured, assessment, comm)));
  tables.push_back(advice_table(cases, measured, assessment.target_error));

  mpi::on_root(comm, [&] { write_file(output, tables, job, options, mpi::size(comm)); });
  report("done");
  return tables;
}

}  // namespace trebsweep
