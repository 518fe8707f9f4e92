#include "trebsweep/swing/reference.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/swing_by.hpp"

using namespace trebsweep;

namespace {

Scene elastic_scene() {
  Scene scene;
  scene.sling_mass = 1;
  scene.sling_stiffness = 3e5;
  scene.sling_damping = 500;
  return scene;
}

/// A design whose elastic sling goes slack within a step, which fehlberg78 misses.
const Design<double> slack{0.53, 1.13, 0.25};

double speed_by(const std::string& stepper, const Scene& scene, const Design<double>& design) {
  Solver solver;
  solver.stepper = stepper;
  solver.tolerance = 1e-13;
  solver.max_steps = 100'000;
  SwingResult result;
  integrate(scene, solver, {{&design, 1}, {&result, 1}});
  return result.speed;
}

/// The speed by which a job that uses a stepper is checked.
double accurate_speed(const std::string& stepper, const Scene& scene,
                      const Design<double>& design) {
  Solver solver;
  solver.stepper = stepper;
  SwingResult result;
  integrate_accurately(scene, checking_solver(scene, solver), {{&design, 1}, {&result, 1}});
  return result.speed;
}

}  // namespace

TEST_CASE("References agree with other programs") {
  Scene scene;
  scene.gravity = 9.81;
  const Reference r = reference(scene, {0.75, 3, 4}, paper_solver());
  CHECK(r.status == Status::released);
  CHECK(r.speed == Approx(23.7371408230).margin(1e-9));
  CHECK(r.release_time == Approx(1.1364650403).margin(1e-9));
  CHECK(r.state[0] == Approx(3.14159265358979).margin(1e-13));
  CHECK(r.speed_bound < 1e-12);
  CHECK(r.time_bound < 1e-12);
}

TEST_CASE("Extended precision agrees with a reference to the last digit of a double") {
  for (const Design<double>& design : {paper_optimum, Design<double>{0.75, 3, 4}}) {
    const double truth = reference(Scene{}, design, Solver{}).speed;
    CHECK(std::abs(speed_in_extended_precision(Scene{}, design, 1e-15, Solver{}) - truth) <
          4e-16 * truth);
  }
}

TEST_CASE(
    "Where an elastic sling goes slack, speeds in extended precision and accurate ones agree") {
  const Scene scene = elastic_scene();
  const double truth = speed_by("dopri5", scene, slack);
  CHECK(std::abs(speed_by("fehlberg78", scene, slack) - truth) > 1e-6);
  CHECK(std::abs(speed_in_extended_precision(scene, slack, 1e-15, Solver{}) - truth) < 1e-11);
  for (const std::string job : {"fehlberg78", "dopri5", "vern8"})
    CHECK(std::abs(accurate_speed(job, scene, slack) - truth) < 1e-10);
}

TEST_CASE("Accurate speeds are those of another stepper than the job's") {
  for (const Scene& scene : {Scene{}, elastic_scene()})
    for (const std::string job : {"fehlberg78", "dopri5", "vern8"}) {
      const double accurate = accurate_speed(job, scene, paper_optimum);
      CHECK(accurate != speed_by(job, scene, paper_optimum));
      CHECK(std::abs(accurate - speed_by(job, scene, paper_optimum)) < 1e-10);
    }
}

namespace {

/// All fields that are quantities.
std::vector<Field> quantities() {
  std::vector<Field> fields;
  for (const FieldInfo& info : field_info)
    if (is_quantity(info.field)) fields.push_back(info.field);
  return fields;
}

std::vector<Machine> machines() {
  Machine backyard = machine("D");
  backyard.scene.counterweight_mass = 80;
  backyard.scene.projectile_mass = 1;
  backyard.scene.counterweight_hanger = 0.4;
  backyard.scene.fulcrum_height = 1.5;
  backyard.scene.start_angle = 0.8;
  backyard.scene.beam_side = 0.09;
  backyard.scene.pivot_friction = 3;
  backyard.scene.trough_height = 0.03;
  backyard.scene.projectile_diameter = 0.13;
  backyard.design = {0.607761, 1.648506, 1.769181};
  return {machine("A"), machine("B"), machine("D"), backyard, {elastic_scene(), paper_optimum}};
}

/// The accurate values of all quantities of some designs; element [f][n] is field f of design n.
std::vector<std::vector<double>> accurate_values(const Scene& scene, const Solver& solver,
                                                 const std::vector<Design<double>>& designs) {
  const auto fields = quantities();
  std::vector<SwingResult> results(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate_accurately(scene, checking_solver(scene, solver), {designs, results, fields, values});
  std::vector<std::vector<double>> of_field(fields.size());
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (std::size_t n = 0; n < designs.size(); ++n) {
      const double value = fields[f] == Field::speed          ? results[n].speed
                           : fields[f] == Field::release_time ? results[n].release_time
                                                              : values[n * fields.size() + f];
      of_field[f].push_back(value);
    }
  return of_field;
}

/// The size of a value against which errors are judged: an angle may be zero.
double size_of(Field field, double value) {
  if (info(field).units == "rad") return 1;
  // A clearance may be zero; 1 m is the size of these machines.
  return info(field).units == "m" ? std::max(1.0, std::abs(value)) : std::abs(value);
}

}  // namespace

TEST_CASE("Accurate values of all quantities agree with references to 1e-11") {
  for (const Machine& m : machines())
    for (const Release release : {Release::crossing, Release::pin, Release::fastest}) {
      Solver solver;
      solver.release = release;
      solver.pin_angle = 0.3;
      const auto fields = quantities();
      const auto references = reference_values(m.scene, m.design, solver, fields);
      const auto values = accurate_values(m.scene, solver, {m.design});
      for (std::size_t f = 0; f < fields.size(); ++f) {
        INFO(info(fields[f]).name << " of " << m.scene.counterweight_mass << " kg by rule "
                                  << release_names[static_cast<std::size_t>(release)]);
        const auto [truth, bound] = references[f];
        const double size = size_of(fields[f], truth);
        CHECK(std::abs(values[f][0] - truth) <= 1e-11 * size);
        CHECK(bound <= 1e-12 * size);
      }
    }
}

TEST_CASE("References agree with quadruple precision within their bounds", "[slow]") {
  using Quad = boost::multiprecision::cpp_bin_float_quad;
  const auto check = []<Effects E>(const Machine& m, Release release) {
    Solver solver;
    solver.release = release;
    solver.pin_angle = 0.3;
    solver.tolerance = 1e-16;
    const auto fields = quantities();
    std::vector<double> values(fields.size());
    const auto swing = swing_by(any_stepper<Quad, E, Vern8<Quad, E>>(), m.scene, m.design, solver,
                                {}, fields, values);
    const auto references = reference_values(m.scene, m.design, solver, fields);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const double truth = fields[f] == Field::speed          ? static_cast<double>(swing.speed)
                           : fields[f] == Field::release_time ? static_cast<double>(swing.t)
                                                              : values[f];
      INFO(info(fields[f]).name << " of " << m.scene.counterweight_mass << " kg");
      CHECK(std::abs(references[f].value - truth) <= references[f].bound);
    }
  };
  for (const Machine& m : machines())
    for (const Release release : {Release::crossing, Release::pin, Release::fastest})
      with_general_effects(m.scene, [&]<Effects E>() {
        // Quadruple precision takes long to compile: two of the sets, which have all terms.
        if constexpr (E.elastic || (E.hanger && E.trough)) check.operator()<E>(m, release);
      });
}

TEST_CASE("Accurate values along a line of designs are smooth to 1e-12") {
  const auto fields = quantities();
  for (const Machine& m : machines()) {
    const auto [r1, r3, r2] = m.design;
    std::vector<Design<double>> line;
    for (int i = 0; i < 400; ++i) line.push_back({r1 + 6e-6 * i, r3 - 5e-6 * i, r2 + 6e-6 * i});
    const auto values = accurate_values(m.scene, Solver{}, line);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      double roughness = 0;  // fourth differences of smooth values vanish
      const auto& v = values[f];
      for (std::size_t n = 4; n < v.size(); ++n)
        roughness = std::max(
            roughness, std::abs(v[n] - 4 * v[n - 1] + 6 * v[n - 2] - 4 * v[n - 3] + v[n - 4]));
      INFO(info(fields[f]).name << " of " << m.scene.counterweight_mass << " kg");
      CHECK(roughness <= 1e-11 * size_of(fields[f], v[0]));
    }
  }
}

TEST_CASE("The values of a reference include its speed and time of release") {
  const Reference r = reference(Scene{}, paper_optimum, Solver{});
  const auto values = reference_values(Scene{}, paper_optimum, Solver{},
                                       std::vector{Field::release_time, Field::speed});
  CHECK(values[0].value == static_cast<double>(r.release_time));
  CHECK(values[1].value == r.speed);
}

TEST_CASE("A reference without a release has a status and no speed") {
  Scene scene;
  scene.projectile_mass = 5000;
  const Reference r = reference(scene, paper_optimum, paper_solver());
  CHECK(r.status == Status::not_released);
  CHECK(std::isnan(r.speed));
  CHECK(std::isnan(r.speed_bound));
  const std::vector<Field> fields{Field::speed, Field::peak_axle_load};
  for (const auto [value, bound] : reference_values(scene, paper_optimum, paper_solver(), fields)) {
    CHECK(std::isnan(value));
    CHECK(std::isnan(bound));
  }
  CHECK(std::isnan(speed_in_extended_precision(scene, paper_optimum, 1e-13, paper_solver())));
}
