// SPDX-License-Identifier: BSD-3-Clause

/// Derivatives with respect to positions of nodes: against central differences at random shapes, in the plane
/// and in space, on planes, round obstacles and matching bodies; factorisations of moving bodies alone;
/// meshes that tangle.

#include "Harmos_DesignDerivatives.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_ShapeModel.hpp"

#include <gtest/gtest.h>

namespace test_shape_gradients {

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::ShapeMap;
using sensitivity::ShapeModel;
using sensitivity::SplineBasis;

namespace {

constexpr double tolerance = 1e-13; // of the solver

ShapeMap mapOf(bool isSpace, double depth) {
  std::vector<SplineBasis> bases = {SplineBasis::uniform(2, 0.0, 2.0, 3)};
  std::vector<int> axes = {0};
  if (isSpace) {
    bases.push_back(SplineBasis::uniform(1, 0.0, 1.0, 1));
    axes.push_back(1);
  }
  return {{bases, axes}, isSpace ? fem::Point{0.0, 0.0, 1.0} : fem::Point{0.0, 1.0, 0.0}, 1.0, depth};
}

double errorOf(ContactCost& cost, const std::vector<double>& design, double step) {
  const std::vector<double> gradient = cost.gradient(design, 0.0);
  EXPECT_EQ(cost.sensitivities()->weakContacts(), 0);
  return differenceOf(centralDifferences(cost, design, step), gradient);
}

} // namespace

TEST(ShapeGradients, agree_with_differences) {
  for (bool isSpace : {false, true})
    for (bool onPlane : {true, false})
      for (const char* dirichlet : {"primal", "dual"}) {
        ContactCase problem(pressedBlocks(isSpace, onPlane, isSpace ? 2 : 6),
                            contactCaseParameters(tolerance, dirichlet), true);
        const int surface = problem.effect(onPlane ? "Obstacle" : "Contact");
        ShapeModel model(*problem.solver, problem.scene, problem.owned, problem.contact, mapOf(isSpace, 1.0),
                         onPlane ? std::set<int>{0} : std::set<int>{0, 1});
        feti::TornVector weights = problem.solver->system().zeroVector();
        for (std::size_t i = 0; i < weights.size(); ++i)
          for (std::size_t j = 0; j < weights[i].size(); ++j)
            weights[i][j] = pseudoRandom(3, j + 1000 * static_cast<std::size_t>(problem.owned[i].number));
        const sensitivity::Energy energy;
        const sensitivity::PressureNorm pressure({surface}, 6.0);
        const sensitivity::LinearDisplacement displacement(weights);
        const std::vector<double> design = randomDesign(model.size(), 4, 0.03);
        for (const auto& [name, functional, largest] :
             {std::tuple<std::string, const sensitivity::Functional*, double>{"energy", &energy, 1e-6},
              {"norm", &pressure, 1e-5},
              {"displacement", &displacement, 1e-5}}) {
          ContactCost cost(*problem.solver, model, *functional);
          const double difference = errorOf(cost, design, 1e-5);
          EXPECT_LE(difference, largest) << name << (isSpace ? " in space " : " in the plane ")
                                         << (onPlane ? "plane " : "blocks ") << dirichlet;
        }
      }
}

} // namespace test_shape_gradients
