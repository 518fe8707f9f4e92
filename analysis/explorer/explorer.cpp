// The WebAssembly module of the explorer: the equations, steppers and swings of the numerical core,
// called with numbers in shared arrays. Scene and solver are set key by key.

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/integrate_packs.hpp"
#include "trebsweep/swing/load_samples.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Scene scene;
Solver solver;

Scene& owner(Scene*) { return scene; }
Solver& owner(Solver*) { return solver; }

/// The object that a pointer to a member of Scene or Solver selects.
template <class Section, class T>
T& selected(T Section::*member) {
  return owner(static_cast<Section*>(nullptr)).*member;
}

template <class T>
double number_of(const T& value) {
  return static_cast<double>(value);
}
double number_of(const std::optional<double>& value) { return value.value_or(nan); }

/// A key of a job as a number: yes and no are 1 and 0, a name its index, a missing value NaN.
struct Key {
  std::string_view name;
  double (*get)();
  void (*set)(double);
};

template <auto member>
constexpr Key key(std::string_view name) {
  return {name, [] { return number_of(selected(member)); },
          [](double x) {
            auto& value = selected(member);
            using T = std::remove_reference_t<decltype(value)>;
            if constexpr (std::is_same_v<T, std::optional<double>>)
              value = std::isnan(x) ? std::nullopt : std::optional(x);
            else
              value = static_cast<T>(x);
          }};
}

constexpr std::array keys{
    key<&Scene::gravity>("scene.gravity"),
    key<&Scene::counterweight_mass>("scene.counterweight-mass"),
    key<&Scene::projectile_mass>("scene.projectile-mass"),
    key<&Scene::release_height>("scene.release-height"),
    key<&Scene::fulcrum_height>("scene.fulcrum-height"),
    key<&Scene::beam_density>("scene.beam-density"),
    key<&Scene::beam_side>("scene.beam-side"),
    key<&Scene::beam_inertia>("scene.beam-inertia"),
    key<&Scene::sling_angle>("scene.sling-angle"),
    key<&Scene::pivot_viscosity>("scene.pivot-viscosity"),
    key<&Scene::pivot_friction>("scene.pivot-friction"),
    key<&Scene::sling_mass>("scene.sling-mass"),
    key<&Scene::sling_stiffness>("scene.sling-stiffness"),
    key<&Scene::sling_damping>("scene.sling-damping"),
    key<&Scene::beam_mass>("scene.beam-mass"),
    key<&Scene::beam_centre>("scene.beam-centre"),
    key<&Scene::beam_moment>("scene.beam-moment"),
    key<&Scene::start_angle>("scene.start-angle"),
    key<&Scene::counterweight_hanger>("scene.counterweight-hanger"),
    key<&Scene::trough>("scene.trough"),
    key<&Scene::trough_height>("scene.trough-height"),
    key<&Scene::projectile_diameter>("scene.projectile-diameter"),
    key<&Scene::drag_coefficient>("scene.drag-coefficient"),
    key<&Scene::air_density>("scene.air-density"),
    key<&Scene::wind>("scene.wind"),
    key<&Solver::release>("solver.release"),
    key<&Solver::release_angle>("solver.release-angle"),
    key<&Solver::pin_angle>("solver.pin-angle"),
    key<&Solver::max_time>("solver.max-time"),
    key<&Solver::max_steps>("solver.max-steps"),
};

constexpr std::size_t max_designs = 4096, max_fields = field_info.size();
std::array<Design<double>, max_designs> designs;
std::array<SwingResult, max_designs> results;
std::array<Field, max_fields> fields;
std::array<double, max_designs * max_fields> values;
// As engine.js reads and writes them.
static_assert(sizeof(Design<double>) == 3 * sizeof(double) && sizeof(Field) == 4);
static_assert(sizeof(SwingResult) == 32 && offsetof(SwingResult, speed) == 0 &&
              offsetof(SwingResult, release_time) == 8 && offsetof(SwingResult, steps) == 16 &&
              offsetof(SwingResult, status) == 24 && sizeof(Status) == 1);

/// A row of a trace; the units are those of `trebsweep trace`.
struct Row {
  double t, phi1, phi2, phi3, x1, y1, xh, yh, xt, yt, x3, y3, speed, energy, tension, tip_tension,
      axle, stress, hanger_tension, normal;
};
constexpr std::string_view row_names =
    "t phi1 phi2 phi3 x1 y1 xh yh xt yt x3 y3 speed energy tension tip_tension axle stress "
    "hanger_tension normal";
constexpr std::size_t max_rows = 1000;
std::array<Row, max_rows> rows;

/// A row of a flight: position and velocity relative to the foot of the fulcrum.
struct FlightRow {
  double t, x, height, vx, vy;
};
constexpr std::string_view flight_row_names = "t x height vx vy";
std::array<FlightRow, max_rows> flight_rows;
std::size_t flight_row_count;

/// One register per number: SIMD128 has sixteen, as many as a step needs for its temporaries.
using Number = Pack<1>;

template <Effects E>
using Moment = Instant<Number, E>;

template <Effects E>
struct Step {
  Moment<E> from, to;
};

/// An observer that collects the steps of a single design, if they are wanted.
template <Effects E>
struct Recorder {
  std::vector<Step<E>>* steps;

  void operator()(const Moment<E>& from, const Moment<E>& to) const {
    if (steps != nullptr) steps->push_back({from, to});
  }
};

/// AnyStepper keeps the module small: a step is compiled once, not in each place that takes one.
template <Effects E>
auto make_stepper() {
  return any_stepper<Number, E, Vern8<Number, E>>(solver);
}

/// Calls f.operator()<Effects>() with the effects of the scene. Friction of the pivot, possibly
/// zero, is always among them, which halves the module.
template <class F>
void with_compiled_effects(F f) {
  Scene with_friction = scene;
  with_friction.pivot_viscosity = 1;
  with_effects(with_friction, [&]<Effects E>() {
    if constexpr (E.pivot) f.template operator()<E>();
  });
}

/// Integrates a batch; `steps`, if not null, receives those of a single design.
template <Effects E>
void integrate_batch(const Batch& batch, std::vector<Step<E>>* steps) {
  auto stepper = make_stepper<E>();
  integrate_by<Number, E>(stepper, scene, solver, batch, Recorder<E>{steps});
}

/// The shared arrays as a batch.
Batch shared_batch(std::size_t count, std::size_t field_count) {
  return {std::span(designs).first(count), std::span(results).first(count),
          std::span(fields).first(field_count), std::span(values).first(count * field_count)};
}

template <Effects E>
Row row(const Motion<Number, E>& motion, const Mechanism<Number, E>& mechanism,
        const Moment<E>& at) {
  const auto& [t, x, directions, dxdt] = at;
  const auto loads = loads_at(motion, mechanism, at);
  const auto weight = mechanism.counterweight(x), tip = mechanism.arm_tip(x);
  const auto hinge = Number(-mechanism.design().r1 / mechanism.design().r2) * tip;
  const auto projectile = mechanism.projectile(x);
  const Number angle3 = E.hanger ? x[phi3] : Number(0);
  return {t[0],
          x[phi1][0],
          x[phi2][0],
          angle3[0],
          weight.x[0],
          weight.y[0],
          hinge.x[0],
          hinge.y[0],
          tip.x[0],
          tip.y[0],
          projectile.x[0],
          projectile.y[0],
          mechanism.speed(x)[0],
          mechanism.energy(x)[0],
          loads.projectile_tension[0],
          loads.tip_tension[0],
          loads.axle[0],
          std::abs(loads.beam_stress[0]),
          loads.hanger_tension[0],
          motion.normal_force(x, directions)[0]};
}

/// By the rules that choose the release from an interval, steps beyond it are observed before it;
/// removes them.
template <Effects E>
void keep_steps_before_release(std::vector<Step<E>>& steps) {
  const Step<E> last = steps.back();
  std::erase_if(steps, [&](const Step<E>& step) { return step.from.t[0] >= last.from.t[0]; });
  steps.push_back(last);
}

/// The time of the lift-off from the trough, s; infinite without one. The last step in the trough
/// ends with the lift-off, where the force is zero up to rounding.
template <Effects E>
double lift_off_time(const Motion<Number, E>& sliding, const std::vector<Step<E>>& steps) {
  const auto force = [&](const Moment<E>& at) {
    return sliding.normal_force(at.x, at.directions)[0];
  };
  const double weight = scene.projectile_mass * scene.gravity;
  for (const auto& [from, to] : steps) {
    if (force(from) <= 0) return from.t[0];
    if (force(to) <= 1e-6 * (weight + force(from))) return to.t[0];
  }
  return std::numeric_limits<double>::infinity();
}

/// Sets flight_rows to the flight from a release in state x at time t.
template <Effects E>
void trace_flight(const Mechanism<Number, E>& mechanism, double t, const State<Number, E>& x) {
  constexpr double tolerance = 1e-12;
  const auto position = mechanism.projectile(x), velocity = mechanism.velocity(x);
  auto at = release_into_air<double, 4>(
      {position.x[0], flight_height(scene, position)[0], velocity.x[0], velocity.y[0]});
  auto impact = at;
  fly_to_ground(scene, tolerance, impact);
  if (!std::isfinite(impact.time)) return;
  constexpr std::size_t count = 200;
  for (std::size_t i = 0; i < count; ++i) {
    if (i + 1 == count)
      at = impact;
    else
      fly_until(scene, impact.time * static_cast<double>(i) / (count - 1), tolerance, at);
    flight_rows[flight_row_count++] = {t + at.time, at.s[0], at.s[1], at.s[2], at.s[3]};
  }
}

/// Integrates designs[0], and sets `rows` to its swing at equal intervals and flight_rows to its
/// flight, if it has one. Returns the number of rows.
template <Effects E>
std::size_t trace_swing(std::size_t field_count) {
  std::vector<Step<E>> steps;
  integrate_batch<E>(shared_batch(1, field_count), &steps);
  flight_row_count = 0;
  if (steps.empty()) return 0;
  if (takes_best_moment(solver.release)) keep_steps_before_release(steps);
  const auto& [r1, r3, r2] = designs[0];
  const Design<Number> design{r1, r3, r2};
  Motion<Number, E> motion(scene, design);
  const Mechanism<Number, E> mechanism(scene, design);
  const double lift_off = E.trough ? lift_off_time(motion, steps) : 0;
  auto stepper = make_stepper<E>();
  const double end = steps.back().to.t[0];
  const auto count =
      static_cast<std::size_t>(std::clamp(end / 0.0025, 200.0, static_cast<double>(max_rows)));
  auto step = steps.begin();
  for (std::size_t i = 0; i < count; ++i) {
    const double t = end * static_cast<double>(i) / static_cast<double>(count - 1);
    while (step + 1 != steps.end() && t > step->to.t[0]) ++step;
    const double start = step->from.t[0];
    motion.set_sliding(start < lift_off ? 1 : 0);
    Moment<E> at = step->from;
    State<Number, E> error;
    if (t > start) advance(stepper, motion, step->from, Number(t - start), at, error);
    rows[i] = row(motion, mechanism, at);
  }
  if (has_speed(results[0].status)) trace_flight(mechanism, end, steps.back().to.x);
  return count;
}

std::string quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

/// The names of a list, in JSON.
template <class List, class F>
std::string json_list(const List& list, F item) {
  std::string text;
  for (const auto& element : list) text += (text.empty() ? "[" : ",") + item(element);
  return text + "]";
}

}  // namespace

extern "C" {

/// Keys, the names of their choices, statuses, fields and columns of the rows, as JSON.
[[clang::export_name("describe")]] const char* describe() {
  static const std::string text =
      "{\"keys\":" + json_list(keys, [](const Key& key) { return quoted(key.name); }) +
      ",\"statuses\":" + json_list(status_names, quoted) +
      ",\"statusMeanings\":" + json_list(status_meanings, quoted) +
      ",\"choices\":{\"scene.trough\":[\"no\",\"yes\"],\"scene.beam-inertia\":" +
      json_list(beam_inertia_names, quoted) +
      ",\"solver.release\":" + json_list(release_names, quoted) + "},\"fields\":" +
      json_list(field_info,
                [](const FieldInfo& field) {
                  return "{\"name\":" + quoted(field.name) +
                         ",\"meaning\":" + quoted(field.meaning) + "}";
                }) +
      ",\"columns\":" + quoted(row_names) + ",\"flightColumns\":" + quoted(flight_row_names) +
      ",\"maxDesigns\":" + std::to_string(max_designs) + "}";
  return text.c_str();
}

[[clang::export_name("get_key")]] double get_key(std::size_t index) { return keys[index].get(); }
[[clang::export_name("set_key")]] void set_key(std::size_t index, double value) {
  keys[index].set(value);
}

[[clang::export_name("designs_address")]] void* designs_address() { return designs.data(); }
[[clang::export_name("results_address")]] void* results_address() { return results.data(); }
[[clang::export_name("fields_address")]] void* fields_address() { return fields.data(); }
[[clang::export_name("values_address")]] void* values_address() { return values.data(); }
[[clang::export_name("rows_address")]] void* rows_address() { return rows.data(); }
[[clang::export_name("flight_address")]] void* flight_address() { return flight_rows.data(); }
[[clang::export_name("flight_count")]] std::size_t flight_count() { return flight_row_count; }

/// Integrates the first designs; see Batch for `results` and `values`.
[[clang::export_name("integrate")]] void integrate(std::size_t count, std::size_t field_count,
                                                   double tolerance) {
  solver.tolerance = tolerance;
  with_compiled_effects(
      [=]<Effects E>() { integrate_batch<E>(shared_batch(count, field_count), nullptr); });
}

/// See trace_swing().
[[clang::export_name("trace")]] std::size_t trace(std::size_t field_count, double tolerance) {
  solver.tolerance = tolerance;
  std::size_t count = 0;
  with_compiled_effects([&]<Effects E>() { count = trace_swing<E>(field_count); });
  return count;
}

}  // extern "C"

}  // namespace trebsweep

// Errors of the program itself end the module: nothing catches exceptions.
extern "C" void* __cxa_allocate_exception(std::size_t) { __builtin_trap(); }
extern "C" void __cxa_throw(void*, void*, void*) { __builtin_trap(); }
