#include "trebsweep/model/motion.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using namespace trebsweep::test;
namespace autodiff = boost::math::differentiation;

namespace {

/// The accelerations of phi1, phi2 and the sling's length by Lagrange: sum_j L_{v_i v_j} a_j = Q_i
/// + L_{q_i} - sum_j L_{v_i q_j} v_j, with derivatives by automatic differentiation.
template <Effects E>
std::array<double, 3> accelerations(const Sample<E>& sample) {
  const auto& x = sample.x;
  const std::array<double, 3> v{x[w1], x[w2], sample.sling_rate()};
  const auto variables = autodiff::make_ftuple<double, 1, 1, 1, 2, 2, 2>(
      x[phi1], x[phi2], sample.sling_length(), v[0], v[1], v[2]);
  const auto L = lagrangian(sample.scene, sample.design, std::get<0>(variables),
                            std::get<1>(variables), std::get<2>(variables), std::get<3>(variables),
                            std::get<4>(variables), std::get<5>(variables));
  const auto derivative = [&](const std::array<int, 6>& d) {
    return L.derivative(d[0], d[1], d[2], d[3], d[4], d[5]);
  };
  constexpr std::size_t n = E.elastic ? 3 : 2;
  double m[3][4] = {};
  const double friction = x[w1] > 0 ? sample.scene.pivot_friction : -sample.scene.pivot_friction;
  const std::array<double, 3> forces{-sample.scene.pivot_viscosity * x[w1] - friction, 0,
                                     -sample.tension()};
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
  for (std::size_t i = 0; i < n;
       ++i)  // Gauss-Jordan elimination; the mass matrix is positive definite
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i) continue;
      const double factor = m[k][i] / m[i][i];
      for (std::size_t j = i; j <= n; ++j) m[k][j] -= factor * m[i][j];
    }
  std::array<double, 3> a{};
  for (std::size_t i = 0; i < n; ++i) a[i] = m[i][n] / m[i][i];
  return a;
}

}  // namespace

TEST_CASE("The equations of motion are those of the Lagrangian for every combination of effects") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(20100101);
    for (int i = 0; i < 1000; ++i) {
      const auto sample = random_sample<E>(random);
      const auto dxdt = rates(sample);
      const auto expected = accelerations(sample);
      // Terms cancel in some states, so that errors are relative to the largest term.
      const double force = sample.tension() / sample.scene.projectile_mass;
      const double scale = 1 + force + std::abs(expected[0]) + std::abs(expected[1]);
      REQUIRE(dxdt[phi1] == sample.x[w1]);
      REQUIRE(dxdt[phi2] == sample.x[w2]);
      REQUIRE(std::abs(dxdt[w1] - expected[0]) < 1e-10 * scale);
      REQUIRE(std::abs(dxdt[w2] - expected[1]) < 1e-10 * scale);
      if constexpr (E.elastic) {
        REQUIRE(dxdt[length] == sample.x[stretching]);
        REQUIRE(std::abs(dxdt[stretching] - expected[2]) < 1e-10 * (scale + std::abs(expected[2])));
      }
    }
  });
}

TEST_CASE("Dry friction holds a beam at rest against a smaller torque and slows a rotating one") {
  constexpr Effects E{true, false};
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

TEST_CASE("An elastic sling that is not stretched has no tension") {
  constexpr Effects E{false, true};
  Scene scene;
  scene.sling_stiffness = 1e5;
  scene.sling_damping = 1e3;
  State<double, E> dxdt;
  Motion<double, E>(scene, {0.51, 0.58, 0.91})({1, 0, 0, 0, 0.57, 2}, dxdt, 0);
  CHECK(dxdt[stretching] == Approx(9.8 + 0.91 * std::sin(1.0) * dxdt[w1]));  // falls freely
}
