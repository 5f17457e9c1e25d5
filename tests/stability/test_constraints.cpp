// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of constraint rows: where many subdomains meet, where rows repeat each other, where contact
/// begins elsewhere than it ends.
///
///  - Cross points: at a dof of m copies the chained non-redundant gluing rows have κ(BBᵀ) = O(m²), all pairs
///    of copies are linearly dependent. Cure: m − 1 orthonormal rows (Dostál, Horák, Vlach, section 3).
///  - Contact node at a cross point: a row that takes one copy is not orthogonal to the gluing rows, κ(BBᵀ) =
///    5.8 in the plane. Cure: the mean of the copies.
///  - Duplicated contact rows: F is singular on the active set and the forces of the copies are arbitrary.
///    Cure: points of equal terms and normals become one row.
///  - Violated strict complementarity: touching with zero force; the active set is not determined by signs,
///    which rounding errors decide (Dostál 2009, Optimal Quadratic Programming Algorithms, section 5.8, for
///    methods that terminate all the same).
///  - Initial gap, initial penetration, infeasible start: rigid motions that no force accompanies. Cure: α
///    from the multiplier of Gλ = 0 (section 2.2 of the design of the dual problem).

#include "Harmos_Exchange.hpp"
#include "Harmos_HardCase.hpp"
#include "Harmos_PlateMesh.hpp"

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

// A disc of triangles cut into sectors that all meet at the centre, lying in a rigid ring.
scene::Scene discOfSectors(int sectors) {
  constexpr int rings = 2, pieces = 2;
  const int around = sectors * pieces;
  fem::BodyMesh disc;
  disc.name = "disc";
  disc.regions = {"all"};
  disc.mesh.cellType = fem::CellType::Triangle3;
  disc.mesh.coordinates = {0.0, 0.0};
  for (int r = 1; r <= rings; ++r)
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * 3.14159265358979323846 * k / around;
      disc.mesh.coordinates.push_back(std::cos(angle) * r / rings);
      disc.mesh.coordinates.push_back(std::sin(angle) * r / rings);
    }
  const auto node = [&](int r, int k) { return r == 0 ? 0 : 1 + (r - 1) * around + k % around; };
  std::vector<int> part;
  const auto addCell = [&](int a, int b, int c, int k) {
    disc.mesh.cells.insert(disc.mesh.cells.end(), {a, b, c});
    part.push_back(k / pieces);
  };
  for (int k = 0; k < around; ++k) {
    addCell(0, node(1, k), node(1, k + 1), k);
    for (int r = 1; r < rings; ++r) {
      addCell(node(r, k), node(r + 1, k), node(r + 1, k + 1), k);
      addCell(node(r, k), node(r + 1, k + 1), node(r, k + 1), k);
    }
  }
  const std::vector<fem::Side> rim = fem::boundarySides(disc.mesh);
  disc.sides["rim"] = rim;
  disc.mesh.boundary = fem::nodesOf(disc.mesh, rim);
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  long long next = 0;
  scene.bodies.push_back(tornBody(disc, part, next, {fem::Material::isotropic(1.0, 0.3)}));
  addForce(scene, 0, {0.003, -0.02, 0.0});
  contact::Obstacle ring;
  ring.shape = contact::Obstacle::Shape::Cylinder;
  ring.direction = {0.0, 0.0, 1.0};
  ring.radius = -1.0;
  addObstacle(scene, {0, "rim"}, ring);
  return scene;
}

// The same on every rank: values of the dofs of this rank's subdomains that have a number.
struct NumberedValue {
  double value;
  int copies;
};
std::map<long long, NumberedValue> byNumber(const TestModel& model, const feti::TornVector& u) {
  struct Item {
    long long dof;
    double value;
  };
  std::vector<Item> mine;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < model.subdomains[i].numbers.size(); ++k)
      mine.push_back({model.subdomains[i].numbers[k],
                      u[i][static_cast<std::size_t>((*model.subdomains[i].interface)[k])]});
  std::map<long long, NumberedValue> all;
  for (const Item& item : gatherAll(*testComm(), mine)) {
    const auto [place, isNew] = all.emplace(item.dof, NumberedValue{item.value, 1});
    place->second.copies += isNew ? 0 : 1;
  }
  return all;
}

struct Manufactured {
  TestModel model;
  feti::TornVector displacement;
  std::vector<double> force; ///< by rows
};

// Two membranes that touch in every node of their interface, with a force at every other one or at each;
// loads and gaps are made to fit.
Manufactured touching(int every) {
  const auto comm = testComm();
  Manufactured result;
  TestModel& model = result.model = testModel(2, 6);
  for (const feti::Subdomain& s : model.subdomains) {
    result.displacement.emplace_back();
    for (int i = 0; i < s.stiffness->rows(); ++i)
      result.displacement.back().push_back(std::sin(1.0 + 0.37 * i + static_cast<double>(s.number)));
    for (std::size_t k = 0; k < s.numbers.size(); ++k) // the same at all copies
      result.displacement.back()[static_cast<std::size_t>((*s.interface)[k])] =
          std::cos(0.1 * static_cast<double>(s.numbers[k]));
    for (const feti::FixedDof& f : s.fixed)
      result.displacement.back()[static_cast<std::size_t>(f.dof)] = f.value;
  }
  const auto values = byNumber(model, result.displacement);
  struct Push {
    long long dof;
    double force;
  };
  std::vector<Push> pushes;
  result.force.assign(static_cast<std::size_t>(globalSum(*comm, static_cast<long long>(model.rows.size()))),
                      0.0);
  for (ConstraintRow& row : model.rows) {
    const double force = row.number % every == 0 ? 1.0 + 0.1 * static_cast<double>(row.number) : 0.0;
    result.force[static_cast<std::size_t>(row.number)] = force;
    row.bound = 0.0;
    for (const ConstraintRow::Term& term : row.terms) {
      row.bound += term.coefficient * values.at(term.dof).value;
      pushes.push_back({term.dof, term.coefficient * force});
    }
  }
  globalSum(*comm, result.force);
  std::map<long long, double> push;
  for (const Push& item : gatherAll(*comm, pushes))
    push[item.dof] += item.force;
  for (std::size_t i = 0; i < model.subdomains.size(); ++i) {
    feti::Subdomain& s = model.subdomains[i];
    changeLoad(s, [&](std::vector<double>& load) {
      s.stiffness->multiply(result.displacement[i].data(), load.data());
      for (std::size_t k = 0; k < s.numbers.size(); ++k)
        if (const auto found = push.find(s.numbers[k]); found != push.end())
          load[static_cast<std::size_t>((*s.interface)[k])] += found->second / values.at(s.numbers[k]).copies;
    });
  }
  return result;
}

// Products with F of a torn problem, whose solution is checked.
double checkedProducts(const ReferenceSolution& reference, const TestModel& rows, const std::string& kind) {
  const TornRun torn = solveTorn(rows, tolerance, {"Dual operator/Preconditioner=" + kind});
  expectReference(reference, torn, bound, kind.c_str());
  return products(torn.report);
}

} // namespace

TEST(Stability, cross_points_with_many_subdomains) {
  const int sectors = 16;
  const scene::Scene scene = discOfSectors(sectors);
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  const TestModel model = modelOf(scene), chain = withRows(model, Gluing::Chain),
                  pairs = withRows(model, Gluing::AllPairs);
  const TestRun run = runScene(scene, tolerance);
  expectReference(reference, run, bound);
  EXPECT_NEAR(conditionOfRows(model), 1.0, 1e-12);
  tellFigure("products", products(run.report));
  tellFigure("deviation", deviation(reference, run).largest());

  // Eigenvalues of the chain's tridiagonal BB': 2 - 2 cos(k pi/m), k = 1 ... m - 1.
  const double angle = 3.14159265358979323846 / sectors;
  const double condition = (1.0 + std::cos(angle)) / (1.0 - std::cos(angle));
  EXPECT_NEAR(conditionOfRows(chain), condition, 1e-10 * condition);
  EXPECT_TRUE(std::isinf(conditionOfRows(pairs)));
  tellFigure("condition of BB', chain", conditionOfRows(chain));
  // The preconditioner B_D S B_D' with B_D = (BB')^-1 B mends most of it; without one it is paid in full.
  const double cured = checkedProducts(reference, model, "none"),
               off = checkedProducts(reference, chain, "none");
  tellFigure("products without preconditioner", cured);
  tellFigure("products without preconditioner, chain", off);
  EXPECT_GT(off, 1.2 * cured);
  tellFigure("products, chain", checkedProducts(reference, chain, "Dirichlet"));
}

TEST(Stability, contact_node_at_a_cross_point) {
  const TestModel model = testModel(4, 3);
  const ReferenceSolution reference = referenceSolution(*testComm(), model.subdomains, model.rows);
  ASSERT_TRUE(reference.solvable);
  const TestModel one = withRows(model, Gluing::Orthonormal, Copies::First);
  EXPECT_NEAR(conditionOfRows(model), 1.0, 1e-12);
  EXPECT_NEAR(conditionOfRows(withRows(model, Gluing::Orthonormal)), 1.0, 1e-12);
  // Three gluing rows and the contact row at four copies that meet two bodies' cross points: 3 + sqrt(8).
  EXPECT_NEAR(conditionOfRows(one), 3.0 + std::sqrt(8.0), 1e-10);
  tellFigure("condition of BB', one copy", conditionOfRows(one));
  const double cured = checkedProducts(reference, model, "none"),
               off = checkedProducts(reference, one, "none");
  tellFigure("products without preconditioner", cured);
  tellFigure("products without preconditioner, one copy", off);
  EXPECT_GT(off, 1.1 * cured);
  tellFigure("products", checkedProducts(reference, model, "Dirichlet"));
}

TEST(Stability, contact_where_both_are_tied_to_a_third) {
  for (double jump : {1.0, 1e3}) {
    scene::Scene scene;
    scene.physics = scene::Physics::PlaneStrain;
    fem::StructuredBlock::Options options;
    options.cellType = fem::CellType::Quadrilateral4;
    options.elements = {4, 4, 1};
    scene.bodies.push_back(blockBody("low", options, fem::Material::isotropic(1.0, 0.3)));
    options.origin = {0.0, 1.0, 0.0};
    scene.bodies.push_back(blockBody("up", options, fem::Material::isotropic(1.0, 0.3)));
    options.origin = {-1.0, 0.0, 0.0};
    options.size = {1.0, 2.0, 1.0};
    options.elements = {4, 8, 1};
    scene.bodies.push_back(blockBody("wall", options, fem::Material::isotropic(jump, 0.3)));
    for (int c : {0, 1}) {
      prescribe(scene, {0, "bottom"}, c);
      prescribe(scene, {2, "left"}, c);
    }
    for (int body : {0, 1})
      addTie(scene, {body, "left"}, {2, "right"});
    addContact(scene, {0, "top"}, {1, "bottom"});
    addTraction(scene, {1, "top"}, fem::Point{0.0, -0.01, 0.0});
    // The dense solver takes no dependent inequalities: another method, form and inner product in its place.
    const TestRun run = runScene(scene, tolerance),
                  other = runScene(scene, tolerance,
                                   {"Dual operator/Expert/Weights=none", "Decomposition/Dirichlet=dual",
                                    "Dual operator/Form=implicit", "Solver/Method=SMALBE"});
    const std::string name = "1 to " + std::to_string(static_cast<int>(jump));
    for (const TestRun* one : {&run, &other}) {
      EXPECT_TRUE(one->report.converged) << name << ": " << one->report.reason;
      EXPECT_TRUE(feti::auditAgrees(one->report)) << name;
    }
    EXPECT_NEAR(run.report.audit.energy / other.report.audit.energy, 1.0, bound) << name;
    tellFigure(name + ": products", products(run.report));
    EXPECT_LE(products(run.report), 20.0) << name;
  }
}

TEST(Stability, duplicated_and_redundant_contact_rows) {
  scene::Scene scene = valley();
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  const TestModel once = modelOf(scene);
  addContact(scene, {1, "bottom"}, {0, "top"}, 0.5); // the smaller gap counts
  addContact(scene, {0, "top"}, {1, "bottom"});
  const TestRun run = runScene(scene, tolerance);
  EXPECT_EQ(run.report.inequalities, static_cast<long long>(reference.force.size()));
  expectReference(reference, run, bound);
  tellFigure("products", products(run.report));

  // The same rows given twice.
  TestModel twice = once;
  const auto count = static_cast<long long>(reference.force.size());
  for (const ConstraintRow& row : once.rows) {
    ConstraintRow copy = row;
    copy.number += count;
    twice.rows.push_back(copy);
  }
  EXPECT_TRUE(std::isinf(conditionOfRows(twice)));
  for (const char* kind : {"none", "Dirichlet"}) {
    const TornRun off = solveTorn(twice, tolerance, {std::string("Dual operator/Preconditioner=") + kind});
    const std::vector<double> first(off.force.begin(), off.force.begin() + count);
    const Deviation wrong = deviation(reference, off.torn.displacement, first, off.report.audit.energy);
    EXPECT_TRUE(off.report.converged);
    EXPECT_GT(wrong.force, 0.3); // half of the force, or what else the solver happens to give to each
    tellFigure(std::string("force deviation, rows twice, ") + kind, wrong.force);
  }
}

TEST(Stability, violated_strict_complementarity) {
  for (int every : {1, 2}) {
    const Manufactured problem = touching(every);
    const ReferenceSolution reference =
        referenceSolution(*testComm(), problem.model.subdomains, problem.model.rows);
    ASSERT_TRUE(reference.solvable);
    // Known beforehand, too.
    EXPECT_LE(deviation(reference, problem.displacement, problem.force, reference.energy).largest(), 1e-13);
    for (const char* method : {"PDAS", "SMALBE"}) {
      const TornRun run = solveTorn(problem.model, tolerance, {std::string("Solver/Method=") + method});
      const std::string name = std::string(method) + (every == 1 ? ", strict" : ", violated");
      expectReference(reference, run, bound, name);
      tellFigure("products, " + name, products(run.report));
      tellFigure("deviation, " + name, deviation(reference, run).largest());
    }
  }
}

TEST(Stability, initial_gap) {
  // The upper block falls through the gap before it bears.
  for (double gap : {1e-3, 0.02, 0.5}) {
    Valley options;
    options.gap = gap;
    const scene::Scene scene = valley(options);
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    for (const char* form : {"primal", "dual"}) {
      const TestRun run = runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
      expectReference(reference, run, bound, form);
      tellFigure(std::to_string(gap) + ", " + form + ": products", products(run.report));
      tellFigure(std::to_string(gap) + ", " + form + ": deviation", deviation(reference, run).largest());
    }
  }
}

TEST(Stability, initial_penetration) {
  for (double load : {0.02, 0.0}) {
    Valley options;
    options.gap = -0.02;
    options.load = load;
    options.aside = 0.35 * load;
    const scene::Scene scene = valley(options);
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    const TestFeti feti(modelOf(scene), feti::DirichletForm::Primal, testOptions(tolerance).dual.inverses);
    const TornRun run = solveTorn(feti, tolerance);
    if (load > 0.0) {
      expectReference(reference, run, bound);
      expectReference(reference, runScene(scene, tolerance), bound);
      continue;
    }
    // Without a load any position above is an answer, and all forces vanish.
    EXPECT_TRUE(run.report.converged) << run.report.reason;
    EXPECT_LE(run.report.audit.penetration, bound * 0.02);
    EXPECT_LE(run.report.audit.largestMultiplier, bound * 0.02);
    EXPECT_LE(std::abs(run.report.audit.energy), bound * 0.02 * 0.02);
    tellFigure("unloaded: products", products(run.report));
    tellFigure("unloaded: penetration", run.report.audit.penetration);
    // α from the rows that carry a force alone: none does, and glued rows are at rest where nothing moves.
    feti::TornSolution off = run.torn;
    off.displacement = feti.system.zeroVector();
    const feti::KktAudit audit = feti::audit(feti.system, feti.constraints, off);
    EXPECT_NEAR(audit.penetration, 0.02, 1e-12);
    tellFigure("penetration without the multiplier's rigid motion", audit.penetration);
    for (const char* method : {"PDAS", "SMALBE"})
      for (const char* preconditioner : {"none", "Dirichlet"}) {
        const std::string what = std::string(method) + ", " + preconditioner;
        const TestRun other = runScene(scene, tolerance,
                                       {std::string("Solver/Method=") + method,
                                        std::string("Dual operator/Preconditioner=") + preconditioner});
        EXPECT_TRUE(other.report.converged) << what << ": " << other.report.reason;
        EXPECT_LE(other.report.audit.penetration, bound * 0.02) << what;
        EXPECT_LE(other.report.audit.largestMultiplier, bound * 0.02) << what;
        tellFigure("unloaded: products, " + what, products(other.report));
      }
  }
}

TEST(Stability, infeasible_start) {
  Valley options;
  options.gap = -0.02;
  const scene::Scene scene = valley(options);
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* method : {"PDAS", "SMALBE"})
    for (const char* guess : {"zero", "half load"}) {
      const TestRun run = runScene(
          scene, tolerance,
          {std::string("Solver/Method=") + method, std::string("Solver/Expert/Initial guess=") + guess});
      expectReference(reference, run, bound, guess);
      tellFigure(std::string("products, ") + method + ", " + guess, products(run.report));
    }
}
