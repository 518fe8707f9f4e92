// Runs the paper's sweep with the paper's algorithm on one core, as a baseline for the program's
// run time.

#include <chrono>
#include <cstdio>

#include "support/paper_algorithm.hpp"

int main() {
  const auto start = std::chrono::steady_clock::now();
  long long designs = 0, steps = 0;
  double best = 0;
  int best1 = 0, best2 = 0, best3 = 0;
  paper::sweep([&](const paper::SwingResult& result, int i1, int i3, int i2) {
    ++designs;
    steps += result.step;
    if (result.speed <= best) return;
    best = result.speed;
    best1 = i1, best2 = i2, best3 = i3;
  });
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::printf("designs   %lld\noptimum   %.8f m/s at r1 = %.2f, r2 = %.2f, r3 = %.2f m\n", designs,
              best, best1 / 100.0, best2 / 100.0, best3 / 100.0);
  std::printf("steps     %lld\nseconds   %.2f\n", steps, time.count());
}
