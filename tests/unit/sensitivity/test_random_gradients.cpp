// SPDX-License-Identifier: BSD-3-Clause

/// A sweep over random profiles, bodies and settings: no gradient may be wrong. Guards against what no one
/// has thought of.
///
///     build/tests/bin/unit_sensitivity_random                       as in the test
///     HARMOS_DESIGNS=400 build/tests/bin/unit_sensitivity_random    more of them
///     HARMOS_DESIGN_SEED=17 ...                                     one of them
///
/// Each gradient is compared with a central difference along a random direction. While the same contacts are
/// closed at the design and to both sides of it, forces are linear in the step: a difference of the energy,
/// which is quadratic, is exact, that of other functionals known to the square of the share ρ by which the
/// step changes forces, times what the exponents of pressures, up to 6, make of it: 6²/6 ρ²; the spread Φ of
/// a nearly uniform pressure, whose derivative of 2√Φρ is as small as that, to ρ³ by it. Values are known to
/// some hundred tolerances, by the step. Where the step changes what is closed, or a contact is weak, there
/// are one-sided derivatives at best: those cases are counted, and few.

#include "Harmos_DesignDerivatives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>

namespace test_random_gradients {

using namespace Harmos;
using sensitivity::ContactCost;
using sensitivity::GapProfile;
using sensitivity::SplineBasis;
using sensitivity::TensorSplineBasis;

namespace {

constexpr double tolerance = 1e-11; // of the solver: smaller ones are not to be had everywhere
constexpr double step = 1e-5;

unsigned fromEnvironment(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::stoul(text));
}

template<class T>
T oneOf(std::mt19937& random, std::initializer_list<T> items) {
  return *(items.begin() + static_cast<std::ptrdiff_t>(random() % items.size()));
}

double uniform(std::mt19937& random, double begin, double end) {
  return begin + (end - begin) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
}

Teuchos::ParameterList randomParameters(std::mt19937& random, std::string& text) {
  const std::string dirichlet = oneOf<std::string>(random, {"primal", "dual"});
  const std::string form = oneOf<std::string>(random, {"condensed", "implicit"});
  const std::string preconditioner = oneOf<std::string>(random, {"none", "lumped", "Dirichlet"});
  const std::string clusters = oneOf<std::string>(random, {"none", "2", "rank"});
  const std::string vectors = oneOf<std::string>(random, {"auto", "all"});
  Teuchos::ParameterList list = contactCaseParameters(tolerance, dirichlet);
  list.sublist("Dual operator").set("Form", form).set("Preconditioner", preconditioner);
  list.sublist("Dual operator").sublist("Expert").set("Adaptive coarse vectors", vectors);
  list.sublist("Decomposition").set("Clusters", clusters);
  text += dirichlet + ", " + form + ", " + preconditioner + ", clusters " + clusters + ", vectors " + vectors;
  return list;
}

// ‖v‖ of all ranks' parts.
double sizeOf(const std::vector<double>& v) {
  const double norm = normOf(v);
  return std::sqrt(globalSum(*testComm(), norm * norm));
}

// What of a solution is closed.
std::vector<char> closedOf(const std::vector<double>& forces) {
  std::vector<char> closed;
  for (double force : forces)
    closed.push_back(force > 0.0 ? 1 : 0);
  return closed;
}

// Whether any contact is open.
long long hasOpenContacts(const std::vector<ConstraintRow>& rows, const std::vector<char>& closed) {
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].kind == ConstraintRow::Kind::Inequality && closed[r] == 0)
      return 1;
  return 0;
}

struct Tally {
  int gradients = 0, beyond = 0; ///< that were judged, and that have no derivative within the step
  int refused = 0;
  int open = 0;       ///< of the first, with contacts that are open
  double worst = 0.0; ///< of the first, in shares of what is allowed
};

void judge(unsigned seed, Tally& tally) {
  std::mt19937 random(seed);
  const bool isSpace = oneOf(random, {false, true}), onPlane = oneOf(random, {false, true});
  const bool isPushed = oneOf(random, {false, true});
  const int elements = isSpace ? 2 : oneOf(random, {3, 5, 7});
  std::string text = std::string(isSpace ? "space" : "plane") + (onPlane ? ", obstacle" : ", blocks") +
                     (isPushed ? ", pushed, " : ", pressed, ");
  const Teuchos::ParameterList list = randomParameters(random, text);
  ContactCase problem(isPushed ? pushedBlocks(isSpace, onPlane, elements, uniform(random, 0.03, 0.06))
                               : pressedBlocks(isSpace, onPlane, elements, uniform(random, -0.01, 0.01)),
                      list);
  const int surface = problem.effect(onPlane ? "Obstacle" : "Contact");
  const sensitivity::RowGeometry geometry = problem.geometry();
  std::unique_ptr<GapProfile> model;
  if (const int degree = oneOf(random, {-1, 0, 1, 2, 3}); degree < 0) {
    model =
        std::make_unique<GapProfile>(*problem.solver, problem.contact.rows, geometry, std::set<int>{surface});
  } else {
    std::vector<SplineBasis> bases = {SplineBasis::uniform(degree, 0.0, 2.0, 2)};
    std::vector<int> axes = {0};
    if (isSpace)
      bases.push_back(SplineBasis::uniform(1, 0.0, 1.0, 1)), axes.push_back(1);
    model = std::make_unique<GapProfile>(*problem.solver, problem.contact.rows, geometry,
                                         std::set<int>{surface}, TensorSplineBasis(bases, axes));
  }
  const std::vector<double> design =
      randomDesign(model->size(), static_cast<int>(seed), uniform(random, 0.0, 0.2));
  const std::vector<double> direction = randomDesign(model->size(), static_cast<int>(seed) + 1, 1.0);
  for (const auto& [name, functional] : functionalsOf(problem, surface)) {
    // A force that is given is the resultant whatever the profile.
    if (name == "resultant" && !isPushed)
      continue;
    const std::string what = "seed " + std::to_string(seed) + ": " + text + ", " + name;
    ContactCost cost(*problem.solver, *model, *functional);
    double here = 0.0;
    try {
      here = cost.value(design, 0.0);
    } catch (const sensitivity::RefusedDesign&) { // that lifts a body off
      ++tally.refused;
      continue;
    }
    const std::vector<double> gradient = cost.gradient(design, 0.0);
    const long long weak = cost.sensitivities()->weakContacts();
    const std::vector<char> closed = closedOf(cost.forces());
    const std::vector<double> forces = cost.forces();
    double difference = 0.0, change = 0.0; // the latter of forces
    bool isSmooth = weak == 0;
    for (double side : {1.0, -1.0}) {
      difference += side * cost.value(moved(design, direction, side * step), 0.0) / (2.0 * step);
      change = std::max(change, sizeOf(moved(forces, cost.forces(), -1.0)));
      isSmooth = globalMin(*testComm(), closedOf(cost.forces()) == closed && isSmooth ? 1LL : 0LL) > 0;
    }
    if (!isSmooth) {
      ++tally.beyond;
      continue;
    }
    double along = 0.0;
    for (std::size_t k = 0; k < direction.size(); ++k)
      along += gradient[k] * direction[k];
    const double share = sizeOf(forces) > 0.0 ? change / sizeOf(forces) : 0.0;
    const double relative =
        name == "energy" ? 1e-6
                         : 1e-5 + share * share * (6.0 + (name == "spread" ? 1.0 / std::sqrt(here) : 0.0));
    const double allowed =
        relative * normOf(gradient) * normOf(direction) / std::sqrt(static_cast<double>(direction.size())) +
        1e2 * tolerance * std::abs(here) / step + 1e-18; // where a body is off, all is zero
    ++tally.gradients;
    tally.open += static_cast<int>(globalMax(*testComm(), hasOpenContacts(model->rows(), closed)));
    tally.worst = std::max(tally.worst, std::abs(along - difference) / allowed);
    EXPECT_NEAR(along, difference, allowed) << what;
  }
}

} // namespace

TEST(RandomGradients, agree_with_differences) {
  Tally tally;
  if (const unsigned seed = fromEnvironment("HARMOS_DESIGN_SEED", 0); seed > 0)
    return judge(seed, tally);
  const unsigned designs = fromEnvironment("HARMOS_DESIGNS", 10);
  for (unsigned seed = 1; seed <= designs; ++seed)
    judge(seed, tally);
  if (testComm()->getRank() == 0)
    std::cout << tally.gradients << " gradients, " << tally.open
              << " of them beside open contacts, the worst at " << tally.worst
              << " of what is allowed; without a derivative within the step: " << tally.beyond
              << ", refused: " << tally.refused << '\n';
  EXPECT_GE(tally.gradients, 3 * static_cast<int>(designs));
  EXPECT_GE(tally.open, 0.25 * tally.gradients);
  EXPECT_LE(tally.refused, 0.1 * tally.gradients);
  EXPECT_LE(tally.beyond, 0.05 * tally.gradients + 2);
}

} // namespace test_random_gradients
