#include "trebsweep/archive/assessment_contents.hpp"

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

namespace trebsweep {

AssessmentContents read_assessment(const std::filesystem::path& path) {
  const hdf5::File file = untrusted::open(path);
  AssessmentContents contents{.job = untrusted::read_text(file, "job"),
                              .source = untrusted::read_text(file, "source"),
                              .history = untrusted::read_text(file, "history"),
                              .tables = {}};
  for (const std::string& name : hdf5::link_names(file))
    if (untrusted::is_printable(name)) contents.tables.push_back(name);
  return contents;
}

}  // namespace trebsweep
