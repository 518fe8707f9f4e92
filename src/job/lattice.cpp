#include "trebsweep/job/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>

#include "trebsweep/base/error.hpp"

namespace trebsweep {
namespace {

/// Roundings of the bounds are told from designs by this part of a step.
constexpr double slack = 1e-6;

constexpr double most_designs = 1e12;
constexpr double longest_axis = 1e7;

/// first + i * step, rounded to 15 digits: 0.51 is then the same number here, in a job file that
/// gives it as a single value, and in the user's ds.sel(r1=0.51).
double value_at(double first, double step, std::size_t i) {
  if (i == 0) return first;
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), first + static_cast<double>(i) * step,
                                 std::chars_format::general, 15)
                       .ptr;
  double value = 0;
  std::from_chars(text.begin(), end, value);
  return value;
}

/// How many values of first, first + step, ... lie strictly below `end`.
double count_below(double end, double first, double step) {
  return std::max(0.0, std::ceil((end - first) / step - slack));
}

/// An axis as it will be, before its values are stored.
struct Plan {
  double first, step, count;

  double last() const { return first + (count - 1) * step; }
};

Plan by_hand(const AxisRange& range) {
  return {range.first, range.step, std::floor((range.last - range.first) / range.step + slack) + 1};
}

/// The first value strictly above `low`, in steps from it.
Plan between(double low, double high, double step) {
  return {value_at(low, step, 1), step, std::max(0.0, count_below(high, low, step) - 1)};
}

std::vector<double> values(const Plan& plan) {
  std::vector<double> axis(static_cast<std::size_t>(plan.count));
  for (std::size_t i = 0; i < axis.size(); ++i) axis[i] = value_at(plan.first, plan.step, i);
  return axis;
}

constexpr std::array axis_names{"r1", "r3", "r2"};

/// The key that sets the step of an axis, for messages.
std::string step_key(const LatticeSpec& spec, std::size_t axis) {
  const std::array<const std::optional<AxisRange>*, 3> given{&spec.r1, &spec.r3, &spec.r2};
  return *given[axis] ? fmt::format("lattice.{} with a step", axis_names[axis])
                      : std::string("lattice.increment");
}

void check_size(const std::array<Plan, 3>& plans, const LatticeSpec& spec) {
  for (std::size_t d = 0; d < 3; ++d)
    if (plans[d].count > 1 && plans[d].step < 1e-12 * plans[d].last())
      throw InputError(fmt::format(
          "{} = {}: must be at least 1e-12 of the largest {}, {} m, to tell values apart",
          step_key(spec, d), plans[d].step, axis_names[d], plans[d].last()));
  const double cells = plans[0].count * plans[1].count * plans[2].count;
  const auto longest = std::max_element(
      plans.begin(), plans.end(), [](const Plan& a, const Plan& b) { return a.count < b.count; });
  if (longest->count <= longest_axis && cells <= most_designs) return;
  throw InputError(fmt::format(
      "{} = {} would make a lattice of {:.3g} x {:.3g} x {:.3g} (r1 x r3 x r2), {:.3g} cells; at "
      "most {:g} cells and {:g} along an axis are allowed",
      step_key(spec, static_cast<std::size_t>(longest - plans.begin())), longest->step,
      plans[0].count, plans[1].count, plans[2].count, cells, most_designs, longest_axis));
}

[[noreturn]] void throw_empty(const std::string& key, double value, const std::string& why) {
  throw InputError(fmt::format("{} = {} leaves no design: {}", key, value, why));
}

}  // namespace

Lattice::Lattice(const Scene& scene, const LatticeSpec& spec) {
  const double h0 = scene.fulcrum_height;
  const double lowest = std::max(0.0, scene.release_height - h0);
  const double dr = spec.increment;

  const Plan r1 = spec.r1 ? by_hand(*spec.r1) : between(lowest, h0, dr);
  if (r1.count < 1) {
    const bool too_high = lowest >= h0;
    throw_empty(
        too_high ? "scene.release-height" : "lattice.increment",
        too_high ? scene.release_height : dr,
        fmt::format("r1 must be longer than h - h0 = {:.6g} m and shorter than h0 = {:.6g} m "
                    "(47), in steps of {} m; {} or give lattice.r1",
                    lowest, h0, dr,
                    too_high ? fmt::format("choose a height below {:.6g} m", 2 * h0)
                             : std::string("choose a smaller step")));
  }
  const double shortest = spec.shortest_sling;
  const Plan r3 = spec.r3 ? by_hand(*spec.r3) : Plan{shortest, dr, count_below(h0, shortest, dr)};
  if (r3.count < 1)
    throw_empty("lattice.shortest-sling", shortest,
                fmt::format("r3 must be shorter than h0 = {:.6g} m (48)", h0));
  const Plan r2 = spec.r2 ? by_hand(*spec.r2) : between(0, h0 - r3.first, dr);
  if (r2.count < 1)
    throw_empty(spec.r3 ? "lattice.r3" : "lattice.shortest-sling", r3.first,
                fmt::format("r2 must be shorter than h0 - r3 = {:.6g} m (49), in steps of {} m; "
                            "choose shorter slings or give lattice.r2",
                            h0 - r3.first, dr));
  check_size({r1, r3, r2}, spec);

  axes_ = {values(r1), values(r3), values(r2)};
  row_.reserve(axes_[1].size());
  for (const double sling : axes_[1])
    row_.push_back(spec.r2 ? axes_[2].size()
                           : static_cast<std::size_t>(between(0, h0 - sling, dr).count));
}

std::uint64_t Lattice::designs() const {
  return axes_[0].size() * std::accumulate(row_.begin(), row_.end(), std::uint64_t{0});
}

std::uint64_t Lattice::designs_in(const Tile& tile) const {
  std::uint64_t plane = 0;
  for (std::size_t i = 0; i < tile.count[1]; ++i) {
    const std::size_t row = row_[tile.first[1] + i];
    if (row > tile.first[2]) plane += std::min(row - tile.first[2], tile.count[2]);
  }
  return tile.count[0] * plane;
}

Tiling::Tiling(const Lattice& lattice, const Index3& edge)
    : extent_(lattice.extent()), edge_(edge) {
  first_in_row_.push_back(0);
  for (std::size_t i3 = 0; i3 < extent_[1]; i3 += edge_[1]) {
    // Rows never grow with r3: a tile holds a design if its lowest corner does.
    std::size_t tiles = 0;
    for (std::size_t i2 = 0; i2 < extent_[2] && lattice.holds({0, i3, i2}); i2 += edge_[2]) ++tiles;
    first_in_row_.push_back(first_in_row_.back() + tiles);
  }
}

std::uint64_t Tiling::size() const {
  return (extent_[0] + edge_[0] - 1) / edge_[0] * first_in_row_.back();
}

Tile Tiling::tile(std::uint64_t number) const {
  const std::uint64_t plane = number / first_in_row_.back();
  const std::uint64_t in_plane = number % first_in_row_.back();
  const auto next_row = std::upper_bound(first_in_row_.begin(), first_in_row_.end(), in_plane);
  const auto row = static_cast<std::size_t>(next_row - first_in_row_.begin()) - 1;

  Tile tile{{plane * edge_[0], row * edge_[1], (in_plane - first_in_row_[row]) * edge_[2]}, edge_};
  for (std::size_t d = 0; d < 3; ++d)
    tile.count[d] = std::min(tile.count[d], extent_[d] - tile.first[d]);
  return tile;
}

}  // namespace trebsweep
