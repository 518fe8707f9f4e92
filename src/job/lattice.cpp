#include "trebsweep/job/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/model/start.hpp"

namespace trebsweep {
namespace {

/// In steps: distances from a bound that are at most this long are due to rounding.
constexpr double rounding_allowance = 1e-6;

constexpr double max_cells = 1e12;
constexpr double max_axis_size = 1e7;

/// How many of the values first, first + step, ... are strictly below `end`.
double count_below(double end, double first, double step) {
  return std::max(0.0, std::ceil((end - first) / step - rounding_allowance));
}

/// An axis whose values are not stored yet. The count is a double because it may be huge.
struct AxisPlan {
  double first, step, count;

  double last() const { return first + (count - 1) * step; }
};

AxisPlan explicit_axis(const AxisRange& range) {
  const double steps = (range.last - range.first) / range.step;
  return {range.first, range.step, std::floor(steps + rounding_allowance) + 1};
}

/// The values low + step, low + 2 step, ... strictly below `high`.
AxisPlan open_interval(double low, double high, double step) {
  return {rounded_sum(low, 1, step), step, std::max(0.0, count_below(high, low, step) - 1)};
}

std::vector<double> values(const AxisPlan& plan) {
  std::vector<double> axis(static_cast<std::size_t>(plan.count));
  for (std::size_t i = 0; i < axis.size(); ++i) axis[i] = rounded_sum(plan.first, i, plan.step);
  return axis;
}

[[noreturn]] void refuse_empty(const std::string& key, double value, const std::string& why) {
  throw InputError(fmt::format("{} = {} leaves no design: {}", key, value, why));
}

AxisPlan plan_r1(const Scene& scene, const LatticeSpec& spec) {
  if (spec.r1) return explicit_axis(*spec.r1);
  const ArmBounds bounds = arm_bounds(scene);
  const AxisPlan r1 = open_interval(bounds.low, bounds.high, spec.increment);
  if (r1.count >= 1) return r1;
  const std::string allowed = fmt::format(
      "r1 must be longer than {} m and shorter than {} = {:.6g} m (47), in steps of {} m",
      bounds.low > 0 ? fmt::format("{} = {:.6g}", bounds.low_text, bounds.low) : "0",
      bounds.high_text, bounds.high, spec.increment);
  if (bounds.high <= 0)
    refuse_empty("scene.counterweight-hanger", scene.counterweight_hanger,
                 allowed + "; choose a shorter hanger or give lattice.r1");
  if (bounds.low >= bounds.high)
    refuse_empty("scene.release-height", scene.release_height,
                 fmt::format("{}; choose a height below {:.6g} m or give lattice.r1", allowed,
                             2 * bounds.high));
  refuse_empty("lattice.increment", spec.increment,
               allowed + "; choose a smaller step or give lattice.r1");
}

AxisPlan plan_r3(const Scene& scene, const LatticeSpec& spec) {
  if (spec.r3) return explicit_axis(*spec.r3);
  const double h0 = scene.fulcrum_height, shortest = spec.shortest_sling;
  const AxisPlan r3{shortest, spec.increment, count_below(h0, shortest, spec.increment)};
  if (r3.count < 1)
    refuse_empty("lattice.shortest-sling", shortest,
                 fmt::format("r3 must be shorter than h0 = {:.6g} m (48)", h0));
  return r3;
}

AxisPlan plan_r2(const Scene& scene, const LatticeSpec& spec, double shortest_r3) {
  if (spec.r2) return explicit_axis(*spec.r2);
  const double longest = scene.fulcrum_height - shortest_r3;
  const AxisPlan r2 = open_interval(0, longest, spec.increment);
  if (r2.count < 1)
    refuse_empty(spec.r3 ? "lattice.r3" : "lattice.shortest-sling", shortest_r3,
                 fmt::format("r2 must be shorter than h0 - r3 = {:.6g} m (49), in steps of {} m; "
                             "choose shorter slings or give lattice.r2",
                             longest, spec.increment));
  return r2;
}

/// The whole number of steps nearest to a length, at least one, m.
double whole_steps(double length, double step) {
  constexpr double most = 1e18;  // far more than an axis may have
  const double steps = std::clamp(std::round(length / step), 1.0, most);
  return rounded_sum(0, static_cast<std::size_t>(steps), step);
}

/// A thirtieth of the fulcrum's height, rounded up to one digit: at most some 100,000 designs.
double coarse_increment(double fulcrum_height) {
  const double least = fulcrum_height / 30, digit = std::pow(10, std::floor(std::log10(least)));
  return whole_steps(std::ceil(least / digit - rounding_allowance) * digit, digit);
}

constexpr std::array axis_names{"r1", "r3", "r2"};

/// The key that sets the step of an axis, for messages.
std::string step_key(const LatticeSpec& spec, std::size_t axis) {
  const std::array<const std::optional<AxisRange>*, 3> given{&spec.r1, &spec.r3, &spec.r2};
  const bool is_own = *given[axis] && (*given[axis])->step != spec.increment;
  return is_own ? fmt::format("lattice.{} with a step", axis_names[axis])
                : std::string("lattice.increment");
}

void check_size(const std::array<AxisPlan, 3>& plans, const LatticeSpec& spec) {
  for (std::size_t d = 0; d < 3; ++d)
    if (plans[d].count > 1 && plans[d].step < 1e-12 * plans[d].last())
      throw InputError(fmt::format(
          "{} = {}: must be at least 1e-12 of the largest {}, {} m, for distinct values",
          step_key(spec, d), plans[d].step, axis_names[d], plans[d].last()));
  const double cells = plans[0].count * plans[1].count * plans[2].count;
  const auto longest =
      std::max_element(plans.begin(), plans.end(),
                       [](const AxisPlan& a, const AxisPlan& b) { return a.count < b.count; });
  if (longest->count <= max_axis_size && cells <= max_cells) return;
  throw InputError(fmt::format(
      "{} = {} would make a lattice of {:.3g} x {:.3g} x {:.3g} (r1 x r3 x r2), {:.3g} cells; at "
      "most {:g} cells and {:g} along an axis are allowed",
      step_key(spec, static_cast<std::size_t>(longest - plans.begin())), longest->step,
      plans[0].count, plans[1].count, plans[2].count, cells, max_cells, max_axis_size));
}

}  // namespace

ArmBounds arm_bounds(const Scene& scene) {
  const double h0 = scene.fulcrum_height, r4 = scene.counterweight_hanger;
  const double rise = starts_at_release_height(scene) ? std::max(0.0, start_height(scene)) : 0;
  const char* const risen = r4 > 0 ? "h - h0 + r4" : "h - h0";
  return {rise, h0 - r4, rise > 0 ? risen : "0", r4 > 0 ? "h0 - r4" : "h0"};
}

AxisRange trough_axis(double lowest, double highest, double step) {
  return {whole_steps(0.4 * lowest, step), whole_steps(2.2 * highest, step), step};
}

LatticeSpec with_trough_axes(LatticeSpec spec, bool has_increment, double lowest, double highest) {
  if (spec.r3 && spec.r2) return spec;
  if (!has_increment) spec.increment = coarse_increment(highest);
  for (auto* const axis : {&spec.r3, &spec.r2})
    if (!*axis) *axis = trough_axis(lowest, highest, spec.increment);
  return spec;
}

Lattice::Lattice(const Scene& scene, const LatticeSpec& spec) {
  const AxisPlan r1 = plan_r1(scene, spec), r3 = plan_r3(scene, spec);
  const AxisPlan r2 = plan_r2(scene, spec, r3.first);
  check_size({r1, r3, r2}, spec);

  axes_ = std::make_shared<const LatticeAxes>(LatticeAxes{values(r1), values(r3), values(r2)});
  r1_.resize(axes()[0].size());
  std::iota(r1_.begin(), r1_.end(), std::size_t{0});
  row_length_.reserve(axes()[1].size());
  for (const double sling : axes()[1]) {
    const double count =
        spec.r2 ? r2.count : open_interval(0, scene.fulcrum_height - sling, spec.increment).count;
    row_length_.push_back(static_cast<std::size_t>(count));
  }
}

void Lattice::extend_to(std::shared_ptr<const LatticeAxes> box) {
  const std::vector<double>& r1 = (*box)[0];
  for (std::size_t& i : r1_)
    i = static_cast<std::size_t>(std::ranges::lower_bound(r1, axes()[0][i]) - r1.begin());
  row_length_.resize((*box)[1].size(), 0);
  axes_ = std::move(box);
}

std::uint64_t Lattice::designs() const { return designs_in({{0, 0, 0}, extent()}); }

Index3 Lattice::index_of(const Design<double>& design) const {
  const auto index_along = [&](std::size_t axis, double value) {
    const auto& values = axes()[axis];
    return static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), value) -
                                    values.begin());
  };
  return {index_along(0, design.r1), index_along(1, design.r3), index_along(2, design.r2)};
}

std::uint64_t Lattice::designs_in(const Block& block) const {
  std::uint64_t plane = 0;
  for (std::size_t i = 0; i < block.count[1]; ++i) {
    const std::size_t length = row_length_[block.first[1] + i];
    if (length > block.first[2]) plane += std::min(length - block.first[2], block.count[2]);
  }
  const auto planes = std::ranges::lower_bound(r1_, block.first[0] + block.count[0]) -
                      std::ranges::lower_bound(r1_, block.first[0]);
  return static_cast<std::uint64_t>(planes) * plane;
}

}  // namespace trebsweep
