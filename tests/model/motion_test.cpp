#include "trebsweep/model/motion.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using namespace trebsweep::test;
namespace autodiff = boost::math::differentiation;

namespace {

/// The height of the projectile as a function of phi1 and phi2, with derivatives.
template <Effects E>
auto height(const Sample<E>& s) {
  const auto q = autodiff::make_ftuple<double, 2, 2>(s.x[phi1], s.x[phi2]);
  return positions(s.scene, s.design, std::get<0>(q), std::get<1>(q), s.q3()).y3;
}

/// The accelerations of phi1, phi2 and the third coordinate by Lagrange: sum_j L_{v_i v_j} a_j =
/// Q_i + L_{q_i} - sum_j L_{v_i q_j} v_j, with derivatives by automatic differentiation. Q includes
/// the force `normal` of the trough on the projectile, N.
template <Effects E>
std::array<double, 3> accelerations(const Sample<E>& sample, double normal) {
  const auto& x = sample.x;
  const std::array<double, 3> v{x[w1], x[w2], sample.v3()};
  const auto variables = autodiff::make_ftuple<double, 1, 1, 1, 2, 2, 2>(
      x[phi1], x[phi2], sample.q3(), v[0], v[1], v[2]);
  const auto L = lagrangian(sample.scene, sample.design, std::get<0>(variables),
                            std::get<1>(variables), std::get<2>(variables), std::get<3>(variables),
                            std::get<4>(variables), std::get<5>(variables));
  const auto derivative = [&](const std::array<int, 6>& d) {
    return L.derivative(d[0], d[1], d[2], d[3], d[4], d[5]);
  };
  constexpr std::size_t n = coordinates<E> / 2;
  double m[3][4] = {};
  const double friction = x[w1] > 0 ? sample.scene.pivot_friction : -sample.scene.pivot_friction;
  const auto y3 = height(sample);
  const std::array<double, 3> forces{
      -sample.scene.pivot_viscosity * x[w1] - friction + normal * y3.derivative(1, 0),
      normal * y3.derivative(0, 1), -sample.tension()};
  for (std::size_t i = 0; i < n; ++i) {
    std::array<int, 6> qi{}, vi{};
    qi[i] = 1;
    vi[3 + i] = 1;
    m[i][n] = forces[i] + derivative(qi);
    for (std::size_t j = 0; j < 3; ++j) {
      auto vq = vi, vv = vi;
      vq[j] += 1;
      vv[3 + j] += 1;
      m[i][n] -= derivative(vq) * v[j];
      if (j < n) m[i][j] = derivative(vv);
    }
  }
  // Gauss-Jordan elimination; the mass matrix is positive definite.
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i) continue;
      const double factor = m[k][i] / m[i][i];
      for (std::size_t j = i; j <= n; ++j) m[k][j] -= factor * m[i][j];
    }
  std::array<double, 3> a{};
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i][n] / m[i][i];
  return a;
}

/// Requires that the rates are those of Lagrange's equations with a force `normal` of the trough,
/// N.
template <Effects E>
void require_lagrange(const Sample<E>& sample, const State<double, E>& dxdt, double normal) {
  const auto expected = accelerations(sample, normal);
  // Terms cancel in some states, so that errors are relative to the largest term.
  const double force = sample.tension() / sample.scene.projectile_mass +
                       std::abs(normal) / sample.scene.projectile_mass;
  const double scale = 1 + force + std::abs(expected[0]) + std::abs(expected[1]);
  REQUIRE(dxdt[phi1] == sample.x[w1]);
  REQUIRE(dxdt[phi2] == sample.x[w2]);
  REQUIRE(std::abs(dxdt[w1] - expected[0]) < 1e-10 * scale);
  REQUIRE(std::abs(dxdt[w2] - expected[1]) < 1e-10 * scale);
  if constexpr (coordinates<E> == 6) {
    REQUIRE(dxdt[4] == sample.x[5]);
    REQUIRE(std::abs(dxdt[5] - expected[2]) < 1e-10 * (scale + std::abs(expected[2])));
  }
}

template <Effects E>
void set_to_rest(Sample<E>& sample) {
  for (std::size_t k = 0; k < sample.x.size(); ++k)
    if (is_rate(k)) sample.x[k] = 0;
}

}  // namespace

TEST_CASE("The equations of motion are those of the Lagrangian for every combination of effects",
          "[slow]") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(20100101);
    for (int i = 0; i < 1000; ++i) {
      const auto sample = random_sample<E>(random);
      require_lagrange(sample, rates(sample), normal_force(sample));
    }
  });
}

TEST_CASE("The height of a projectile in the trough does not accelerate in any state") {
  for_all_effects([]<Effects E>() {
    if constexpr (E.trough) {
      std::mt19937 random(20100102);
      for (int i = 0; i < 1000; ++i) {
        const auto sample = random_sample<E>(random);
        const auto dxdt = rates(sample);
        const auto y3 = height(sample);
        const double a = sample.x[w1], b = sample.x[w2];
        const double whirl = y3.derivative(2, 0) * a * a + y3.derivative(0, 2) * b * b;
        const double first = y3.derivative(1, 0) * dxdt[w1];
        const double second = y3.derivative(0, 1) * dxdt[w2];
        const double scale = std::abs(whirl) + std::abs(first) + std::abs(second);
        REQUIRE(std::abs(whirl + first + second) < 1e-10 * scale);
      }
    }
  });
}

TEST_CASE("After lift-off the machine moves as one without a trough, bit for bit") {
  for_all_effects([]<Effects E>() {
    if constexpr (E.trough) {
      constexpr Effects without{E.pivot, E.elastic, E.hanger, false};
      std::mt19937 random(20100103);
      for (int i = 0; i < 1000; ++i) {
        auto sample = random_sample<E>(random);
        if (i % 4 == 0) set_to_rest(sample);
        auto lifted = motion(sample);
        REQUIRE(lifted.sliding() == 1);
        lifted.set_sliding(0);
        State<double, E> dxdt, expected;
        lifted(sample.x, dxdt, 0);
        Motion<double, without>(sample.scene, sample.design)(sample.x, expected, 0);
        REQUIRE(dxdt == expected);
        REQUIRE(lifted.normal_force(sample.x, directions<E>(sample.x)) == 0);
        if (sample.x[w1] != 0) require_lagrange(sample, dxdt, 0);
      }
    }
  });
}

TEST_CASE("In units of h, rates are multiplied by h, accelerations and normal force by h^2") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(20100104);
    for (int i = 0; i < 100; ++i) {
      auto sample = random_sample<E>(random);
      if (i % 2 == 0) {  // held by friction, if there is any
        set_to_rest(sample);
        sample.scene.pivot_friction = 1e6;
      }
      const double h = 0x1p-6;  // multiplies without rounding
      auto x = sample.x;
      for (std::size_t k = 0; k < x.size(); ++k)
        if (is_rate(k)) x[k] *= h;
      const auto scaled = motion(sample).in_units_of(h);
      auto expected = rates(sample);
      for (std::size_t k = 0; k < x.size(); ++k) expected[k] *= is_rate(k) ? h * h : h;
      State<double, E> dxdt;
      scaled(x, dxdt, 0);
      REQUIRE(dxdt == expected);
      REQUIRE(scaled.normal_force(x, directions<E>(x)) == h * h * normal_force(sample));
    }
  });
}

TEST_CASE("A measured beam with the numbers of a computed one moves and loads the axle alike") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(20100105);
    for (int i = 0; i < 100; ++i) {
      auto computed = random_sample<E>(random);
      computed.scene = with_computed_beam(computed.scene);
      auto measured = computed;
      const Beam b = beam(computed.scene, computed.design);
      measured.scene.beam_mass = b.mass;
      measured.scene.beam_centre = -b.moment / b.mass;
      measured.scene.beam_moment = b.inertia;
      measured.scene.beam_density = 1e4;  // without effect
      const auto a = rates(measured), expected = rates(computed);
      const double normal = normal_force(computed);
      double scale = 1 + (computed.tension() + std::abs(normal)) / computed.scene.projectile_mass;
      for (const double rate : expected) scale += std::abs(rate);
      for (std::size_t k = 0; k < a.size(); ++k)
        REQUIRE(std::abs(a[k] - expected[k]) < 1e-11 * scale);
      const auto axle = [&](const Sample<E>& s) {
        return Mechanism<double, E>(s.scene, s.design)
            .loads(s.x, directions<E>(s.x), rates(s), normal_force(s))
            .axle;
      };
      REQUIRE(axle(measured) == Approx(axle(computed)).epsilon(1e-9));
    }
  });
}

TEST_CASE("Lengths times L, times times sqrt(L) and masses times k scale the motion") {
  const double L = 1.7, t = std::sqrt(L), k = 5.3;
  for_all_effects([=]<Effects E>() {
    std::mt19937 random(20100106);
    for (int i = 0; i < 100; ++i) {
      const auto sample = random_sample<E>(random);
      auto scaled = sample;
      Scene& s = scaled.scene;
      for (double* mass : {&s.counterweight_mass, &s.projectile_mass, &s.sling_mass}) *mass *= k;
      for (double* metres : {&s.beam_side, &s.counterweight_hanger, &s.trough_height}) *metres *= L;
      if (s.beam_width) {
        *s.beam_width *= L;
        *s.beam_depth *= L;
      }
      s.counterweight_inertia *= k * L * L;
      s.beam_density *= k / (L * L * L);
      if (s.beam_mass) {
        *s.beam_mass *= k;
        *s.beam_centre *= L;
        *s.beam_moment *= k * L * L;
      }
      s.pivot_friction *= k * L;
      s.pivot_viscosity *= k * L * t;
      s.sling_stiffness *= k / L;
      s.sling_damping *= k / t;
      scaled.design = {L * sample.design.r1, L * sample.design.r3, L * sample.design.r2};
      std::array<double, 6> unit{1, 1, 1 / t, 1 / t, 1, 1 / t};
      if (E.elastic) unit[length] = L, unit[stretching] = t;
      for (std::size_t c = 0; c < scaled.x.size(); ++c) scaled.x[c] *= unit[c];
      const auto dxdt = rates(scaled), expected = rates(sample);
      const double normal = normal_force(sample);
      double scale = 1 + (sample.tension() + std::abs(normal)) / sample.scene.projectile_mass;
      for (const double rate : expected) scale += std::abs(rate);
      for (std::size_t c = 0; c < dxdt.size(); ++c)
        REQUIRE(std::abs(dxdt[c] * t / unit[c] - expected[c]) < 1e-11 * scale);
      REQUIRE(std::abs(normal_force(scaled) / k - normal) <
              1e-11 * scale * sample.scene.projectile_mass);
    }
  });
}

TEST_CASE("Dry friction holds a beam at rest against a smaller torque and slows a rotating one") {
  constexpr Effects E{.pivot = true};
  Scene scene;
  const Design<double> design{0.51, 0.58, 0.91};
  const auto acceleration = [&](double friction, double rate) {
    scene.pivot_friction = friction;
    State<double, E> dxdt;
    Motion<double, E>(scene, design)({1.0, 0.0, rate, 0.0}, dxdt, 0);
    return dxdt[w1];
  };
  const double free = acceleration(0, 0);
  REQUIRE(free > 0);
  // At rest, the torque on the beam is its acceleration times the moment of inertia.
  const double inertia = 1 / (acceleration(0, 1) - acceleration(1, 1));
  const double torque = free * inertia;
  CHECK(acceleration(1.001 * torque, 0) == 0);
  CHECK(acceleration(0.75 * torque, 0) == Approx(free / 4));
  CHECK(acceleration(100, 0.1) < acceleration(0, 0.1));
  CHECK(acceleration(100, -0.1) > acceleration(0, -0.1));
}

TEST_CASE("Dry friction holds a beam whose projectile the trough carries, against its torque") {
  for_all_effects([]<Effects E>() {
    if constexpr (E.pivot && E.trough) {
      std::mt19937 random(20100107);
      for (int i = 0; i < 200; ++i) {
        auto s = random_sample<E>(random);
        s.x[phi1] = std::uniform_real_distribution<double>(0.1, 3)(random);
        s.x[phi2] = std::uniform_real_distribution<double>(-1.5, -0.1)(random);
        s.x[w1] = s.x[w2] = 0;
        if constexpr (E.hanger) s.x[phi3] = s.x[w3] = 0;
        // Statics: the trough carries the projectile and half the sling; the rest hangs on the
        // beam.
        const Scene& scene = s.scene;
        const Design<double>& d = s.design;
        const double lever =
            scene.counterweight_mass * d.r1 + beam(scene, d).moment - scene.sling_mass / 2 * d.r2;
        const double torque = scene.gravity * lever * std::sin(s.x[phi1]);
        const double carried = scene.gravity * (scene.projectile_mass + scene.sling_mass / 2);
        const auto acceleration = [&](double friction) {
          s.scene.pivot_friction = friction * std::abs(torque);
          return rates(s)[w1];
        };
        const double free = acceleration(0);
        REQUIRE(free * torque > 0);
        REQUIRE(acceleration(0.75) == Approx(free / 4).epsilon(1e-9));
        REQUIRE(acceleration(0.999) == Approx(free / 1000).epsilon(1e-9));
        // Exactly at rest, since dry friction would amplify a rounding error.
        REQUIRE(acceleration(1.001) == 0);
        REQUIRE(rates(s) == State<double, E>{});
        REQUIRE(normal_force(s) == Approx(carried).epsilon(1e-15));
      }
    }
  });
}

TEST_CASE("An elastic sling that is not stretched has no tension") {
  constexpr Effects E{.elastic = true};
  Scene scene;
  scene.sling_stiffness = 1e5;
  scene.sling_damping = 1e3;
  State<double, E> dxdt;
  Motion<double, E>(scene, {0.51, 0.58, 0.91})({1, 0, 0, 0, 0.57, 2}, dxdt, 0);
  CHECK(dxdt[stretching] == Approx(9.8 + 0.91 * std::sin(1.0) * dxdt[w1]));  // falls freely
}
