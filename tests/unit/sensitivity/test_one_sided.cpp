// SPDX-License-Identifier: BSD-3-Clause

/// Where derivatives are one-sided: weak contacts, against differences to both sides; what keeps its
/// derivative there; laws of interfaces whose answers have none, each refused by its name.

#include "Harmos_Adhesion.hpp"
#include "Harmos_DesignDerivatives.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_one_sided {

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::Energy;
using sensitivity::GapProfile;
using sensitivity::LinearDisplacement;
using sensitivity::Sensitivities;

namespace {

constexpr double tolerance = 1e-13; // of the solver
// Steps of differences, some thousand times smaller than gaps and penetrations. To one side answers are
// linear in a step that changes no other contact, and known to some hundred times the tolerance.
constexpr double step = 1e-5;
constexpr double bound = 1e3 * tolerance / step;

// A problem with a design at which one contact touches without a force. Of a solution with open contacts the
// bound of one is set to where it would just touch, which leaves the solution as it is.
struct WeakCase {
  ContactCase problem;
  GapProfile model;
  std::vector<double> design;
  std::size_t weak = 0; // number of the design

  WeakCase(bool isSpace, bool onPlane, const std::string& dirichlet, int seed)
      : problem(pressedBlocks(isSpace, onPlane, isSpace ? 3 : 6),
                contactCaseParameters(tolerance, dirichlet)),
        model(*problem.solver, problem.contact.rows, problem.geometry(),
              {problem.effect(onPlane ? "Obstacle" : "Contact")}) {
    design = randomDesign(model.size(), seed, 0.05);
    model.apply(design);
    EXPECT_TRUE(problem.solver->solve().converged) << problem.solver->report().reason;
    const std::vector<double> gaps = gapsOf();
    // Some way from the ends, where it is not alone.
    double least = 1e300;
    for (std::size_t k = 0; k < gaps.size(); ++k)
      if (gaps[k] > 1e-4 && gaps[k] < least) {
        least = gaps[k];
        weak = k;
      }
    if (least == 1e300) {
      ADD_FAILURE() << "no contact is open";
      return;
    }
    design[weak] -= least;
    model.apply(design);
    EXPECT_TRUE(problem.solver->solve().converged) << problem.solver->report().reason;
  }

  feti::FetiSolver& solver() { return *problem.solver; }
  // What is left between bodies, by the numbers of the design.
  std::vector<double> gapsOf() {
    std::vector<double> residuals =
        solver().constraints()->givenResiduals(solver().displacement(), *solver().solution().multiplier);
    for (double& residual : residuals)
      residual = -residual;
    return model.transposed(residuals);
  }
  // c′ of the rows of this rank.
  std::vector<double> change(const std::vector<double>& direction) const { return model.profile(direction); }
};

double value(const feti::TornVector& weights, const feti::TornVector& u) {
  double sum = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t j = 0; j < u[i].size(); ++j)
      sum += weights[i][j] * u[i][j];
  return globalSum(*testComm(), sum);
}

struct Place {
  bool isSpace, onPlane;
  const char* dirichlet;
};
const Place places[] = {
    {false, false, "primal"}, {false, true, "dual"}, {true, false, "dual"}, {true, true, "primal"}};

std::string textOf(const Place& place) {
  return std::string(place.isSpace ? "in space" : "in the plane") +
         (place.onPlane ? ", plane, " : ", blocks, ") + place.dirichlet;
}

// Blocks pressed on each other or on a plane, and what acts at their surfaces.
template<class Interface>
scene::Scene withInterface(bool onPlane, Interface&& interface) {
  scene::Scene scene = pressedBlocks(false, onPlane, 6);
  for (const auto& effect : scene.effects)
    if (effect->kind() == (onPlane ? "Obstacle" : "Contact")) {
      scene.effects.push_back(interface(effect));
      break;
    }
  return scene;
}

effects::CohesiveLaw brittle() {
  effects::CohesiveLaw::Options law;
  law.kind = effects::CohesiveLaw::Kind::Brittle;
  law.normalStiffness = law.tangentialStiffness = 10.0;
  law.normalStrength = law.tangentialStrength = 1.0;
  return effects::CohesiveLaw(law);
}

} // namespace

// Closing makes a force, opening changes nothing: two rates, both those of differences to their side. The
// adjoint belongs to one of them.
TEST(OneSided, rates_at_a_weak_contact) {
  for (const Place& place : places) {
    const std::string what = textOf(place);
    WeakCase item(place.isSpace, place.onPlane, place.dirichlet, place.isSpace ? 8 : 2);
    const feti::TornVector weights = randomWeights(item.problem, 4);
    Sensitivities sensitivities(item.solver(), item.model.rows());
    ASSERT_EQ(sensitivities.weakContacts(), 1) << what;
    const std::vector<double> alone = unitDesign(item.design.size(), item.weak);
    const std::vector<double> all = moved(randomDesign(item.design.size(), 7, 0.3), alone, 1.0);
    const LinearDisplacement functional(weights);
    const std::vector<double> forces = item.solver().rowForces();
    const sensitivity::RowGeometry geometry = item.problem.geometry();
    const auto adjoint =
        sensitivities.adjoint(functional, {item.solver(), forces, geometry}, 0.0 + tolerance);
    const std::vector<double> gradient = item.model.transposed(adjoint.forces);
    for (const std::vector<double>& direction : {alone, all}) {
      std::vector<std::vector<double>> rates; // of the displacement, and of forces, to both sides
      std::vector<double> ofValues;
      for (double side : {1.0, -1.0}) {
        const Sensitivities::Rate rate = sensitivities.rate(
            {}, item.change(moved(std::vector<double>(direction.size(), 0.0), direction, side)), tolerance);
        ofValues.push_back(value(weights, rate.displacement));
        rates.push_back(item.model.transposed(rate.forces));
      }
      const double here = value(weights, item.solver().displacement());
      const std::vector<double> forcesHere = item.model.transposed(forces);
      std::vector<double> differences;
      for (std::size_t s = 0; s < 2; ++s) {
        item.model.apply(moved(item.design, direction, s == 0 ? step : -step));
        ASSERT_TRUE(item.solver().solve().converged) << what;
        differences.push_back((value(weights, item.solver().displacement()) - here) / step);
        std::vector<double> change =
            moved(item.model.transposed(item.solver().rowForces()), forcesHere, -1.0);
        for (double& entry : change)
          entry /= step;
        const double size = std::max(normOf(rates[0]), normOf(rates[1]));
        EXPECT_LE(normOf(moved(change, rates[s], -1.0)), bound * size) << what << ", forces, side " << s;
        item.model.apply(item.design);
        ASSERT_TRUE(item.solver().solve().converged) << what;
      }
      const double size = std::max(std::abs(differences[0]), std::abs(differences[1]));
      EXPECT_GT(size, 1e-4) << what;
      for (std::size_t s = 0; s < 2; ++s)
        EXPECT_NEAR(ofValues[s], differences[s], bound * size) << what << ", side " << s;
      // Not each other's negatives, or the contact would not be weak.
      EXPECT_GT(std::abs(ofValues[0] + ofValues[1]), 1e-3 * size) << what;
      double along = 0.0;
      for (std::size_t k = 0; k < direction.size(); ++k)
        along += gradient[k] * direction[k];
      EXPECT_LE(std::min(std::abs(along - ofValues[0]), std::abs(along + ofValues[1])), bound * size) << what;
    }
    EXPECT_GT(sensitivities.products(), 0);
  }
}

// Rows hold at the rate that data change, with loads too: rates are answers of a problem of their own.
TEST(OneSided, rates_of_loads) {
  WeakCase item(false, false, "primal", 2);
  Sensitivities sensitivities(item.solver(), item.model.rows());
  feti::TornVector loads = item.solver().system().zeroVector();
  std::vector<std::shared_ptr<const std::vector<double>>> here, there;
  for (int i = 0; i < item.solver().system().size(); ++i) {
    here.push_back(item.solver().system().subdomain(i).load);
    loads[static_cast<std::size_t>(i)] =
        *here.back(); // as much again: forces and displacements in proportion
    std::vector<double> more = *here.back();
    for (double& entry : more)
      entry *= 1.0 + step;
    there.push_back(std::make_shared<const std::vector<double>>(more));
  }
  const feti::TornVector weights = randomWeights(item.problem, 4);
  const Sensitivities::Rate rate = sensitivities.rate(loads, {}, tolerance);
  const double before = value(weights, item.solver().displacement());
  item.solver().setLoads(there);
  ASSERT_TRUE(item.solver().solve().converged);
  const double difference = (value(weights, item.solver().displacement()) - before) / step;
  EXPECT_GT(std::abs(difference), 1e-3);
  EXPECT_NEAR(value(weights, rate.displacement), difference, bound * std::abs(difference));
}

// J has a derivative there all the same. Its second one jumps: a central difference is off by half the step
// times the jump, which is of the order of J″ ~ J′/0.03, the size of gaps.
TEST(OneSided, energy_is_differentiable) {
  for (const Place& place : places) {
    WeakCase item(place.isSpace, place.onPlane, place.dirichlet, place.isSpace ? 8 : 2);
    const Energy energy;
    ContactCost cost(item.solver(), item.model, energy);
    cost.value(item.design, 0.0);
    const std::vector<double> gradient = cost.gradient(item.design, 0.0);
    EXPECT_EQ(cost.sensitivities()->weakContacts(), 1) << textOf(place);
    EXPECT_EQ(cost.sensitivities()->products(), 0) << textOf(place);
    EXPECT_LE(differenceOf(centralDifferences(cost, item.design, step), gradient), 0.5 * step / 0.03)
        << textOf(place);
  }
}

// Two at once, and none a little further on.
TEST(OneSided, weak_contacts_are_counted) {
  WeakCase item(false, true, "primal", 2);
  const std::vector<double> gaps = item.gapsOf();
  std::size_t second = gaps.size();
  for (std::size_t k = 0; k < gaps.size(); ++k)
    if (k != item.weak && gaps[k] > 1e-4)
      second = k;
  ASSERT_LT(second, gaps.size());
  std::vector<double> design = item.design;
  const auto countAt = [&](const std::vector<double>& to) {
    item.model.apply(to);
    EXPECT_TRUE(item.solver().solve().converged);
    return Sensitivities(item.solver(), item.model.rows()).weakContacts();
  };
  EXPECT_EQ(countAt(design), 1);
  design[second] -= gaps[second];
  EXPECT_EQ(countAt(design), 2);
  design[item.weak] += 1e-3;
  EXPECT_EQ(countAt(design), 1);
  design[second] -= 1e-3;
  EXPECT_EQ(countAt(design), 0);
}

// Tresca's friction has a potential: its energy has derivatives, with what is dissipated in it. What else
// depends on the answer has not, and says so.
TEST(OneSided, friction_of_given_bounds) {
  for (bool onPlane : {false, true}) {
    const auto friction = [](const std::shared_ptr<const scene::Effect>& contact) {
      return std::make_shared<effects::Friction>(contact, 0.002);
    };
    ContactCase problem(withInterface(onPlane, friction), contactCaseParameters(tolerance));
    const int surface = problem.effect(onPlane ? "Obstacle" : "Contact");
    GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surface});
    const std::vector<double> design = randomDesign(model.size(), 2, 0.02);
    const Energy energy;
    ContactCost cost(*problem.solver, model, energy);
    cost.value(design, 0.0);
    // Some points slip, and bear something.
    EXPECT_GT(problem.solver->audit().frictionWork, 1e-8);
    const std::vector<double> gradient = cost.gradient(design, 0.0);
    EXPECT_LE(differenceOf(centralDifferences(cost, design, step), gradient), 1e-6) << onPlane;
    const int products = cost.sensitivities() != nullptr ? cost.sensitivities()->products() : 0;
    EXPECT_EQ(products, 0);
    for (const auto& [name, functional] : functionalsOf(problem, surface)) {
      if (name == "energy")
        continue;
      ContactCost other(*problem.solver, model, *functional);
      const double before = other.value(design, 0.0);
      const std::string text = inputErrorOf([&] { other.gradient(design, 0.0); });
      EXPECT_TRUE(contains(text, "with friction, forces and displacements have one-sided derivatives only"))
          << name << ": " << text;
      EXPECT_NEAR(other.value(design, 0.0), before, 1e-12 * std::abs(before)) << name;
    }
    Sensitivities sensitivities(*problem.solver, model.rows());
    EXPECT_TRUE(contains(inputErrorOf([&] { sensitivities.rate({}, model.profile(design), tolerance); }),
                         "with friction"));
  }
}

TEST(OneSided, laws_without_derivatives_are_refused) {
  const auto coulomb = [](const std::shared_ptr<const scene::Effect>& contact) {
    return std::make_shared<effects::Friction>(contact, effects::Coulomb(0.1));
  };
  ContactCase rubbing(withInterface(true, coulomb), contactCaseParameters(1e-10));
  ASSERT_TRUE(rubbing.solver->solve().converged) << rubbing.solver->report().reason;
  const std::string friction =
      inputErrorOf([&] { Sensitivities sensitivities(*rubbing.solver, rubbing.contact.rows); });
  EXPECT_TRUE(contains(friction, "Coulomb friction (\"Coefficient\") minimise no potential energy"))
      << friction;
  EXPECT_TRUE(contains(friction, "use a slip bound or remove the friction")) << friction;

  const auto glue = [](const std::shared_ptr<const scene::Effect>& contact) {
    return std::make_shared<effects::Adhesion>(contact, brittle());
  };
  ContactCase glued(withInterface(true, glue), contactCaseParameters(1e-10));
  std::vector<ConstraintRow> rows = glued.contact.rows;
  for (const scene::ContactSetup::Bond& bond : glued.contact.bonds)
    rows[bond.point].softness = bond.softness;
  glued.solver->setBounds(rows);
  ASSERT_TRUE(glued.solver->solve().converged) << glued.solver->report().reason;
  const std::string adhesion = inputErrorOf([&] { Sensitivities sensitivities(*glued.solver, rows); });
  EXPECT_TRUE(contains(adhesion, "solutions with adhesion have one-sided derivatives only")) << adhesion;
}

// Before there is a solution, and of one that is none.
TEST(OneSided, needs_a_solution) {
  ContactCase problem(pressedBlocks(false, true, 6), [] {
    Teuchos::ParameterList list = contactCaseParameters(tolerance);
    list.sublist("Solver").set("Maximum iterations", 1);
    return list;
  }());
  EXPECT_TRUE(
      contains(inputErrorOf([&] { Sensitivities sensitivities(*problem.solver, problem.contact.rows); }),
               "there is no solution yet; call solve() first"));
  ASSERT_FALSE(problem.solver->solve().converged);
  const std::string text =
      inputErrorOf([&] { Sensitivities sensitivities(*problem.solver, problem.contact.rows); });
  EXPECT_TRUE(contains(text, "the solver has not converged")) << text;
}

} // namespace test_one_sided
