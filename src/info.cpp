#include "trebsweep/info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>
#include <stdexcept>

#include "trebsweep/archive.hpp"
#include "trebsweep/contents.hpp"
#include "trebsweep/error.hpp"
#include "trebsweep/file_lock.hpp"
#include "trebsweep/job.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// What goes on with a file that is not complete.
std::string activity(const fs::path& path) {
  const std::string final_name = fs::path(path).replace_extension();  // without .partial
  const auto writer = lock_holder(final_name + ".lock");
  return writer ? "being written by " + *writer : "interrupted; its sweep's command continues it";
}

}  // namespace

std::string describe_archive(const fs::path& given) {
  std::error_code unknown;
  const fs::path path = !fs::exists(given, unknown) && fs::exists(partial_path(given), unknown)
                            ? partial_path(given)
                            : given;
  if (!fs::exists(path, unknown))
    throw InputError(fmt::format("{}: no such file; give the path of an archive", path.string()));
  Contents contents;
  Job job;
  try {
    contents = read_contents(path);
    job = parse_job(contents.job, path, {});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}; no archive of this version, or a damaged one",
                                         path.string(), error.what()));
  }
  const bool partial = path.extension() == ".partial";
  std::string text =
      fmt::format("archive   {}, {}\n", path.string(), partial ? activity(path) : "complete");
  text += fmt::format("scene     {}\nsolver    {}\n", contents.scene, solver_text(job.solver));
  text += fmt::format("tiles     {} of {} done, of {} designs (r1 x r3 x r2)\n",
                      contents.tiles_done, contents.tiles, fmt::join(contents.tile_edge, " x "));
  text += fmt::format("lattice   {} x {} x {} (r1 x r3 x r2), {} designs\n",
                      contents.axes[0].size(), contents.axes[1].size(), contents.axes[2].size(),
                      Lattice(job.scene, job.lattice).designs());
  text += to_text(to_summary(contents.tally, contents.axes), job.output.contest);
  text += fmt::format("\nsource    {}, {}\n", contents.source, contents.kernel);
  text += "history   " + boost::replace_all_copy(contents.history, "\n", "\n          ");
  return text + "\n\n" + contents.job;
}

}  // namespace trebsweep
