#include "trebsweep/swing/best_release.hpp"

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/sampled_swing.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = boost::math::double_constants::pi;

/// A random machine with random effects, and a time limit that some swings reach.
struct RandomSwing {
  Machine machine;
  double max_time;
};

RandomSwing random_swing(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto one_in = [&](int n) { return uniform(0, n) < 1; };
  const double size = std::exp(uniform(-1, 2));  // m
  const Design<double> design{uniform(0.5, 1.5) * size, uniform(1, 4) * size, uniform(2, 4) * size};
  Scene s;
  s.counterweight_mass = 1000 * size;
  s.projectile_mass = s.counterweight_mass / std::exp(uniform(2.5, 6));
  s.beam_density = 700;
  s.beam_side = 0.05 * size;
  s.fulcrum_height = design.r2 + design.r3;  // the projectile is never below the ground
  s.start_angle = uniform(0.3, 1.6);
  s.sling_angle = uniform(-1, 0.5);
  if (one_in(3)) {
    s.sling_stiffness = 300 * s.projectile_mass * 9.8 / (0.01 * size);
    s.sling_damping = 0.2 * std::sqrt(s.sling_stiffness * s.projectile_mass);
  } else {
    if (one_in(2)) {
      s.trough = true;
      s.trough_height =
          s.fulcrum_height - design.r2 * std::cos(*s.start_angle) - uniform(0.1, 0.9) * design.r3;
    }
    if (one_in(2)) s.counterweight_hanger = uniform(0.2, 1) * size;
  }
  // Without dry friction, which is not smooth where the arm turns back.
  if (one_in(3)) s.pivot_viscosity = 1e-2 * s.counterweight_mass * size;
  if (one_in(4)) {
    s.projectile_diameter = std::cbrt(s.projectile_mass / 1000);
    s.wind = uniform(-10, 10);
  }
  return {{s, design}, one_in(4) ? uniform(0.8, 2) * std::sqrt(size) : 1.5 * std::sqrt(size)};
}

std::vector<RandomSwing> random_swings(int n) {
  std::mt19937_64 random(1);
  std::vector<RandomSwing> swings;
  for (int i = 0; i < n; ++i) swings.push_back(random_swing(random));
  return swings;
}

/// A time over which the machine moves appreciably, s.
double time_scale(const Machine& m) { return std::sqrt(m.design.r2 / m.scene.gravity); }

template <Effects E>
double pin_angle(const Instant<double, E>& at) {
  return at.x[phi1] - at.x[phi2];
}

/// The instants of a swing after the lift-off at which a pin could release, until phi1 = 3 pi/2 or
/// max_time: those where phi1 - phi2 falls, is between -pi and pi, and has not fallen through the
/// same value before. None without a lift-off.
template <Effects E>
std::vector<Instant<double, E>> sample_releases(const RandomSwing& random) {
  const Machine& m = random.machine;
  SampledSwing<E> swing(m.scene, m.design, 2e-4 * time_scale(m));
  const auto time_left = [&](const Instant<double, E>& at) { return random.max_time - at.t; };
  if (!swing.slide(time_left, [](const auto&) {})) return {};
  const auto end = [&](const Instant<double, E>& at) {
    return std::min(1.5 * pi - at.x[phi1], time_left(at));
  };
  std::vector<Instant<double, E>> instants;
  std::vector<std::pair<double, double>> falls;  // from the first angle down to the second one
  const auto add = [&] {
    const double angle = pin_angle(swing.now());
    falls.back().second = angle;
    const auto was_fallen_through = [&](const auto& fall) {
      return &fall != &falls.back() && angle <= fall.first && angle >= fall.second;
    };
    if (std::abs(angle) < pi && std::ranges::none_of(falls, was_fallen_through))
      instants.push_back(swing.now());
  };
  const auto rate = [](const Instant<double, E>& at) { return at.x[w1] - at.x[w2]; };
  const auto& start = swing.now();
  bool falling = rate(start) < 0 || (rate(start) == 0 && start.dxdt[w1] < start.dxdt[w2]);
  if (falling) falls.emplace_back(pin_angle(swing.now()), pin_angle(swing.now()));
  while (end(swing.now()) > 0) {
    const bool turns = swing.step_until([&](const Instant<double, E>& at) {
      return std::min(end(at), falling ? -rate(at) : rate(at));
    });
    if (falling) add();
    if (!turns || end(swing.now()) <= 0) continue;
    falling = !falling;
    if (!falling) continue;
    falls.emplace_back(pin_angle(swing.now()), pin_angle(swing.now()));
    add();  // the start of a fall
  }
  return instants;
}

/// The largest value at the sampled instants, and the peak of the parabola through it and its
/// neighbours; NaN where there is no lift-off.
struct Largest {
  double value = NAN, parabola = NAN;
  bool at_turn = false;  ///< of phi1 - phi2, to which a pin's angle can only come close
};

template <Effects E>
Largest largest_value(const Machine& m, const std::vector<Instant<double, E>>& instants,
                      Release rule) {
  const Scene& scene = m.scene;
  const Mechanism<double, E> mechanism(scene, m.design);
  const std::size_t n = instants.size();
  if (n == 0) return {};
  const auto value = [&](std::size_t i) {
    const auto& x = instants[i].x;
    return rule == Release::fastest
               ? mechanism.speed(x)
               : flight(scene, mechanism.projectile(x), mechanism.velocity(x)).range;
  };
  std::size_t best = n - 1;
  double largest = value(best);
  const auto search = [&](std::size_t from, std::size_t to, std::size_t stride) {
    for (std::size_t i = from; i < to; i += stride)
      if (const double v = value(i); v > largest) {
        largest = v;
        best = i;
      }
  };
  // A flight through air takes long to compute: all instants only near the best of some.
  const std::size_t stride = scene.projectile_diameter > 0 && rule == Release::farthest ? 32 : 1;
  search(0, n, stride);
  if (stride > 1) search(best - std::min(best, stride), std::min(best + stride, n), 1);
  const auto& x = instants[best].x;
  if (std::abs(x[w1] - x[w2]) < 1e-9) return {largest, largest, true};
  if (best == 0 || best + 1 == n) return {largest, largest};
  const double spacing = instants[best].t - instants[best - 1].t;
  if (instants[best + 1].t - instants[best].t > 1.5 * spacing) return {largest, largest};
  const double before = value(best - 1), after = value(best + 1), rise = after - before;
  return {largest, largest + rise * rise / (8 * (2 * largest - before - after))};
}

/// The range or speed of the release by a rule that chooses the best moment; NaN without a release.
double chosen_value(const RandomSwing& random, Solver solver) {
  const auto& [scene, design] = random.machine;
  solver.max_time = random.max_time;
  SwingResult result;
  const Field field = Field::range;
  double range;
  integrate(scene, solver, {{&design, 1}, {&result, 1}, {&field, 1}, {&range, 1}});
  return solver.release == Release::fastest ? result.speed : range;
}

}  // namespace

TEST_CASE("Releases farthest and fastest have the largest range and speed of a fine sampling",
          "[slow]") {
  const auto swings = random_swings(200);
  struct Case {
    std::string stepper;
    double setting;  // a tolerance, or a step in units of a time scale
    double error;    // relative
    int exceptions;  // long steps may miss the end of the interval, or the better of two maxima
  };
  std::map<Release, std::vector<Largest>> all_truths;
  for (const RandomSwing& swing : swings)
    with_general_effects(swing.machine.scene, [&]<Effects E>() {
      const auto instants = sample_releases<E>(swing);
      for (const Release rule : {Release::farthest, Release::fastest})
        all_truths[rule].push_back(largest_value<E>(swing.machine, instants, rule));
    });
  for (const auto& [rule, truths] : all_truths) {
    for (const auto& [stepper, setting, error, exceptions] :
         {Case{"vern8", 1e-10, 1e-9, 0}, Case{"dopri5", 1e-10, 3e-9, 0},
          Case{"vern8", 8e-9, 1e-7, 0}, Case{"vern8", 1e-4, 1e-2, 2}, Case{"dopri5", 1e-4, 1e-2, 2},
          Case{"rk4", 5e-4, 1e-4, 0}}) {
      int below = 0, above = 0, missing = 0;
      double worst = 0;
      for (std::size_t i = 0; i < swings.size(); ++i) {
        const Design<double>& design = swings[i].machine.design;
        Solver solver = solver_of(stepper, setting, Solver{});
        solver.release = rule;
        if (stepper == "rk4") solver.time_step = setting * time_scale(swings[i].machine);
        const double value = chosen_value(swings[i], solver);
        const double scale = std::max(std::abs(truths[i].value), design.r2);
        INFO(stepper << " at " << setting << ", swing " << i);
        missing += std::isnan(value) != std::isnan(truths[i].value);
        const double margin = truths[i].at_turn ? 5e-6 : 0;
        below += value < truths[i].value - (error + margin) * scale;
        above += value > truths[i].parabola + (error + 2e-3) * scale;
        worst = std::max(worst, (truths[i].value - value) / scale);
      }
      INFO(stepper << " at " << setting << ", worst " << worst);
      CHECK(missing <= exceptions);
      CHECK(below <= exceptions);
      CHECK(above <= exceptions);
    }
  }
}

namespace {

SwingResult release_by_pin(const RandomSwing& random, double angle, Solver solver,
                           double* range = nullptr) {
  solver.release = Release::pin;
  solver.pin_angle = angle;
  solver.max_time = random.max_time;
  SwingResult result;
  const auto& [scene, design] = random.machine;
  constexpr std::array fields{Field::range};
  const std::size_t count = range ? 1 : 0;
  integrate(scene, solver,
            {{&design, 1}, {&result, 1}, std::span(fields).first(count), {range, count}});
  return result;
}

}  // namespace

TEST_CASE("No pin throws farther or faster than the best release, which a pin can make", "[slow]") {
  std::vector<RandomSwing> swings = random_swings(60);
  for (std::size_t i = 40; i < swings.size(); ++i)  // the projectile may pass below the ground
    swings[i].machine.scene.fulcrum_height *= 0.6;
  for (const RandomSwing& swing : swings)
    for (const Release rule : {Release::farthest, Release::fastest}) {
      Solver solver;
      solver.release = rule;
      solver.max_time = swing.max_time;
      const auto& [scene, design] = swing.machine;
      constexpr std::array fields{Field::range, Field::pin_angle};
      std::array<double, 2> values;
      SwingResult best;
      integrate(scene, solver, {{&design, 1}, {&best, 1}, fields, values});
      const bool far = rule == Release::farthest;
      const double value = far ? values[0] : best.speed;
      INFO(name_of(best.status) << ", " << release_names[static_cast<std::size_t>(rule)]);
      for (int i = 0; i < 100; ++i) {
        double range = 0;
        const auto pinned = release_by_pin(swing, -pi + 2 * pi * (i + 0.5) / 100, solver, &range);
        if (!has_speed(pinned.status) || (far && std::isnan(range))) continue;
        CHECK((far ? range : pinned.speed) <= value + 1e-7 * std::abs(value));
      }
      if (!has_speed(best.status)) continue;
      const auto pinned = release_by_pin(swing, values[1], solver);
      CHECK(pinned.speed == Approx(best.speed).epsilon(1e-7).margin(1e-8));
      CHECK(pinned.release_time == Approx(best.release_time).margin(1e-6));
    }
}

namespace {

/// The time at which phi1 - phi2 first falls to an angle after the lift-off; NaN if it does not by
/// max_time and before phi1 = 3 pi/2.
template <Effects E>
double first_fall(const RandomSwing& random, double angle) {
  const Machine& m = random.machine;
  SampledSwing<E> swing(m.scene, m.design, 2e-3 * time_scale(m));
  if (!swing.slide([&](const auto& at) { return random.max_time - at.t; }, [](const auto&) {}))
    return NAN;
  const auto goes_on = [&] {
    return swing.now().t < random.max_time && swing.now().x[phi1] < 1.5 * pi;
  };
  while (goes_on())
    if (swing.step_until([&](const auto& at) { return at.x[phi1] - at.x[phi2] - angle; }))
      return goes_on() ? swing.now().t : NAN;
  return NAN;
}

struct Minimum {
  double t, angle;
};

/// The first minimum of phi1 - phi2 after the lift-off, at which it turns back; NaN without one.
template <Effects E>
Minimum first_minimum(const RandomSwing& random) {
  const Machine& m = random.machine;
  SampledSwing<E> swing(m.scene, m.design, 2e-3 * time_scale(m));
  if (!swing.slide([&](const auto& at) { return random.max_time - at.t; }, [](const auto&) {}))
    return {NAN, NAN};
  while (swing.now().t < random.max_time && swing.now().x[phi1] < 1.5 * pi)
    if (swing.step_until([](const auto& at) { return at.x[w2] - at.x[w1]; }))
      return {swing.now().t, swing.now().x[phi1] - swing.now().x[phi2]};
  return {NAN, NAN};
}

}  // namespace

TEST_CASE("A pin releases when its angle is first fallen to after the lift-off") {
  int released = 0, unreleased = 0;
  for (RandomSwing& swing : random_swings(100)) {
    swing.max_time = std::min(swing.max_time, 5 * time_scale(swing.machine));
    for (const double angle : {0.3, 1.3, 2.3}) {
      const double time = with_general_effects(
          swing.machine.scene, [&]<Effects E>() { return first_fall<E>(swing, angle); });
      for (const Solver& solver : {solver_of("vern8", 1e-10, {}), solver_of("dopri5", 1e-9, {}),
                                   solver_of("rk4", 1e-3, {})}) {
        const SwingResult result = release_by_pin(swing, angle, solver);
        INFO(solver.stepper << ", angle " << angle << ", status " << name_of(result.status) << " "
                            << &swing);
        released += result.status == Status::released;
        unreleased += result.status == Status::not_released;
        CHECK(has_speed(result.status) == !std::isnan(time));
        if (has_speed(result.status) && !std::isnan(time))
          CHECK(result.release_time == Approx(time).margin(solver.stepper == "rk4" ? 1e-3 : 1e-6));
      }
    }
  }
  CHECK(released > 300);
  CHECK(unreleased > 100);
}

TEST_CASE("A pin releases where its angle is only grazed within a step") {
  int grazed = 0;
  for (RandomSwing& swing : random_swings(100)) {
    swing.max_time = std::min(swing.max_time, 5 * time_scale(swing.machine));
    const Minimum minimum = with_general_effects(
        swing.machine.scene, [&]<Effects E>() { return first_minimum<E>(swing); });
    if (std::isnan(minimum.t) || minimum.t < 1e-3) continue;
    for (const Solver& solver : {solver_of("vern8", 1e-11, {}), solver_of("fehlberg78", 1e-11, {}),
                                 solver_of("dopri5", 1e-10, {})}) {
      ++grazed;
      const auto touching = release_by_pin(swing, minimum.angle + 1e-6, solver);
      INFO(solver.stepper << ", status " << name_of(touching.status) << ", minimum "
                          << minimum.angle << " at " << minimum.t);
      CHECK(touching.status == Status::released);
      CHECK(touching.release_time < minimum.t + 1e-6);
      const auto missing = release_by_pin(swing, minimum.angle - 1e-6, solver);
      CHECK_FALSE(missing.release_time < minimum.t + 1e-2 * time_scale(swing.machine));
    }
  }
  CHECK(grazed > 30);
}
