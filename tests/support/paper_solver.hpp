#pragma once

#include "trebsweep/ode/solver.hpp"

/// The paper's solver: forward Euler with a step of 0.01 s and its release window.
inline trebsweep::Solver paper_solver() {
  trebsweep::Solver solver;
  solver.stepper = "euler";
  solver.release = trebsweep::Release::window;
  return solver;
}
