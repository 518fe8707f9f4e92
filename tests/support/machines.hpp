#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "trebsweep/model/scene.hpp"

namespace trebsweep {

/// A scene and one design.
struct Machine {
  Scene scene;
  Design<double> design;
};

/// The optimum of the paper's lattice.
inline constexpr Design<double> paper_optimum{0.51, 0.58, 0.91};

/// Machines whose swings three independent programs have computed: A, the laboratory machine of
/// arXiv:2502.19442; A2, the same with its light projectile; B, the paper's optimum; C, B with a
/// hanger; D, a siege machine; E, D with a fixed counterweight.
inline Machine machine(const std::string& name) {
  Scene scene;
  if (name == "A" || name == "A2") {
    scene.gravity = 9.81;
    scene.counterweight_mass = 53.9;
    scene.projectile_mass = name == "A" ? 0.717 : 0.0685;
    scene.counterweight_hanger = 0.515;
    scene.beam_mass = 4.86;
    scene.beam_centre = 0.465;
    scene.beam_moment = 1.85;
    scene.fulcrum_height = 0.831;
    scene.start_angle = 0.55;
    scene.trough = true;
    return {scene, {0.25, 0.87, 0.975}};
  }
  if (name == "B" || name == "C") {
    const Design<double> design = paper_optimum;
    if (name == "C") {
      scene.start_angle = std::acos((scene.release_height - scene.fulcrum_height) / design.r1);
      scene.counterweight_hanger = 0.3;
    }
    return {scene, design};
  }
  if (name == "D" || name == "E") {
    scene.gravity = 9.81;
    scene.counterweight_mass = 6000;
    scene.projectile_mass = 60;
    scene.beam_density = 700;
    scene.beam_side = 0.3;
    scene.fulcrum_height = 5.5;
    scene.start_angle = 0.9;
    scene.counterweight_hanger = name == "D" ? 1.5 : 0;
    scene.trough = true;
    return {scene, {2, 7.5, 8}};
  }
  throw std::logic_error("no machine is named " + name);
}

}  // namespace trebsweep
