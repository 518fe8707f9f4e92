// Fuzzes job files: a text, and behind a zero byte lines of key=value as the command line gives
// them. What is accepted must come back the same from its own text, and its lattice must be dealt
// out without loss.

#include <cstdint>
#include <cstdlib>
#include <sstream>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/tiling.hpp"

using namespace trebsweep;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
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

/// Whether a lattice is refused for its size, or small enough to be made thousands of times a
/// second.
bool quick(const Job& job) {
  const LatticeSpec& spec = job.lattice;
  const auto quick_count = [](double count) { return count < 1e3 || count > 1e8; };
  for (const auto& axis : {spec.r1, spec.r3, spec.r2})
    if (!quick_count(axis ? (axis->last - axis->first) / axis->step
                          : job.scene.fulcrum_height / spec.increment))
      return false;
  return true;
}

void check(const Lattice& lattice) {
  const Index3 n = lattice.extent();
  const Tiling tiling(lattice, {(n[0] + 4) / 5, (n[1] + 4) / 5, (n[2] + 4) / 5});
  std::uint64_t dealt = 0;
  for (std::uint64_t t = 0; t < tiling.size(); ++t) dealt += lattice.designs_in(tiling.tile(t));
  require(dealt == lattice.designs());
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
    if (quick(job)) check(Lattice(job.scene, job.lattice));
  } catch (const InputError&) {
  }
  return 0;
}
