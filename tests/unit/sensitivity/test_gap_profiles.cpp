// SPDX-License-Identifier: BSD-3-Clause

/// Gap profiles as designs: splines and points, what volumes and weights are, what gradients cost, designs
/// that have no answer, and the same gradients on any number of ranks.

#include "Harmos_DesignDerivatives.hpp"
#include "Harmos_TestErrors.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <gtest/gtest.h>

#include <algorithm>

namespace test_gap_profiles {

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::DesignVolume;
using sensitivity::Energy;
using sensitivity::GapProfile;
using sensitivity::PressureNorm;
using sensitivity::PressureSpread;
using sensitivity::RefusedDesign;
using sensitivity::SplineBasis;
using sensitivity::TensorSplineBasis;

namespace {

constexpr double tolerance = 1e-12; // of the solver; values of functionals are known to some ten times that
// Of differences: some thousand times smaller than gaps and penetrations.
constexpr double step = 1e-5;

TensorSplineBasis basisOf(bool isSpace, int degree, int pieces) {
  std::vector<SplineBasis> bases = {SplineBasis::uniform(degree, 0.0, 2.0, pieces)};
  std::vector<int> axes = {0};
  if (isSpace) {
    bases.push_back(SplineBasis::uniform(1, 0.0, 1.0, 1));
    axes.push_back(1);
  }
  return {bases, axes};
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += a[k] * b[k];
  return sum;
}

int surfaceOf(const ContactCase& problem) {
  return std::max(problem.effect("Contact"), problem.effect("Obstacle"));
}

} // namespace

// Gradients of splines as sums of those of points, of one answer both; and, of a degree each, against
// differences, which are of many answers.
TEST(GapProfiles, splines) {
  for (bool isSpace : {false, true})
    for (bool onPlane : {false, true})
      for (int degree : {0, 1, 2, 3}) {
        const std::string what = std::string(isSpace ? "space" : "plane") +
                                 (onPlane ? ", obstacle" : ", blocks") + ", degree " + std::to_string(degree);
        ContactCase problem(pushedBlocks(isSpace, onPlane, isSpace ? 2 : 6, 0.05),
                            contactCaseParameters(tolerance, isSpace ? "dual" : "primal"));
        const int surface = surfaceOf(problem);
        GapProfile splines(*problem.solver, problem.contact.rows, problem.geometry(), {surface},
                           basisOf(isSpace, degree, 2));
        EXPECT_EQ(splines.size(), static_cast<std::size_t>((2 + degree) * (isSpace ? 2 : 1))) << what;
        GapProfile points(*problem.solver, problem.contact.rows, problem.geometry(), {surface});
        const std::vector<double> design = randomDesign(splines.size(), 3 + degree, 0.03);
        for (const auto& [name, functional] : functionalsOf(problem, surface)) {
          ContactCost cost(*problem.solver, splines, *functional);
          cost.value(design, 0.0);
          const std::vector<double> gradient = cost.gradient(design, 0.0);
          ContactCost ofPoints(*problem.solver, points, *functional);
          const std::vector<double> byPoints =
              ofPoints.gradient(points.transposed(splines.profile(design)), 0.0);
          EXPECT_LE(differenceOf(splines.transposed(points.profile(byPoints)), gradient), 1e5 * tolerance)
              << what << ", " << name;
          if (degree != 2 * static_cast<int>(isSpace) + static_cast<int>(onPlane))
            continue;
          EXPECT_LE(differenceOf(centralDifferences(cost, design, step), gradient),
                    name == "energy" ? 1e-6 : 1e-5)
              << what << ", " << name;
        }
      }
}

// A partition of unity: what all numbers add is the area times a constant; and volumes are linear.
TEST(GapProfiles, volumes_and_weights) {
  for (bool isSpace : {false, true})
    for (int degree : {0, 1, 2, 3}) {
      ContactCase problem(pressedBlocks(isSpace, true, 4), contactCaseParameters(1e-8));
      const sensitivity::RowGeometry geometry = problem.geometry();
      GapProfile model(*problem.solver, problem.contact.rows, geometry, {surfaceOf(problem)},
                       basisOf(isSpace, degree, 2));
      EXPECT_TRUE(model.hasLinearVolume());
      const std::vector<double> one(model.size(), 1.0), design = randomDesign(model.size(), 1, 0.5);
      EXPECT_NEAR(model.volume(one), 2.0, 1e-12) << degree;
      double added = 0.0;
      const std::vector<double> profile = model.profile(design);
      for (std::size_t r = 0; r < profile.size(); ++r)
        added += geometry.areas[r] * profile[r];
      EXPECT_NEAR(model.volume(design), globalSum(*testComm(), added), 1e-13);
      DesignVolume volume(model);
      EXPECT_EQ(volume.gradient(design, 0.0), model.weights());
      EXPECT_LE(differenceOf(centralDifferences(volume, design, 0.5), model.weights()), 1e-12);
      for (double weight : model.weights())
        EXPECT_GT(weight, 0.0);
      // What profiles are transposed to.
      const std::vector<double> values = geometry.areas;
      double inner = 0.0;
      for (std::size_t r = 0; r < values.size(); ++r)
        inner += profile[r] * values[r];
      EXPECT_NEAR(dot(model.transposed(values), design), globalSum(*testComm(), inner), 1e-13);
    }
}

// Profiles are added to the gaps that are there, of the surfaces that are named alone.
TEST(GapProfiles, are_added_to_gaps) {
  ContactCase problem(pressedBlocks(false, false, 4, 0.01), contactCaseParameters(1e-10));
  GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surfaceOf(problem)});
  const std::vector<double> design = randomDesign(model.size(), 4, 0.002);
  model.apply(design);
  const std::vector<double> profile = model.profile(design);
  for (std::size_t r = 0; r < profile.size(); ++r) {
    EXPECT_NEAR(model.gaps()[r], 0.01, 1e-12);
    EXPECT_NEAR(model.rows()[r].bound, 0.01 + profile[r], 1e-12);
  }
  model.apply(design); // not to those of the last design
  for (std::size_t r = 0; r < profile.size(); ++r)
    EXPECT_NEAR(model.rows()[r].bound, 0.01 + profile[r], 1e-12);
  const auto box = sensitivity::extentOfPoints(*testComm(), problem.geometry(), {surfaceOf(problem)});
  EXPECT_NEAR(box.first[0], 0.0, 1e-12);
  EXPECT_NEAR(box.second[0], 2.0, 1e-12);
  EXPECT_NEAR(box.first[1], 1.0, 1e-12);
  EXPECT_NEAR(box.second[1], 1.0, 1e-12);
  const std::string none = inputErrorOf(
      [&] { GapProfile other(*problem.solver, problem.contact.rows, problem.geometry(), {17}); });
  EXPECT_TRUE(contains(none, "the surfaces whose gaps are designed have no contact points")) << none;
  const std::string narrow = inputErrorOf([&] {
    GapProfile other(*problem.solver, problem.contact.rows, problem.geometry(), {surfaceOf(problem)},
                     basisOf(false, 0, 100));
  });
  EXPECT_TRUE(contains(narrow, "of the design moves no contact point; use fewer pieces")) << narrow;
}

// A gradient of the energy costs no product, others a linear solution: as many products as one that starts
// cold with closed contacts for ties. Nothing is factored.
TEST(GapProfiles, cost_of_gradients) {
  for (const char* dirichlet : {"primal", "dual"}) {
    constexpr double usual = 1e-8;
    ContactCase problem(pressedBlocks(false, false, 8), contactCaseParameters(usual, dirichlet));
    const int surface = surfaceOf(problem);
    GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surface});
    const auto factors = problem.solver->factorizations().factorizations;
    const auto analyses = problem.solver->factorizations().analyses;
    const std::vector<double> design = randomDesign(model.size(), 2, 0.02);
    const Energy energy;
    ContactCost ofEnergy(*problem.solver, model, energy);
    ofEnergy.value(design, 0.0);
    ofEnergy.gradient(design, 0.0);
    EXPECT_EQ(ofEnergy.sensitivities()->products(), 0);
    EXPECT_EQ(ofEnergy.spent().values, 1);
    EXPECT_EQ(ofEnergy.spent().adjointProducts, 0);
    EXPECT_GT(ofEnergy.spent().products, 0);

    const sensitivity::LinearDisplacement displacement(randomWeights(problem, 3));
    ContactCost other(*problem.solver, model, displacement);
    other.value(design, 0.0);
    other.gradient(design, 0.0);
    EXPECT_EQ(other.spent().values, 1);
    EXPECT_EQ(other.spent().adjointProducts, other.sensitivities()->products());
    EXPECT_EQ(problem.solver->factorizations().factorizations, factors) << dirichlet;
    EXPECT_EQ(problem.solver->factorizations().analyses, analyses) << dirichlet;

    // The linear problem by itself.
    std::vector<ConstraintRow> rows;
    for (std::size_t r = 0; r < model.rows().size(); ++r)
      if (other.forces()[r] > 0.0) {
        rows.push_back(model.rows()[r]);
        rows.back().kind = ConstraintRow::Kind::Equality;
        rows.back().bound = 0.0;
      }
    long long next = exclusiveScan(*testComm(), static_cast<long long>(rows.size()));
    for (ConstraintRow& row : rows)
      row.number = next++;
    std::vector<feti::Subdomain> subdomains;
    const feti::TornVector weights = randomWeights(problem, 3);
    for (int i = 0; i < problem.solver->system().size(); ++i) {
      subdomains.push_back(problem.solver->system().subdomain(i));
      subdomains.back().load =
          std::make_shared<const std::vector<double>>(weights[static_cast<std::size_t>(i)]);
    }
    feti::FetiSolver linear(testComm(), subdomains, rows, contactCaseParameters(usual, dirichlet));
    ASSERT_TRUE(linear.solve().converged);
    const int cold = linear.report().result.counters.hessianApplications;
    EXPECT_GE(other.spent().adjointProducts, 0.5 * cold) << dirichlet;
    EXPECT_LE(other.spent().adjointProducts, 2.0 * cold) << dirichlet;
    // The adjoint is that problem's answer, with forces of ties.
    ContactCost exact(*problem.solver, model, displacement);
    exact.value(design, 0.0);
    const std::vector<double> gradient = exact.gradient(design, 0.0);
    std::vector<double> expected(model.rows().size(), 0.0);
    const std::vector<double> forces = linear.rowForces();
    for (std::size_t r = 0, tie = 0; r < expected.size(); ++r)
      if (other.forces()[r] > 0.0)
        expected[r] = forces[tie++];
    EXPECT_LE(differenceOf(gradient, model.transposed(expected)), 1e3 * usual) << dirichlet;
  }
}

// Functionals in other units have gradients in these: what rows of displacements are known to says nothing of
// adjoints, which may be smaller than that.
TEST(GapProfiles, gradients_have_units) {
  const auto gradientOf = [](double unit) {
    // By a solver of its own, or starts would be multiples of what is known.
    ContactCase problem(pressedBlocks(false, false, 6), contactCaseParameters(1e-10));
    GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surfaceOf(problem)});
    const std::vector<double> design = randomDesign(model.size(), 2, 0.02);
    feti::TornVector weights = randomWeights(problem, 3);
    for (std::vector<double>& part : weights)
      for (double& weight : part)
        weight *= unit;
    const sensitivity::LinearDisplacement functional(weights);
    ContactCost cost(*problem.solver, model, functional);
    std::vector<double> gradient = cost.gradient(design, 0.0);
    for (double& entry : gradient)
      entry /= unit;
    return gradient;
  };
  const std::vector<double> one = gradientOf(1.0);
  for (double unit : {1e-20, 1e-14, 1e-7, 1e9, 1e20})
    EXPECT_LE(differenceOf(gradientOf(unit), one), 1e4 * 1e-10) << unit;
}

// Not solved again for the same design, but to a smaller tolerance; the sign is that of all of it.
TEST(GapProfiles, values_are_kept) {
  ContactCase problem(pressedBlocks(false, true, 6), contactCaseParameters(1e-12));
  GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surfaceOf(problem)});
  const Energy energy;
  ContactCost softest(*problem.solver, model, energy), stiffest(*problem.solver, model, energy, -1.0);
  const std::vector<double> design = randomDesign(model.size(), 2, 0.02);
  const double rough = softest.value(design, 1e-3);
  EXPECT_EQ(softest.value(design, 1e-2), rough);
  EXPECT_EQ(softest.spent().values, 1);
  const double fine = softest.value(design, 0.0);
  EXPECT_EQ(softest.spent().values, 2);
  EXPECT_NEAR(rough, fine, 0.1 * std::abs(fine));
  EXPECT_EQ(softest.value(design, 1e-3), fine);
  const std::vector<double> gradient = softest.gradient(design, 0.0);
  EXPECT_EQ(softest.spent().values, 2);
  EXPECT_NEAR(stiffest.value(design, 0.0), -fine, 1e-10 * std::abs(fine));
  EXPECT_LE(differenceOf(stiffest.gradient(design, 0.0),
                         moved(std::vector<double>(gradient.size(), 0.0), gradient, -1.0)),
            1e-9);
}

// A body that a design lifts off bears nothing, and one that is pulled away has no answer: both are refused,
// all ranks alike, and what comes next is as if they had not been asked.
TEST(GapProfiles, designs_that_are_refused) {
  for (bool onPlane : {false, true}) {
    ContactCase problem(pushedBlocks(false, onPlane, 6, 0.02), contactCaseParameters(tolerance));
    const int surface = surfaceOf(problem);
    GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surface});
    const PressureNorm norm({surface}, 4.0);
    ContactCost cost(*problem.solver, model, norm);
    const std::vector<double> good = randomDesign(model.size(), 2, 0.005), away(model.size(), 0.1);
    const double before = cost.value(good, 0.0);
    const std::vector<double> gradient = cost.gradient(good, 0.0);
    try {
      cost.value(away, 0.0);
      ADD_FAILURE() << "not refused";
    } catch (const RefusedDesign& error) {
      EXPECT_TRUE(contains(error.what(), "no contact point carries a force: the body has lifted off"))
          << error.what();
    }
    EXPECT_THROW(cost.gradient(away, 0.0), RefusedDesign);
    EXPECT_NEAR(cost.value(good, 0.0), before, 1e3 * tolerance * before);
    EXPECT_LE(differenceOf(cost.gradient(good, 0.0), gradient), 1e5 * tolerance);
    // Its energy is that of a body at rest, or moved as a whole.
    const Energy energy;
    ContactCost ofEnergy(*problem.solver, model, energy);
    EXPECT_NEAR(ofEnergy.value(away, 0.0), 0.0, 1e-15);
    for (double entry : ofEnergy.gradient(away, 0.0))
      EXPECT_EQ(entry, 0.0);
  }
}

TEST(GapProfiles, bodies_that_are_pulled_away) {
  for (const char* dirichlet : {"primal", "dual"}) {
    ContactCase problem(pressedBlocks(false, false, 6), contactCaseParameters(tolerance, dirichlet));
    GapProfile model(*problem.solver, problem.contact.rows, problem.geometry(), {surfaceOf(problem)});
    const Energy energy;
    ContactCost cost(*problem.solver, model, energy);
    const std::vector<double> design = randomDesign(model.size(), 2, 0.005);
    const double before = cost.value(design, 0.0);
    std::vector<std::shared_ptr<const std::vector<double>>> down, up;
    for (int i = 0; i < problem.solver->system().size(); ++i) {
      down.push_back(problem.solver->system().subdomain(i).load);
      std::vector<double> turned = *down.back();
      for (double& entry : turned)
        entry *= -1.0;
      up.push_back(std::make_shared<const std::vector<double>>(turned));
    }
    problem.solver->setLoads(up);
    const std::vector<double> next = moved(design, std::vector<double>(design.size(), 1.0), 0.001);
    for (int again = 0; again < 2; ++again)
      try {
        cost.value(next, 0.0);
        ADD_FAILURE() << "not refused";
      } catch (const RefusedDesign& error) {
        EXPECT_TRUE(
            contains(error.what(), "with this design the bodies have an unconstrained rigid-body mode"))
            << error.what();
        EXPECT_TRUE(contains(error.what(), "unconstrained rigid-body mode under load: subdomain"))
            << error.what();
      }
    EXPECT_EQ(cost.sensitivities(), nullptr);
    EXPECT_TRUE(cost.design().empty());
    problem.solver->setLoads(down);
    EXPECT_NEAR(cost.value(design, 0.0), before, 1e3 * tolerance * std::abs(before)) << dirichlet;
  }
}

// Rank by rank alone, and all together: forces are known to the tolerance times the condition of F, a
// hundred, and norms; adjoints to that again.
TEST(GapProfiles, the_same_on_any_number_of_ranks) {
  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  for (bool isSpace : {false, true}) {
    constexpr double rough = 1e-11;
    const scene::Scene scene = pushedBlocks(isSpace, false, isSpace ? 2 : 6, 0.03);
    ContactCase together(scene, contactCaseParameters(rough));
    ContactCase alone(scene, contactCaseParameters(rough), false, self);
    GapProfile many(*together.solver, together.contact.rows, together.geometry(), {surfaceOf(together)});
    GapProfile one(*alone.solver, alone.contact.rows, alone.geometry(), {surfaceOf(alone)});
    ASSERT_EQ(many.size(), one.size());
    EXPECT_LE(differenceOf(many.weights(), one.weights()), 1e-13);
    const std::vector<double> design = randomDesign(one.size(), 6, 0.02);
    const auto ofMany = functionalsOf(together, surfaceOf(together)),
               ofOne = functionalsOf(alone, surfaceOf(alone));
    for (std::size_t f = 0; f < ofOne.size(); ++f) {
      ContactCost first(*together.solver, many, *ofMany[f].second),
          second(*alone.solver, one, *ofOne[f].second);
      const double a = first.value(design, 0.0), b = second.value(design, 0.0);
      EXPECT_NEAR(a, b, 1e3 * rough * std::abs(b)) << ofOne[f].first;
      EXPECT_LE(differenceOf(first.gradient(design, 0.0), second.gradient(design, 0.0)), 1e4 * rough)
          << ofOne[f].first;
      // To the last bit on all ranks: optimisers run on each of them.
      const std::vector<double> gradient = first.gradient(design, 0.0);
      std::vector<double> most = gradient, least = gradient;
      globalMax(*testComm(), most);
      for (double& entry : least)
        entry = -entry;
      globalMax(*testComm(), least);
      for (std::size_t k = 0; k < most.size(); ++k)
        EXPECT_EQ(most[k], -least[k]) << ofOne[f].first;
      EXPECT_EQ(globalMax(*testComm(), a), globalMin(*testComm(), a)) << ofOne[f].first;
    }
  }
}

} // namespace test_gap_profiles
