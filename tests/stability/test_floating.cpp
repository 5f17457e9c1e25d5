// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases: bodies and subdomains that nothing but constraints holds, or that nothing holds at all.
///
///  - Floating body held by contact alone: K is singular, and only the compressive contact forces balance its
///    load. Without the coarse problem Gλ = 0 the answer balances it by whatever makes K⁺ regular. Cure:
///    natural coarse space, Farhat, Roux (1991), Int. J. Numer. Meth. Engng. 32; Dostál, Horák, Vlach (3.5).
///  - All subdomains floating (Total FETI, Dostál, Horák, Kučera 2006, Commun. Numer. Meth. Engng. 22): a
///    held copy of a dof with a row of its own and a gluing row too makes rows dependent.
///  - Rank-deficient G̃: a round body in a round hole rotates freely; a Cholesky factor of G̃G̃ᵀ without rank
///    detection divides by rounding errors. Cure: complete pivoting (Higham 2002, Accuracy and Stability,
///    section 10.3).
///  - A subdomain that touches one constraint: the interface dofs do not hold its kernel, the dense inverse
///  of
///    the condensed form does not exist. Cure: fixing nodes (Brzobohatý et al. 2011, IJNME 88) join them.
///  - A subdomain enclosed by another has no prescribed values and no corners: it floats.
///  - A body that is pulled away, a load that nothing balances: no solution, which is to be proved and told,
///    not iterated for.

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_HardCase.hpp"
#include "Harmos_PlateMesh.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

using namespace Harmos;
using fem::Point;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem, some hundreds here.
constexpr double tolerance = 1e-10;
constexpr double bound = 1e3 * tolerance;

// A floating body is made a held one by what makes its K⁺ regular: the coarse problem is gone.
TestModel withoutCoarseProblem(TestModel model) {
  for (feti::Subdomain& s : model.subdomains) {
    const feti::Kernel kernel = feti::heldKernel(*s.motions, {});
    const LocalMatrix matrix = *s.stiffness; // kept: the pointer may be the last one to it
    if (s.fixed.empty())
      s.stiffness = std::make_shared<LocalMatrix>(
          feti::regularized(matrix, kernel, feti::fixingDofs(matrix, kernel, 4)));
    s.motions = std::make_shared<feti::Kernel>(feti::Kernel{matrix.rows(), 0, {}});
  }
  return model;
}

// A disc of radius one in a rigid ring, pressed down.
scene::Scene discInRing() {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.origin = {-1.0, -1.0, 0.0};
  options.size = {2.0, 2.0, 0.0};
  options.subdomains = {2, 2, 1};
  options.elements = {3, 3, 1};
  options.map = [](const Point& x) {
    const double length = std::hypot(x[0], x[1]);
    const double factor = length > 0.0 ? std::max(std::abs(x[0]), std::abs(x[1])) / length : 0.0;
    return Point{factor * x[0], factor * x[1], 0.0};
  };
  scene.bodies.push_back(blockBody("disc", options, fem::Material::isotropic(1.0, 0.3)));
  addForce(scene, 0, {0.0, -0.02, 0.0});
  contact::Obstacle ring;
  ring.shape = contact::Obstacle::Shape::Cylinder;
  ring.direction = {0.0, 0.0, 1.0};
  ring.radius = -1.0;
  for (const char* set : {"left", "right", "bottom", "top"})
    addObstacle(scene, {0, set}, ring);
  return scene;
}

// Prescribed values as rows of each copy, by hand; with or without gluing rows between these copies.
TestModel withDirichletRows(const TestModel& model, bool glueToo) {
  const auto comm = testComm();
  TestModel result = withRows(model, Gluing::Orthonormal);
  struct Held {
    long long dof;
    double value;
  };
  std::vector<Held> mine;
  for (feti::Subdomain& s : result.subdomains) {
    for (const feti::FixedDof& f : s.fixed) {
      const auto place = std::lower_bound(s.interface->begin(), s.interface->end(), f.dof);
      mine.push_back({s.numbers[static_cast<std::size_t>(place - s.interface->begin())], f.value});
    }
    s.fixed.clear();
  }
  std::map<long long, double> held;
  for (const Held& item : gatherAll(*comm, mine))
    held[item.dof] = item.value;
  // Gluing rows are on the first rank, contacts where they were found.
  std::vector<ConstraintRow> rows;
  long long number = 0;
  for (ConstraintRow& row : result.rows) {
    if (row.kind == ConstraintRow::Kind::Equality) {
      if (!glueToo && held.count(row.terms.front().dof) > 0)
        continue;
      row.number = number++;
    } else { // prescribed values go to the bound
      std::vector<ConstraintRow::Term> terms;
      for (const ConstraintRow::Term& term : row.terms)
        if (const auto place = held.find(term.dof); place != held.end())
          row.bound -= term.coefficient * place->second;
        else
          terms.push_back(term);
      row.terms = terms;
    }
    rows.push_back(row);
  }
  if (comm->getRank() == 0)
    for (const auto& [dof, value] : held)
      rows.push_back({ConstraintRow::Kind::Equality, number++, {{dof, 1.0}}, value, 0.0});
  result.rows = rows;
  return result;
}

} // namespace

TEST(Stability, floating_body_held_by_contact_alone) {
  const scene::Scene scene = valley();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  EXPECT_TRUE(reference.freeMotions.empty());
  // Contact opens somewhere: the problem is not linear.
  EXPECT_GT(*std::max_element(reference.gap.begin(), reference.gap.end()), 1e-4);
  const TestRun run = runScene(scene, tolerance);
  expectReference(reference, run, bound);
  tellFigure("products", products(run.report));
  tellFigure("deviation", deviation(reference, run).largest());

  // The supports inside of K+ then carry the load, and nothing in the torn problem objects.
  const TornRun off = solveTorn(withoutCoarseProblem(modelOf(scene)), tolerance);
  EXPECT_TRUE(off.report.converged);
  EXPECT_GT(deviation(reference, off).force, 0.5);
  tellFigure("force deviation without coarse problem", deviation(reference, off).force);
}

TEST(Stability, all_subdomains_floating) {
  // Held at the bottom in one component and at the left in the other: each of three subdomains keeps some of
  // its motions.
  Valley options;
  options.held = {"left", "bottom"};
  const scene::Scene scene = valley(options);
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  const TestRun primal = runScene(scene, tolerance);
  expectReference(reference, primal, bound, "FETI");
  EXPECT_EQ(primal.report.kernelDimension, 0 + 1 + 1 + 3 + 4 * 3);
  const TestRun run = runScene(scene, tolerance, {"Decomposition/Dirichlet=dual"});
  EXPECT_EQ(run.report.kernelDimension, 3 * 8);
  expectReference(reference, run, bound, "Total FETI");
  tellFigure("products", products(run.report));
  tellFigure("deviation", deviation(reference, run).largest());

  // FETI that takes held subdomains for ones without motions.
  TestModel naive = modelOf(scene);
  for (feti::Subdomain& s : naive.subdomains)
    if (!s.fixed.empty())
      s.motions = std::make_shared<feti::Kernel>(feti::Kernel{s.stiffness->rows(), 0, {}});
  const std::string text = numericalErrorOf([&] { solveTorn(naive, tolerance); });
  EXPECT_TRUE(contains(text, "lacks support")) << text;

  // Gluing rows between copies that are held: B loses its rank.
  const TestModel model = modelOf(scene);
  const TestModel cured = withDirichletRows(model, false), dependent = withDirichletRows(model, true);
  EXPECT_NEAR(conditionOfRows(cured), 1.0, 1e-12);
  EXPECT_TRUE(std::isinf(conditionOfRows(dependent)));
  expectReference(reference, solveTorn(cured, tolerance), bound, "rows by hand");
}

TEST(Stability, rank_deficient_G) {
  const scene::Scene scene = discInRing();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  EXPECT_EQ(reference.freeMotions.size(), 1u);
  const TestRun run = runScene(scene, tolerance);
  EXPECT_EQ(run.report.kernelDimension, 12);
  EXPECT_EQ(run.report.coarseDimension, 11);
  expectReference(reference, run, bound);
  tellFigure("products", products(run.report));
  tellFigure("deviation", deviation(reference, run).largest());

  // Cholesky of the dense matrix without rank detection.
  const TestFeti feti(modelOf(scene));
  const int k = feti.coarse.kernelDimension(), n = static_cast<int>(feti.constraints.dualDimension());
  const auto map = feti.constraints.rowMap();
  Dense rows(k, n), factor(k, k);
  for (int j = 0; j < n; ++j) {
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0);
    unit[static_cast<std::size_t>(j)] = 1.0;
    const std::vector<double> column = feti.coarse.applyUnscaled(*toVector(unit, map));
    for (int i = 0; i < k; ++i)
      rows(i, j) = column[static_cast<std::size_t>(i)];
  }
  for (int i = 0; i < k; ++i)
    for (int j = 0; j < k; ++j)
      for (int l = 0; l < n; ++l)
        factor(i, j) += rows(i, l) * rows(j, l);
  for (int c = 0; c < k; ++c) {
    for (int j = 0; j < c; ++j)
      factor(c, c) -= factor(c, j) * factor(c, j);
    factor(c, c) = std::sqrt(factor(c, c));
    for (int i = c + 1; i < k; ++i) {
      for (int j = 0; j < c; ++j)
        factor(i, c) -= factor(i, j) * factor(c, j);
      factor(i, c) /= factor(c, c);
    }
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < k; ++i) {
      for (int l = 0; l < i; ++l)
        rows(i, j) -= factor(i, l) * rows(l, j);
      rows(i, j) /= factor(i, i);
    }
  double defect = 0.0; // of GG' = I
  for (int i = 0; i < k; ++i)
    for (int j = 0; j < k; ++j) {
      double sum = i == j ? -1.0 : 0.0;
      for (int l = 0; l < n; ++l)
        sum += rows(i, l) * rows(j, l);
      defect = std::abs(sum) <= defect ? defect : std::abs(sum);
    }
  // The square root of a negative pivot, or rows of rounding errors: no projector.
  EXPECT_FALSE(defect < 1e-3);
  tellFigure("|GG' - I| without rank detection", defect);
}

// A block that may slide and turn on another: three free motions of eight subdomains together. Pivots of
// theirs that are a little above n rounding errors were taken for motions that are held weakly, and G was
// noise.
TEST(Stability, block_that_slides_on_another) {
  const auto sceneOf = [](int subdomains) {
    scene::Scene scene;
    scene.physics = Physics::Solid;
    fem::StructuredBlock::Options options;
    options.cellType = fem::CellType::Hexahedron8;
    options.size = {2.0, 1.0, 1.0};
    options.subdomains = {2, 2, 2};
    options.elements = {8, 8, 8};
    scene.bodies.push_back(blockBody("base", options, fem::Material::isotropic(210.0, 0.3)));
    options.origin = {0.5, 1.0, 0.0};
    options.size = {1.0, 1.0, 1.0};
    options.subdomains = {subdomains, subdomains, subdomains};
    options.elements = {16 / subdomains, 16 / subdomains, 16 / subdomains};
    scene.bodies.push_back(blockBody("load", options, fem::Material::isotropic(210.0, 0.3)));
    addContact(scene, {1, "front"}, {0, "back"});
    for (int component = 0; component < 3; ++component)
      prescribe(scene, {0, "front"}, component);
    addForce(scene, 1, {0.0, -0.1, 0.0});
    return scene;
  };
  // Whole, it has six motions, of which three are held: nothing that could be taken for weakly held.
  const TestRun whole = runScene(sceneOf(1), tolerance), torn = runScene(sceneOf(2), tolerance);
  for (const TestRun* run : {&whole, &torn}) {
    EXPECT_TRUE(run->report.converged);
    EXPECT_EQ(run->report.coarseDimension, run->report.kernelDimension - 3);
  }
  EXPECT_NEAR(torn.report.audit.energy / whole.report.audit.energy, 1.0, bound);
  tellFigure("products", products(torn.report));
  tellFigure("deviation", std::abs(torn.report.audit.energy / whole.report.audit.energy - 1.0));
}

TEST(Stability, subdomain_touching_only_one_constraint) {
  // A block that stands on one node: the middle of its bottom; two motions remain free.
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.elements = {4, 4, 1};
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  addForce(scene, 0, {0.0, -0.02, 0.0});
  addObstacle(scene, {0, "bottom"}, halfSpace({}, {0.0, 1.0, 0.0}));
  TestModel model = modelOf(scene);
  const long long middle = 2;
  std::vector<ConstraintRow> one;
  for (ConstraintRow& row : model.rows)
    if (row.number == middle) {
      row.number = 0;
      one.push_back(row);
    }
  model.rows = one;
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  ASSERT_TRUE(reference.solvable);
  EXPECT_EQ(reference.freeMotions.size(), 2u);
  EXPECT_NEAR(reference.force[0], 0.02, 1e-12);
  for (const char* form : {"condensed", "implicit"}) {
    const TornRun run = solveTorn(model, tolerance, {std::string("Dual operator/Form=") + form});
    expectReference(reference, run, bound, form);
    tellFigure(std::string("deviation, ") + form, deviation(reference, run).largest());
  }

  // The dense inverse on the dofs that B touches alone.
  const feti::SubdomainSystem system(testComm(), model.subdomains, feti::DirichletForm::Primal);
  const feti::Constraints constraints(system, model.rows);
  const std::string text = numericalErrorOf([&] {
    agree(*testComm(), [&] {
      for (int i = 0; i < system.size(); ++i) {
        std::vector<int> touched;
        for (const feti::Constraints::Entry& entry : constraints.entries(i))
          touched.push_back(entry.dof);
        const auto context = std::make_shared<feti::FactorizationContext>();
        feti::makeCondensedInverse(system.matrix(i), system.kernel(i), touched, 1, {}, context);
      }
    });
  });
  EXPECT_TRUE(contains(text, "a kernel has more columns")) << text;
}

// A stiff square fibre in a plate that is held at its left and drawn at its right: glued, and in contact.
TEST(Stability, subdomain_enclosed_by_another) {
  fem::StructuredBlock::Options options;
  options.elements = {6, 6, 1};
  const fem::BodyMesh plate = wholeBlock(options);
  const std::vector<int> isFibre = cellsBy(plate.mesh, [](const Point& x) {
    return std::max(std::abs(x[0] - 0.5), std::abs(x[1] - 0.5)) < 0.17 ? 1 : 0;
  });
  for (bool glued : {true, false}) {
    scene::Scene scene;
    scene.physics = Physics::PlaneStrain;
    long long next = 0;
    if (glued) {
      fem::BodyMesh both = plate;
      both.mesh.regions = isFibre;
      both.regions = {"matrix", "fibre"};
      scene.bodies.push_back(tornBody(
          both, isFibre, next, {fem::Material::isotropic(1.0, 0.3), fem::Material::isotropic(100.0, 0.2)}));
    } else {
      for (int k : {0, 1}) {
        const fem::BodyMesh body = extracted(plate, isFibre, k, "interface");
        scene.bodies.push_back(tornBody(body, std::vector<int>(body.mesh.cells.size() / 4, 0), next,
                                        {fem::Material::isotropic(k == 0 ? 1.0 : 100.0, 0.3)}));
      }
      scene.bodies[0].name = "plate";
      scene.bodies[1].name = "fibre";
      addContact(scene, {1, "interface"}, {0, "interface"});
      // Something for the fibre to lean on.
      addForce(scene, 1, {0.01, -0.02, 0.0});
    }
    for (int component : {0, 1})
      prescribe(scene, {0, "left"}, component);
    addTraction(scene, {0, "right"}, {0.01, 0.0, 0.0});
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    const std::string what = glued ? "glued" : "contact";
    for (const char* form : {"primal", "dual"}) {
      const TestRun run = runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
      expectReference(reference, run, bound, what);
      tellFigure(what + " products, " + form, products(run.report));
      tellFigure(what + " deviation, " + form, deviation(reference, run).largest());
    }
    const TornRun off = solveTorn(withoutCoarseProblem(modelOf(scene)), tolerance);
    EXPECT_TRUE(off.report.converged);
    EXPECT_GT(deviation(reference, off).displacement, 0.05);
    tellFigure(what + " deviation without coarse problem", deviation(reference, off).displacement);
  }
}

TEST(Stability, body_pulled_away) {
  Valley options;
  options.load = -0.02;
  options.aside = 0.0;
  const scene::Scene scene = valley(options);
  EXPECT_FALSE(referenceSolution(scene).solvable); // Lemke's algorithm ends in a ray
  for (const char* form : {"primal", "dual"})
    for (const char* method : {"PDAS", "SMALBE", "Dual Penalty"}) {
      const TestRun run =
          runScene(scene, 1e-6,
                   {std::string("Decomposition/Dirichlet=") + form, std::string("Solver/Method=") + method});
      EXPECT_FALSE(run.report.converged);
      EXPECT_EQ(run.report.result.reason, qp::Reason::Infeasible) << run.report.reason;
      EXPECT_TRUE(contains(run.report.reason, "unconstrained rigid-body mode under load: \"floating\""))
          << run.report.reason;
      tellFigure(std::string("products, ") + form + " " + method, products(run.report));
    }
}

TEST(Stability, inconsistent_load) {
  // A block on a flat floor, which does not hold it sideways.
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {2, 2, 1};
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  addObstacle(scene, {0, "bottom"}, halfSpace({}, {0.0, 1.0, 0.0}));
  addForce(scene, 0, {0.0, -0.02, 0.0});
  const scene::Scene balanced = scene;
  addTraction(scene, {0, "left"}, {1e-4, 0.0, 0.0});
  EXPECT_FALSE(referenceSolution(scene).solvable);
  for (const char* form : {"primal", "dual"}) {
    const std::string text = numericalErrorOf(
        [&] { runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form}); });
    EXPECT_TRUE(contains(text, "body \"block\"") && contains(text, "unbalanced load")) << text;
  }
  // Forces that pull at both sides are in balance.
  scene::Scene drawn = balanced;
  addTraction(drawn, {0, "left"}, {-0.01, 0.0, 0.0});
  addTraction(drawn, {0, "right"}, {0.01, 0.0, 0.0});
  const ReferenceSolution reference = referenceSolution(drawn);
  ASSERT_TRUE(reference.solvable);
  EXPECT_EQ(reference.freeMotions.size(), 1u);
  const TestRun run = runScene(drawn, tolerance);
  expectReference(reference, run, bound);
  tellFigure("deviation", deviation(reference, run).largest());
}
