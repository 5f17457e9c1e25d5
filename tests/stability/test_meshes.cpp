// SPDX-License-Identifier: BSD-3-Clause

/// Hard cases of meshes and the pieces they are cut into.
///
///  - Hinge and mechanism subdomains: pieces that hang together in a node have more motions than the rigid
///    ones; K⁺ made with those alone is the inverse of a matrix that is singular to rounding. Cure: parts are
///    cut where they do not share a side (fem::mendParts); what is left is found by a probe outside of the
///    range of K and named; a kernel may be given with the hinge's motion.
///  - Disconnected METIS subdomain (Karypis, Kumar 1998, do not promise connected parts): as above.
///  - Slivers and bad aspect ratio: K_ρ held at neighbouring places is worse conditioned than K by the aspect
///    ratio squared. Cure: places spread by farthest-first traversal until they hold the kernel (Brzobohatý
///    et al. 2011, IJNME 88).

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_HardCase.hpp"
#include "Harmos_InverseQuality.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_PlateMesh.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace Harmos;
using fem::Point;
using scene::Physics;

namespace {

// Of the solver. Answers may be wrong by it times the condition of the dual problem, some hundreds here.
constexpr double tolerance = 1e-10;
constexpr double bound = 1e3 * tolerance;

// Two squares that share a node: the left one is held, the other one turns about the node, pressed down,
// until it leans against a wall.
fem::BodyMesh hingedSquares() {
  fem::StructuredBlock::Options options;
  options.elements = {4, 4, 1};
  const fem::BodyMesh block = wholeBlock(options);
  const std::vector<int> kept =
      cellsBy(block.mesh, [](const Point& x) { return (x[0] < 0.5) == (x[1] < 0.5) ? 0 : 1; });
  return extracted(block, kept, 0, "cut");
}

scene::Scene hinge(const std::vector<int>& part) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  long long next = 0;
  scene.bodies.push_back(tornBody(hingedSquares(), part, next, {fem::Material::isotropic(1.0, 0.3)}));
  for (int component : {0, 1})
    prescribe(scene, {0, "left"}, component);
  addForce(scene, 0, {0.0, -0.02, 0.0});
  addObstacle(scene, {0, "right"}, halfSpace({1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}));
  return scene;
}

// A plate on a floor, pressed down, held sideways at its left.
scene::Scene plate(const fem::BodyMesh& body, const std::vector<int>& part) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  long long next = 0;
  scene.bodies.push_back(tornBody(body, part, next, {fem::Material::isotropic(1.0, 0.3)}));
  prescribe(scene, {0, "left"}, 0);
  addForce(scene, 0, {0.01, -0.02, 0.0});
  addObstacle(scene, {0, "bottom"}, halfSpace({}, {0.0, 1.0, 0.0}));
  return scene;
}

// K⁺ with the kernel held at given dofs.
class HeldAt : public feti::LocalInverse {
 public:
  HeldAt(const LocalMatrix& matrix, const feti::Kernel& kernel, const std::vector<int>& dofs)
      : factor_(feti::makeLocalFactorization(feti::regularized(matrix, kernel, dofs), byMumps(),
                                             std::make_shared<feti::FactorizationContext>())),
        block_(matrix, dofs) {}
  void apply(double* x, int count) const override { factor_->solve(x, count); }
  const feti::BoundaryOperator& boundaryOperator() const override { return block_; }
  std::shared_ptr<const feti::BoundaryOperator> schurComplement() const override { return nullptr; }
  double bytes() const override { return 0.0; }
  void refactor(const LocalMatrix& matrix, const feti::Kernel&) override { factor_->refactor(matrix); }
  void roundSchurComplement() override {}
  feti::FactorizationCounts counts() const override { return factor_->counts(); }

 private:
  static feti::LocalFactorizationSettings byMumps() {
    feti::LocalFactorizationSettings settings;
    settings.solver.name = feti::SparseSolverChoice::mumps;
    return settings;
  }
  std::unique_ptr<feti::LocalFactorization> factor_;
  feti::SparseOperator block_; // not asked for
};

} // namespace

TEST(Stability, hinge_and_mechanism_subdomains) {
  const fem::BodyMesh body = hingedSquares();
  const std::vector<int> one(static_cast<std::size_t>(body.mesh.numberOfCells()), 0);
  const fem::Partition mended = fem::mendParts(body, one);
  EXPECT_EQ(mended.parts, 2);
  const scene::Scene scene = hinge(mended.part), whole = hinge(one);
  const ReferenceSolution reference = referenceSolution(scene), sameReference = referenceSolution(whole);
  ASSERT_TRUE(reference.solvable && sameReference.solvable);
  EXPECT_NEAR(reference.energy, sameReference.energy, 1e-12 * std::abs(reference.energy));
  const TestRun run = runScene(scene, tolerance);
  expectReference(reference, run, bound);
  tellFigure("products", products(run.report));
  tellFigure("deviation", deviation(reference, run).largest());

  // As one subdomain, with the rigid motions alone: an error that tells the cause.
  for (const char* form : {"primal", "dual"})
    for (const char* how : {"condensed", "implicit"}) {
      const std::string text = numericalErrorOf([&] {
        runScene(whole, tolerance,
                 {std::string("Decomposition/Dirichlet=") + form, std::string("Dual operator/Form=") + how});
      });
      EXPECT_TRUE(contains(text, "subdomain 0") &&
                  contains(text, form[0] == 'd' ? "a mechanism or a hinge" : "lacks support"))
          << text;
    }
  // With the hinge's motion in the kernel all is well again.
  TestModel model = modelOf(whole);
  for (feti::Subdomain& s : model.subdomains) {
    auto motions = std::make_shared<feti::Kernel>(*s.motions);
    for (int node = 0; node < body.mesh.numberOfNodes(); ++node) {
      const Point x = body.mesh.local(node);
      const bool turns = x[0] > 0.5 || x[1] > 0.5;
      motions->values.push_back(turns ? 0.5 - x[1] : 0.0);
      motions->values.push_back(turns ? x[0] - 0.5 : 0.0);
    }
    ++motions->columns;
    s.motions = motions;
  }
  const TornRun given = solveTorn(model, tolerance);
  expectReference(sameReference, given, bound, "given kernel");
}

TEST(Stability, disconnected_METIS_subdomain) {
  fem::StructuredBlock::Options options;
  options.elements = {6, 6, 1};
  const fem::BodyMesh body = wholeBlock(options);
  // As METIS may answer: the left and the right third are one part.
  const std::vector<int> part =
      cellsBy(body.mesh, [](const Point& x) { return std::abs(x[0] - 0.5) < 1.0 / 6 ? 1 : 0; });
  const fem::Partition mended = fem::mendParts(body, part);
  EXPECT_EQ(mended.parts, 3);
  const scene::Scene scene = plate(body, mended.part);
  const ReferenceSolution reference = referenceSolution(scene);
  ASSERT_TRUE(reference.solvable);
  for (const char* form : {"primal", "dual"}) {
    const TestRun run = runScene(scene, tolerance, {std::string("Decomposition/Dirichlet=") + form});
    expectReference(reference, run, bound, form);
    tellFigure(std::string("products, ") + form, products(run.report));
    tellFigure(std::string("deviation, ") + form, deviation(reference, run).largest());
    const std::string text = numericalErrorOf(
        [&] { runScene(plate(body, part), tolerance, {std::string("Decomposition/Dirichlet=") + form}); });
    EXPECT_TRUE(contains(text, "subdomain 0") && contains(text, "2 parts that are not connected")) << text;
  }
}

TEST(Stability, slivers_and_bad_aspect_ratio) {
  // A foil with cells of 1:1000 between a floor and a block that presses on it; held sideways only.
  for (fem::CellType type : {fem::CellType::Quadrilateral4, fem::CellType::Triangle3}) {
    scene::Scene scene;
    scene.physics = Physics::PlaneStrain;
    fem::StructuredBlock::Options options;
    options.cellType = type;
    options.subdomains = {2, 1, 1};
    options.elements = {4, 2, 1};
    const double thickness = 2 * 0.125 / 1000.0;
    options.size = {1.0, thickness, 0.0};
    scene.bodies.push_back(blockBody("foil", options, fem::Material::isotropic(1.0, 0.3)));
    options.origin[1] = thickness;
    options.size[1] = 1.0;
    scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
    for (int body : {0, 1})
      prescribe(scene, {body, "left"}, 0);
    addTraction(scene, {1, "top"}, {0.0, -0.01, 0.0});
    addForce(scene, 1, {0.005, 0.0, 0.0});
    addObstacle(scene, {0, "bottom"}, halfSpace({}, {0.0, 1.0, 0.0}));
    addContact(scene, {0, "top"}, {1, "bottom"});
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    const std::string name = fem::shapeOf(type).name;
    for (const char* form : {"primal", "dual"}) {
      // ‖F‖‖λ‖ is 10³ times ‖Pd‖, by the foil's cells: 1e-10 of the latter, 2e-13, is but three times the
      // rounding of the former, and with some kernels of BLAS out of reach.
      const double reachable = 10.0 * tolerance;
      const TestRun run = runScene(scene, reachable, {std::string("Decomposition/Dirichlet=") + form});
      expectReference(reference, run, bound, name);
      tellFigure(name + ", " + form + ": condition of the subdomains", run.report.localCondition);
      tellFigure(name + ", " + form + ": products", products(run.report));
      tellFigure(name + ", " + form + ": deviation", deviation(reference, run).largest());
    }

    const TestModel model = modelOf(scene);
    // The kernel of a piece of foil held at spread places, and at two neighbouring nodes across it.
    double spread = 0.0, close = 0.0;
    agree(*testComm(), [&] {
      for (const feti::Subdomain& s : model.subdomains)
        if (s.number == 1) { // not at the left
          const feti::Kernel kernel = feti::heldKernel(*s.motions, {});
          const auto defect = [&](const std::vector<int>& dofs) {
            return feti::inverseQuality(*s.stiffness, kernel, HeldAt(*s.stiffness, kernel, dofs)).defect;
          };
          spread = defect(feti::fixingDofs(*s.stiffness, kernel, 4));
          close = defect({0, 1, 10, 11});
        }
    });
    spread = globalMax(*testComm(), spread);
    close = globalMax(*testComm(), close);
    EXPECT_LT(spread, 1e-12);
    EXPECT_GT(close, 1e4 * spread);
    tellFigure(name + ": defect of K+, spread", spread);
    tellFigure(name + ": defect of K+, held at neighbours", close);
  }
}

// Two strips, one on the other, held at the ends of the lower one and bent by a load: their bending makes the
// dual problem badly conditioned, and active sets that are made of rough solutions wander.
TEST(Stability, slender_bodies_in_contact) {
  std::vector<double> ofSlenderest;
  for (double length : {10.0, 20.0, 38.0, 39.0, 40.0, 41.0, 42.0}) {
    scene::Scene scene;
    scene.physics = Physics::PlaneStrain;
    fem::StructuredBlock::Options options;
    options.cellType = fem::CellType::Triangle6;
    options.subdomains = {4, 1, 1};
    options.elements = {6, 1, 1};
    options.size = {length, 1.0, 0.0};
    for (int body : {0, 1}) {
      options.origin[1] = body;
      scene.bodies.push_back(
          blockBody(body == 0 ? "lower" : "upper", options, fem::Material::isotropic(1.0, 0.4999)));
      prescribe(scene, {body, "left"}, 0);
    }
    prescribe(scene, {0, "left"}, 1);
    for (int component : {0, 1})
      prescribe(scene, {0, "right"}, component);
    addTraction(scene, {1, "top"}, {0.0, -1e-6, 0.0});
    addContact(scene, {1, "bottom"}, {0, "top"});
    const ReferenceSolution reference = referenceSolution(scene);
    ASSERT_TRUE(reference.solvable);
    const TestRun run = runScene(scene, tolerance);
    expectReference(reference, run, bound);
    if (length > 20.0)
      ofSlenderest.push_back(products(run.report));
    else
      EXPECT_LE(products(run.report), 150);
    const std::string name = std::to_string(static_cast<int>(length)) + " to 1";
    tellFigure(name + ": products", products(run.report));
    tellFigure(name + ": deviation", deviation(reference, run).largest());
  }
  // Sets that were made of rough solutions alone took 1317 at 40 to 1 on one rank. How long they wander there
  // is decided by rounding errors: of 24 lengths between 32 and 50 the median is 825, and was 709 with three
  // projections a step; the least were 168, the most 8308. So it is a median that says something.
  std::sort(ofSlenderest.begin(), ofSlenderest.end());
  EXPECT_LE(ofSlenderest[ofSlenderest.size() / 2], 1000.0);
}
