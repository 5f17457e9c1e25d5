// SPDX-License-Identifier: BSD-3-Clause

/// Derivatives with respect to gaps: against central differences at random profiles, in the plane and in
/// space, FETI and Total FETI; one-sided ones where a contact is weak; what they cost.

#include "Harmos_DesignDerivatives.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GapProfile.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace test_gap_gradients {

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::GapProfile;

namespace {

// Of the solver. Values of functionals are known to some hundred times that, differences over a step h to
// that by h.
constexpr double tolerance = 1e-13;

// Steps keep the active set: they are some thousand times smaller than gaps and penetrations.
double errorOf(ContactCost& cost, const std::vector<double>& design, double step) {
  const std::vector<double> gradient = cost.gradient(design, 0.0);
  EXPECT_EQ(cost.sensitivities()->weakContacts(), 0);
  return differenceOf(centralDifferences(cost, design, step), gradient);
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
        for (const auto& [name, functional] : functionalsOf(problem, surface)) {
          if (name == "resultant") // the load holds it, whatever the gaps
            continue;
          ContactCost cost(*problem.solver, model, *functional);
          const std::vector<double> design = randomDesign(model.size(), isSpace ? 5 : 2, 0.02);
          const double largest = name == "energy" ? 1e-6 : 1e-5;
          EXPECT_LE(errorOf(cost, design, 1e-5), largest)
              << name << (isSpace ? " in space " : " in the plane ") << (onPlane ? "plane " : "blocks ")
              << dirichlet;
        }
      }
}

} // namespace test_gap_gradients
