// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactCase.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GapProfile.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace Harmos {

/// Numbers between −amplitude and amplitude, the same everywhere.
inline std::vector<double> randomDesign(std::size_t size, int seed, double amplitude) {
  std::vector<double> design;
  for (std::size_t k = 0; k < size; ++k)
    design.push_back(amplitude * pseudoRandom(seed, k));
  return design;
}

inline double normOf(const std::vector<double>& v) {
  double sum = 0.0;
  for (double entry : v)
    sum += entry * entry;
  return std::sqrt(sum);
}

/// ‖a − b‖/‖b‖.
inline double differenceOf(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference;
  for (std::size_t k = 0; k < b.size(); ++k)
    difference.push_back(a[k] - b[k]);
  return normOf(difference) / normOf(b);
}

/// x + step · d.
inline std::vector<double> moved(std::vector<double> x, const std::vector<double>& d, double step) {
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] += step * d[k];
  return x;
}

inline std::vector<double> unitDesign(std::size_t size, std::size_t k) {
  std::vector<double> design(size, 0.0);
  design[k] = 1.0;
  return design;
}

/// (Φ(α + h e_k) − Φ(α − h e_k))/2h.
inline std::vector<double> centralDifferences(sensitivity::DesignFunction& function,
                                              const std::vector<double>& design, double step) {
  std::vector<double> result;
  for (std::size_t k = 0; k < design.size(); ++k) {
    const std::vector<double> direction = unitDesign(design.size(), k);
    const double above = function.value(moved(design, direction, step), 0.0),
                 below = function.value(moved(design, direction, -step), 0.0);
    result.push_back((above - below) / (2.0 * step));
  }
  return result;
}

/// pressedBlocks() whose upper end is pushed down by so much, whatever force that takes.
inline scene::Scene pushedBlocks(bool isSpace, bool onPlane, int elements, double by) {
  scene::Scene scene = pressedBlocks(isSpace, onPlane, elements);
  removeEffects(scene, "Traction");
  prescribe(scene, {static_cast<int>(scene.bodies.size()) - 1, "top"}, isSpace ? 2 : 1, -by);
  return scene;
}

/// Weights of displacements that have no pattern, the same on any number of ranks.
inline feti::TornVector randomWeights(const ContactCase& problem, int seed) {
  feti::TornVector weights = problem.solver->system().zeroVector();
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t j = 0; j < weights[i].size(); ++j)
      weights[i][j] = pseudoRandom(seed, j + 1000 * static_cast<std::size_t>(problem.owned[i].number));
  return weights;
}

/// Functionals of each kind, by their names.
inline std::vector<std::pair<std::string, std::shared_ptr<sensitivity::Functional>>>
functionalsOf(const ContactCase& problem, int surface) {
  const std::set<int> surfaces = {surface};
  return {{"energy", std::make_shared<sensitivity::Energy>()},
          {"norm", std::make_shared<sensitivity::PressureNorm>(surfaces, 6.0)},
          {"spread", std::make_shared<sensitivity::PressureSpread>(surfaces)},
          {"resultant", std::make_shared<sensitivity::Resultant>(surfaces, fem::Point{1.0, 0.4, 0.3})},
          {"displacement", std::make_shared<sensitivity::LinearDisplacement>(randomWeights(problem, 3))}};
}

} // namespace Harmos
