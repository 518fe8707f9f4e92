// Compiled once for each instruction set.

#include "trebsweep/simd/pack.hpp"

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "support/catch.hpp"
#include "trebsweep/simd/sin_cos.hpp"

using namespace trebsweep;

namespace {

using One = Pack<1>;

/// |x - truth| in units of the last place of a double of that size.
double ulps(double x, long double truth) {
  int exponent;
  std::frexp(static_cast<double>(truth), &exponent);
  return static_cast<double>(std::abs(x - truth)) / std::ldexp(1, exponent - 53);
}

}  // namespace

TEST_CASE("Sine and cosine are within 2 ULP") {
  std::mt19937_64 random(1);
  double worst = 0;
  const auto check = [&](double x) {
    const auto [sin_x, cos_x] = sin_cos(One(x));
    worst = std::max({worst, ulps(sin_x[0], std::sin(static_cast<long double>(x))),
                      ulps(cos_x[0], std::cos(static_cast<long double>(x)))});
  };
  const double eighth = boost::math::double_constants::pi / 8;
  for (const double range : {0.5, 10.0, 1e5})
    for (int i = 0; i < 3000; ++i) {
      const double x = std::uniform_real_distribution<double>(-range, range)(random);
      const double near = std::uniform_real_distribution<double>(-0.01, 0.01)(random);
      check(x);
      check(std::round(x / eighth) * eighth + near * near);   // near the zeros
      check((std::floor(x / eighth) + 0.5) * eighth + near);  // where the table index changes
    }
  CHECK(worst <= 2);
  CHECK(worst > 0.4);
}

TEST_CASE("Sine and cosine are NaN if the argument is not finite") {
  for (const double x : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    CHECK(std::isnan(sin_cos(One(x)).sin[0]));
    CHECK(std::isnan(sin_cos(One(x)).cos[0]));
  }
}

TEST_CASE("A rough power has a relative error below 2 %") {
  for (double a = 1e-12; a < 1e12; a *= 1.37)
    for (const double e : {-0.2, -0.125, 1.0 / 9})
      CHECK(rough_power(One(a), One(3.0), e)[0] == Approx(std::pow(a / 3, e)).epsilon(0.02));
}

TEST_CASE("A product followed by an addition is one fused multiply-add where the machine has it") {
  const double a = 1 + 0x1p-30, b = 1 - 0x1p-30;
  const double exact = -0x1p-60;  // a b - 1; rounded before the subtraction it is 0
  const double expected = has_fused_multiply_add ? exact : 0;
  CHECK((One(a) * One(b) - One(1))[0] == expected);
  CHECK((One(1) - One(a) * One(b))[0] == -expected);
}
