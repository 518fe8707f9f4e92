// Fuzzes job files. The input is the text of a job file, then a zero byte and lines of key=value,
// the command-line options. An accepted job must be the same after a round trip through its text,
// and the tiles of its scenes must cover every design once.

#include <cstdint>
#include <cstdlib>
#include <sstream>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/tiling.hpp"

using namespace trebsweep;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

Overrides overrides_in(const std::string& lines) {
  Overrides overrides;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    const auto equals = line.find('=');
    if (equals != std::string::npos) overrides[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return overrides;
}

/// Whether the lattice of a scene takes little time: it is small, or so large that it is refused.
bool is_quick(const Scene& scene, const LatticeSpec& spec) {
  const auto is_quick_count = [](double count) { return count < 1e3 || count > 1e8; };
  for (const auto& axis : {spec.r1, spec.r3, spec.r2})
    if (!is_quick_count(axis ? (axis->last - axis->first) / axis->step
                             : scene.fulcrum_height / spec.increment))
      return false;
  return true;
}

bool is_quick(const Job& job) {
  if (count_scenes(job) > 100) return false;
  for (std::uint64_t scene = 0; scene < count_scenes(job); ++scene)
    if (!is_quick(scene_at(job, scene), job.lattice)) return false;
  return true;
}

void check_tiling(const Study& study) {
  const Index3 n = study.extent();
  const Tiling tiling(study, {(n[0] + 4) / 5, (n[1] + 4) / 5, (n[2] + 4) / 5});
  std::uint64_t covered = 0;
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    const auto [scene, block] = tiling.tile(t);
    covered += study.lattice(scene).designs_in(block);
  }
  require(covered == study.designs());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  const auto end = std::min(input.find('\0'), size);
  try {
    const Job job = parse_job(input.substr(0, end), "job.cfg",
                              overrides_in(input.substr(std::min(end + 1, size))));
    const std::string text = to_text(job);
    require(to_text(parse_job(text, "again.cfg", {})) == text);
    if (is_quick(job)) check_tiling(Study(job));
  } catch (const InputError&) {
  }
  return 0;
}
