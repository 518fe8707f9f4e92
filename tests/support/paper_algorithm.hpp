#pragma once

#include <cmath>

/// The paper's algorithm in plain C++: forward Euler (42)-(45) applied to (40) and (36), one design
/// at a time. It shares no code with the program; tests compare the program with it, and
/// paper_serial measures its run time.
namespace paper {

struct SwingResult {
  int step;            ///< -1 if phi1 never enters the release window
  double time, speed;  ///< s, m/s
};

/// Lengths in metres.
inline SwingResult swing(double r1, double r3, double r2) {
  const double pi = 3.14159265358979323846;
  const double g = 9.8, m1 = 5000, m3 = 100, h = 2, h0 = 1.5, rho = 7850, s = 0.10, dt = 0.01;
  const double m2 = rho * s * s * (r1 + r2);
  const double r = (r2 - r1) / 2;
  const double Izz = m2 * (r1 + r2) * (r1 + r2) / 12 + m2 * r * r;

  double phi1 = std::acos((h - h0) / r1), phi2 = 0, w1 = 0, w2 = 0;
  for (int step = 1; step <= 1000; ++step) {
    const double sinD = std::sin(phi1 - phi2), cosD = std::cos(phi1 - phi2), sin2 = std::sin(phi2);
    const double a1 =
        (g * std::sin(phi1) * (m1 * r1 - m2 * r - m3 * r2) +
         m3 * r2 * (g * sin2 * cosD - r3 * w2 * w2 * sinD - r2 * w1 * w1 * cosD * sinD)) /
        (m1 * r1 * r1 + Izz + m3 * r2 * r2 * sinD * sinD);
    const double a2 = (r2 * (w1 * w1 * sinD - a1 * cosD) - g * sin2) / r3;
    phi1 += w1 * dt;
    phi2 += w2 * dt;
    w1 += a1 * dt;
    w2 += a2 * dt;
    if (std::fabs(pi - phi1) < 0.05) {
      const double v = std::sqrt(r2 * r2 * w1 * w1 + 2 * r2 * r3 * w1 * w2 * std::cos(phi1 - phi2) +
                                 r3 * r3 * w2 * w2);
      return {step, step * dt, v};
    }
  }
  return {-1, 0, 0};
}

/// Calls f(result, i1, i3, i2) for each of the 706,860 designs of (47)-(49); r1 = i1 cm, and so on.
template <class F>
void sweep(F f) {
  for (int i1 = 51; i1 < 150; ++i1)
    for (int i3 = 30; i3 < 150; ++i3)
      for (int i2 = 1; i2 < 150 - i3; ++i2)
        f(swing(i1 / 100.0, i3 / 100.0, i2 / 100.0), i1, i3, i2);
}

}  // namespace paper
