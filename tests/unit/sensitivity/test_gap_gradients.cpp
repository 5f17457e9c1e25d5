// SPDX-License-Identifier: BSD-3-Clause

/// Derivatives with respect to gaps: against central differences at random profiles, in the plane and in
/// space, FETI and Total FETI; one-sided ones where a contact is weak; what they cost.

#include "Harmos_ContactCase.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GapProfile.hpp"

#include <gtest/gtest.h>

#include <functional>

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::GapProfile;

namespace {

// Of the solver. Values of functionals are known to some hundred times that, differences over a step h to
// that by h.
constexpr double tolerance = 1e-13;

std::vector<double> randomProfile(std::size_t size, int seed, double amplitude) {
  std::vector<double> design;
  for (std::size_t k = 0; k < size; ++k)
    design.push_back(amplitude * pseudoRandom(seed, k));
  return design;
}

double norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (double entry : v)
    sum += entry * entry;
  return std::sqrt(sum);
}

// ‖∇Φ − differences‖/‖∇Φ‖. Steps keep the active set: they are some thousand times smaller than gaps and
// penetrations.
double differenceOf(ContactCost& cost, const std::vector<double>& design, double step) {
  cost.value(design, 0.0);
  const std::vector<double> gradient = cost.gradient(design, 0.0);
  EXPECT_EQ(cost.sensitivities()->weakContacts(), 0);
  std::vector<double> error;
  for (std::size_t k = 0; k < design.size(); ++k) {
    std::vector<double> to = design;
    to[k] = design[k] + step;
    const double above = cost.value(to, 0.0);
    to[k] = design[k] - step;
    const double below = cost.value(to, 0.0);
    error.push_back((above - below) / (2.0 * step) - gradient[k]);
  }
  return norm(error) / norm(gradient);
}

std::vector<std::pair<std::string, std::shared_ptr<sensitivity::Functional>>>
functionals(const ContactCase& problem, int surface) {
  feti::TornVector weights = problem.solver->system().zeroVector();
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (std::size_t j = 0; j < weights[i].size(); ++j)
      weights[i][j] = pseudoRandom(3, j + 1000 * static_cast<std::size_t>(problem.owned[i].number));
  const std::set<int> surfaces = {surface};
  return {{"energy", std::make_shared<sensitivity::Energy>()},
          {"norm", std::make_shared<sensitivity::PressureNorm>(surfaces, 6.0)},
          {"spread", std::make_shared<sensitivity::PressureSpread>(surfaces)},
          {"displacement", std::make_shared<sensitivity::LinearDisplacement>(weights)}};
}

} // namespace

TEST(GapGradients, agree_with_differences) {
  for (bool isSpace : {false, true})
    for (bool onPlane : {false, true})
      for (const char* dirichlet : {"primal", "dual"}) {
        ContactCase problem(pressedBlocks(isSpace, onPlane, isSpace ? 2 : 6),
                            contactCaseParameters(tolerance, dirichlet));
        const int surface = problem.effect(onPlane ? "Obstacle" : "Contact");
        GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surface});
        for (const auto& [name, functional] : functionals(problem, surface)) {
          ContactCost cost(*problem.solver, model, *functional);
          const std::vector<double> design = randomProfile(model.size(), isSpace ? 5 : 2, 0.02);
          const double largest = name == "energy" ? 1e-6 : 1e-5;
          EXPECT_LE(differenceOf(cost, design, 1e-5), largest)
              << name << (isSpace ? " in space " : " in the plane ") << (onPlane ? "plane " : "blocks ")
              << dirichlet;
        }
      }
}
