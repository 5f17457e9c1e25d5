// SPDX-License-Identifier: BSD-3-Clause
#include "../clusters/Harmos_ClusterTestSupport.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_TestErrors.hpp"

#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace test_cluster_inverse {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

using Joins = ClusterOptions::Joins;

LocalInverseOptions formOptions(DualForm form, bool share = true) {
  LocalInverseOptions options;
  options.form = form;
  options.share = share;
  return options;
}

double normInf(const MultiVector& v) {
  std::vector<double> result(v.getNumVectors());
  v.normInf(Teuchos::arrayViewFromVector(result));
  return *std::max_element(result.begin(), result.end());
}

double distance(const MultiVector& a, const MultiVector& b) {
  MultiVector difference(a, Teuchos::Copy);
  difference.update(-1.0, b, 1.0);
  return normInf(difference);
}

MultiVector unstructuredRows(const Constraints& constraints, double frequency = 1.3) {
  MultiVector v(constraints.rowMap(), 1);
  const auto view = v.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) = std::sin(1.0 + frequency * static_cast<double>(constraints.rowMap()->getGlobalElement(
                                                static_cast<LocalOrdinal>(r))));
  return v;
}

// K⁺ of clusters of whole loads, as the recovery makes it.
TornVector answerOf(const ClusteredProblem& problem, const TornVector& loads) {
  const ClusterInverse& joined = *problem.inverses->joined();
  const auto solve = [&](TornVector& x) {
    for (std::size_t c = 0; c < problem.inverses->classes().size(); ++c)
      for (int i : problem.inverses->classes()[c].members)
        problem.inverses->inverse(c).apply(x[static_cast<std::size_t>(i)].data(), 1);
  };
  TornVector left = loads, u = loads;
  solve(u);
  ClusterInverse::Amounts amounts = joined.none();
  for (int i = 0; i < problem.system.size(); ++i)
    joined.measure(i, u[static_cast<std::size_t>(i)].data(), loads[static_cast<std::size_t>(i)].data(),
                   amounts);
  const ClusterInverse::Amounts answer = joined.answer(amounts);
  for (int i = 0; i < problem.system.size(); ++i)
    joined.subtractForces(i, answer, left[static_cast<std::size_t>(i)].data());
  solve(left);
  for (int i = 0; i < problem.system.size(); ++i)
    joined.addMotion(i, answer, left[static_cast<std::size_t>(i)].data());
  return left;
}

// |u − u of the dense matrices| over |u|, both without motions, for loads in balance.
double errorOf(const ClusteredProblem& problem, TornVector loads) {
  double most = 0.0, size = 0.0;
  std::vector<DenseCluster> dense;
  for (std::size_t c = 0; c < problem.clusters().all().size(); ++c) {
    dense.emplace_back(problem, c);
    std::vector<double> mine = dense.back().gathered(loads);
    dense.back().balance(mine);
    dense.back().scatter(mine, loads);
  }
  const TornVector u = answerOf(problem, loads);
  for (const DenseCluster& cluster : dense) {
    std::vector<double> found = cluster.gathered(u);
    cluster.balance(found);
    const std::vector<double> expected = cluster.answer(cluster.gathered(loads));
    for (std::size_t j = 0; j < found.size(); ++j) {
      most = std::max(most, std::abs(found[j] - expected[j]));
      size = std::max(size, std::abs(expected[j]));
    }
  }
  return globalMax(*testComm(), most) / globalMax(*testComm(), size);
}

// Fλ by the dense matrices, for λ with Gλ = 0: where loads are in balance.
MultiVector denseProduct(const ClusteredProblem& problem, const MultiVector& lambda) {
  const std::vector<double> overlap = problem.constraints.toOverlap(lambda);
  TornVector loads = problem.system.zeroVector(), u = loads;
  for (int i = 0; i < problem.system.size(); ++i)
    problem.constraints.addBt(i, overlap.data(), loads[static_cast<std::size_t>(i)].data());
  for (std::size_t c = 0; c < problem.clusters().all().size(); ++c) {
    const DenseCluster cluster(problem, c);
    std::vector<double> mine = cluster.gathered(loads);
    cluster.balance(mine);
    cluster.scatter(cluster.answer(mine), u);
  }
  MultiVector result(problem.constraints.rowMap(), 1);
  problem.constraints.applyB(u, result);
  return result;
}

// The problems of this test: floating, held, of two bodies with contact, with corners alone, and by both.
struct Case {
  std::string name;
  TestModel model;
  ClusterOptions clusters;
  DirichletForm form = DirichletForm::Primal;
};

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const GridOptions& grid : gridsOfAllPhysics())
    for (int size : {0, 4})
      result.push_back({"floating", gridModel(grid), clusterOptions(size)});
  const GridOptions plane = {scene::Physics::PlaneStrain, {4, 2, 1}, {2, 2, 1}, {0}};
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
    result.push_back({"held", gridModel(plane), clusterOptions(4), form});
  result.push_back({"contact", testModel(3, 2), clusterOptions()});
  result.push_back({"corners", gridModel(plane), clusterOptions(0, Joins::Corners)});
  result.push_back({"all", gridModel(plane), clusterOptions(0, Joins::All)});
  GridOptions solid = {scene::Physics::Solid, {2, 2, 2}, {1, 1, 1}, {}};
  result.push_back({"edges and corners", gridModel(solid), clusterOptions(0, Joins::Corners)});
  return result;
}

// Products of F that conjugate gradients take until ‖MPr‖ has fallen to 1e-8, projected before and after M.
int productsOf(const TestModel& model, const ClusterOptions& clusters, PreconditionerKind kind) {
  const ClusteredProblem problem(model, clusters);
  const DualOperator f(problem.constraints, *problem.inverses);
  const ReplicatedCoarse coarse(motionsOf(problem.system, *problem.inverses), problem.constraints);
  const DualPreconditioner m(problem.system, problem.constraints, *problem.inverses, kind,
                             PreconditionerScaling::Multiplicity);
  const Teuchos::RCP<const Map>& map = problem.constraints.rowMap();
  MultiVector r(map, 1), z(map, 1), p(map, 1), fp(map, 1);
  // A residual that is one: orthogonal to what F does not see.
  MultiVector x = unstructuredRows(problem.constraints);
  coarse.project(x);
  f.apply(x, r);
  coarse.project(r);
  const auto dot = [](const MultiVector& a, const MultiVector& b) {
    return a.getVector(0)->dot(*b.getVector(0));
  };
  double before = 0.0, first = 0.0;
  for (int step = 0; step < 1000; ++step) {
    m.apply(r, z);
    coarse.project(z);
    const double rz = dot(r, z);
    first = step == 0 ? rz : first;
    if (rz <= 1e-16 * first)
      return step;
    p.update(1.0, z, step == 0 ? 0.0 : rz / before);
    before = rz;
    f.apply(p, fp);
    coarse.project(fp);
    r.update(-rz / dot(p, fp), fp, 1.0);
  }
  return 1000;
}

// An operator that is none of a subdomain's.
class Scaled : public BoundaryOperator {
 public:
  Scaled(int size, double factor) : size_(size), factor_(factor) {}
  int size() const override { return size_; }
  void apply(const double* t, double* u, int columns) const override {
    for (int k = 0; k < size_ * columns; ++k)
      u[k] = factor_ * t[k];
  }
  double bytes() const override { return 0.0; }
  double bytesRead(int) const override { return 0.0; }
  double flops() const override { return 0.0; }

 private:
  int size_;
  double factor_;
};

// What ClusterInverse says of operators that are multiples of one, a factor for each subdomain.
template<class FactorOf>
std::string failure(const std::shared_ptr<const Clusters>& clusters, const SubdomainSystem& system,
                    const Constraints& constraints, FactorOf&& factorOf) {
  std::vector<std::unique_ptr<Scaled>> operators;
  std::vector<ClusterInverse::Group> groups;
  for (const CongruenceClass& item : congruenceClasses(system, constraints, false, 4)) {
    operators.push_back(
        std::make_unique<Scaled>(static_cast<int>(item.boundary.size()), factorOf(item.members.front())));
    groups.push_back({item.members, item.boundary, operators.back().get()});
  }
  return numericalErrorOf([&] { ClusterInverse(clusters, groups); });
}

// A row of four membranes, floating: a chain of three averages.
TestModel chain() {
  return gridModel({scene::Physics::Membrane, {4, 1, 1}, {2, 2, 1}, {}});
}

} // namespace

// The dense matrices are regular with the kernel that was found, and singular without one of its motions: it
// is all of the kernel, and averages do not depend on each other. Numbers of order one in matrices of some
// hundred rows.
TEST(ClusterInverse, kernel_is_the_whole_one) {
  for (const Case& item : cases()) {
    const ClusteredProblem problem(item.model, item.clusters, item.form);
    for (std::size_t c = 0; c < problem.clusters().all().size(); ++c)
      EXPECT_GT(DenseCluster(problem, c).reciprocalCondition(), 1e-8) << item.name;
  }
}

// u = K⁺f in all dofs, for loads of all of them. Rounding errors of both are of 1e-16 times condition numbers
// of some thousand; an average too many or with a wrong sign changes u in its first digits.
TEST(ClusterInverse, answers_are_those_of_the_dense_matrices) {
  for (const Case& item : cases())
    for (DualForm form : {DualForm::Condensed, DualForm::Implicit})
      for (bool share : {true, false}) {
        const ClusteredProblem problem(item.model, item.clusters, item.form, formOptions(form, share));
        EXPECT_LT(errorOf(problem, unstructured(problem.system)), 1e-10) << item.name << share;
      }
}

// F of the clusters: by products with the boundaries alone. PF on the kernel of G, where it does not depend
// on which inverse K⁺ is; also of several columns at once.
TEST(ClusterInverse, products_are_those_of_the_dense_matrices) {
  for (const Case& item : cases())
    for (DualForm form : {DualForm::Condensed, DualForm::Implicit}) {
      const ClusteredProblem problem(item.model, item.clusters, item.form, formOptions(form));
      const DualOperator f(problem.constraints, *problem.inverses);
      const ReplicatedCoarse coarse(motionsOf(problem.system, *problem.inverses), problem.constraints);
      MultiVector x(problem.constraints.rowMap(), 2), y(problem.constraints.rowMap(), 2);
      for (std::size_t k : {0, 1}) {
        MultiVector lambda = unstructuredRows(problem.constraints, k == 0 ? 1.3 : 2.1);
        coarse.project(lambda);
        x.getVectorNonConst(k)->update(1.0, *lambda.getVector(0), 0.0);
      }
      f.apply(x, y);
      for (std::size_t k : {0, 1}) {
        MultiVector found(*y.getVector(k), Teuchos::Copy);
        MultiVector expected = denseProduct(problem, *x.getVector(k));
        coarse.project(found);
        coarse.project(expected);
        EXPECT_GT(normInf(expected), 1e-3) << item.name;
        EXPECT_LT(distance(found, expected), 1e-10 * normInf(expected)) << item.name;
      }
    }
}

// F of clusters is symmetric and has U in its kernel, by itself and not only because U is taken out of what
// it gives: F(Uμ) = 0.
TEST(ClusterInverse, dual_operator_is_symmetric_and_vanishes_on_averages) {
  for (const Case& item : cases()) {
    const ClusteredProblem problem(item.model, item.clusters, item.form);
    const DualOperator f(problem.constraints, *problem.inverses);
    const MultiVector a = unstructuredRows(problem.constraints),
                      b = unstructuredRows(problem.constraints, 2.1);
    MultiVector fa(a.getMap(), 1), fb(a.getMap(), 1);
    f.apply(a, fa);
    f.apply(b, fb);
    // K⁺ of a floating subdomain holds it at some nodes, and may be large for loads that are not in balance.
    const double size = normInf(fa) * static_cast<double>(a.getGlobalLength());
    EXPECT_NEAR(a.getVector(0)->dot(*fb.getVector(0)), b.getVector(0)->dot(*fa.getVector(0)), 1e-12 * size)
        << item.name;
    std::vector<double> mu(problem.clusters().averagePlaces().back());
    for (std::size_t k = 0; k < mu.size(); ++k)
      mu[k] = std::cos(static_cast<double>(k));
    MultiVector joined(a.getMap(), 1), image(a.getMap(), 1);
    problem.clusters().addJoined(mu, joined);
    f.apply(joined, image);
    EXPECT_LT(normInf(image), 1e-11 * std::max(normInf(fa), 1.0)) << item.name;
  }
}

// PFP has no other zeros than the motions and the averages: clusters whose kernel missed a motion, or was too
// large, would have more.
TEST(ClusterInverse, projected_operator_is_definite_elsewhere) {
  for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
    const ClusteredProblem problem(testModel(2, 2), clusterOptions(), form);
    const DualOperator f(problem.constraints, *problem.inverses);
    const ReplicatedCoarse coarse(motionsOf(problem.system, *problem.inverses), problem.constraints);
    const int n = static_cast<int>(problem.constraints.dualDimension());
    Dense pfp(n, n);
    for (int j = 0; j < n; ++j) {
      std::vector<double> unit(static_cast<std::size_t>(n), 0.0);
      unit[static_cast<std::size_t>(j)] = 1.0;
      const Teuchos::RCP<MultiVector> x = toVector(unit, problem.constraints.rowMap());
      MultiVector y(problem.constraints.rowMap(), 1);
      coarse.project(*x);
      f.apply(*x, y);
      coarse.project(y);
      const std::vector<double> column = fromVector(y);
      for (int i = 0; i < n; ++i)
        pfp(i, j) = column[static_cast<std::size_t>(i)];
    }
    int averages = 0;
    for (const Clusters::Cluster& cluster : problem.clusters().all())
      averages += cluster.averages;
    const auto zeros = static_cast<std::size_t>(globalSum(*testComm(), static_cast<long long>(averages)) +
                                                coarse.dimension());
    const std::vector<double> spectrum = eigenvalues(pfp);
    EXPECT_NEAR(spectrum[zeros - 1], 0.0, 1e-12);
    EXPECT_GT(spectrum[zeros], 1e-2);
  }
}

// Congruent clusters share F₀ and S₀, and sharing changes nothing. Pairs along a strip: all faces are alike.
TEST(ClusterInverse, congruent_clusters_share_factors) {
  for (const GridOptions& grid : gridsOfAllPhysics()) {
    GridOptions strip = grid;
    strip.subdomains = {8, 1, 1};
    const TestModel model = gridModel(strip);
    const ClusteredProblem shared(model, clusterOptions(2)),
        apart(model, clusterOptions(2), DirichletForm::Primal, formOptions(DualForm::Condensed, false));
    EXPECT_EQ(shared.clusters().total(), 4);
    EXPECT_EQ(shared.inverses->joined()->distinctFactors(), 1);
    EXPECT_EQ(apart.inverses->joined()->distinctFactors(), static_cast<int>(apart.clusters().all().size()));
    if (testComm()->getSize() == 1) // with few clusters a boundary that is of all may be what is larger
      EXPECT_LT(shared.inverses->joined()->bytes(), 0.8 * apart.inverses->joined()->bytes());
    const DualOperator one(shared.constraints, *shared.inverses), many(apart.constraints, *apart.inverses);
    const ReplicatedCoarse coarse(motionsOf(shared.system, *shared.inverses), shared.constraints);
    MultiVector x = unstructuredRows(shared.constraints), y(x.getMap(), 1), z(x.getMap(), 1);
    coarse.project(x);
    one.apply(x, y);
    many.apply(x, z);
    coarse.project(y);
    coarse.project(z);
    EXPECT_LT(distance(y, z), 1e-11 * normInf(y));
  }
}

// Clusters that look alike and are not: other materials, in one of two.
TEST(ClusterInverse, different_clusters_do_not_share) {
  if (testComm()->getSize() > 1)
    GTEST_SKIP() << "of one rank";
  TestModel model = gridModel({scene::Physics::PlaneStrain, {4, 2, 1}, {2, 2, 1}, {}});
  for (Subdomain& subdomain : model.subdomains)
    if (subdomain.number == 5) {
      auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : copy->values)
        value *= 3.0;
      subdomain.stiffness = copy;
    }
  const ClusteredProblem problem(model, clusterOptions(4));
  ASSERT_EQ(problem.clusters().all().size(), 2u);
  EXPECT_EQ(problem.inverses->joined()->distinctFactors(), 2);
  EXPECT_LT(errorOf(problem, unstructured(problem.system)), 1e-10);
}

// Bases of the motions of congruent subdomains may differ, whether they share an inverse or not.
TEST(ClusterInverse, bases_of_motions_have_no_say) {
  for (const GridOptions& grid : gridsOfAllPhysics()) {
    TestModel model = gridModel(grid);
    for (Subdomain& subdomain : model.subdomains)
      if (subdomain.number % 2 == 1) {
        Kernel other = *subdomain.motions;
        std::reverse(other.values.begin(), other.values.end());
        for (int c = 0; c < other.columns; ++c)
          std::copy(subdomain.motions->column(other.columns - 1 - c),
                    subdomain.motions->column(other.columns - 1 - c) + other.rows,
                    other.values.begin() + static_cast<std::ptrdiff_t>(c) * other.rows);
        subdomain.motions = std::make_shared<Kernel>(other);
      }
    for (bool share : {true, false}) {
      const ClusteredProblem problem(model, clusterOptions(), DirichletForm::Primal,
                                     formOptions(DualForm::Condensed, share));
      for (std::size_t c = 0; c < problem.clusters().all().size(); ++c)
        EXPECT_GT(DenseCluster(problem, c).reciprocalCondition(), 1e-8);
      EXPECT_LT(errorOf(problem, unstructured(problem.system)), 1e-10) << share;
    }
  }
}

// Averages that the subdomains' inverses do not feel, and a join that is missing: each is named with its
// cluster.
TEST(ClusterInverse, averages_that_are_none_are_named) {
  if (testComm()->getSize() > 1)
    GTEST_SKIP() << "of one rank";
  const TestModel model = chain();
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  const auto clusters = std::make_shared<Clusters>(system, constraints, clusterOptions());
  EXPECT_EQ(failure(clusters, system, constraints, [](int) { return 1.0; }), "");
  const std::string dependent = failure(clusters, system, constraints, [](int) { return 0.0; });
  EXPECT_TRUE(contains(dependent, "the cluster of 4 subdomains from subdomain 0 on has linearly dependent "
                                  "averages: the factor of B₀K⁺B₀ᵀ has rank 0 of 3"))
      << dependent;
  // Without the last join the last subdomain moves by itself, of which the kernel says nothing. The object is
  // not const.
  auto& cluster = const_cast<Clusters::Cluster&>(clusters->all().front());
  cluster.averages -= cluster.joins.back().count;
  cluster.joins.pop_back();
  const std::string missed = failure(clusters, system, constraints, [](int) { return 1.0; });
  EXPECT_TRUE(contains(missed, "the cluster of 4 subdomains from subdomain 0 on has a zero-energy "
                               "mode outside its averages and its kernel of dimension 1"))
      << missed;
}

// New matrices, and products that are made anew: the clusters' part is, too.
TEST(ClusterInverse, new_matrices_give_new_factors) {
  TestModel model = gridModel({scene::Physics::PlaneStrain, {4, 2, 1}, {2, 2, 1}, {}});
  ClusteredProblem problem(model, clusterOptions());
  LocalInverseOptions options;
  options.clusters = problem.inverses->joined()->sharedClusters();
  std::vector<std::shared_ptr<const LocalMatrix>> matrices;
  for (const Subdomain& subdomain : model.subdomains) {
    auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
    for (double& value : copy->values)
      value *= subdomain.number < 100 ? 4.0 : 1.0;
    matrices.push_back(copy);
  }
  MultiVector lambda = unstructuredRows(problem.constraints);
  const ReplicatedCoarse coarse(motionsOf(problem.system, *problem.inverses), problem.constraints);
  coarse.project(lambda);
  MultiVector before(lambda.getMap(), 1), after(lambda.getMap(), 1);
  DualOperator(problem.constraints, *problem.inverses).apply(lambda, before);
  problem.system.setMatrices(matrices);
  problem.inverses->renew(problem.system, problem.constraints, options);
  DualOperator(problem.constraints, *problem.inverses).apply(lambda, after);
  coarse.project(before);
  coarse.project(after);
  before.scale(0.25);
  EXPECT_LT(distance(before, after), 1e-11 * normInf(after));
  EXPECT_LT(errorOf(problem, unstructured(problem.system)), 1e-10);
}

// Products in single precision, and then not: the clusters' part is of those that are there, and the error
// that of single precision at most.
TEST(ClusterInverse, rounded_products_can_be_restored) {
  const TestModel model = gridModel({scene::Physics::PlaneStrain, {4, 2, 1}, {3, 3, 1}, {}});
  LocalInverseOptions options = formOptions(DualForm::Implicit);
  const ClusteredProblem exact(model, clusterOptions(), DirichletForm::Primal, options);
  options.productError = 1e-5;
  ClusteredProblem rounded(model, clusterOptions(), DirichletForm::Primal, options);
  const ReplicatedCoarse coarse(motionsOf(exact.system, *exact.inverses), exact.constraints);
  MultiVector lambda = unstructuredRows(exact.constraints);
  coarse.project(lambda);
  const auto product = [&](const ClusteredProblem& problem) {
    MultiVector y(lambda.getMap(), 1);
    DualOperator(problem.constraints, *problem.inverses).apply(lambda, y);
    coarse.project(y);
    return y;
  };
  const MultiVector expected = product(exact);
  const double size = normInf(expected);
  if (rounded.inverses->roundedFactorizations() > 0) {
    EXPECT_GT(distance(product(rounded), expected), 1e-12 * size);
  }
  EXPECT_LT(distance(product(rounded), expected), 1e-3 * size);
  rounded.inverses->restoreProducts(*testComm());
  EXPECT_LT(distance(product(rounded), expected), 1e-11 * size);
}

// The preconditioner of clusters: symmetric, positive semidefinite on what F sees, and without averages.
TEST(ClusterInverse, preconditioner_is_symmetric_and_has_no_averages) {
  for (const Case& item : cases())
    for (PreconditionerKind kind : {PreconditionerKind::Dirichlet, PreconditionerKind::Lumped}) {
      const ClusteredProblem problem(item.model, item.clusters, item.form);
      const DualPreconditioner m(problem.system, problem.constraints, *problem.inverses, kind,
                                 PreconditionerScaling::Multiplicity);
      MultiVector a = unstructuredRows(problem.constraints), b = unstructuredRows(problem.constraints, 2.1);
      problem.clusters().removeJoined(a);
      problem.clusters().removeJoined(b);
      MultiVector ma(a.getMap(), 1), mb(a.getMap(), 1);
      m.apply(a, ma);
      m.apply(b, mb);
      const double size = normInf(ma) * static_cast<double>(a.getGlobalLength());
      EXPECT_NEAR(a.getVector(0)->dot(*mb.getVector(0)), b.getVector(0)->dot(*ma.getVector(0)), 1e-12 * size)
          << item.name;
      EXPECT_GT(a.getVector(0)->dot(*ma.getVector(0)), 0.0) << item.name;
      MultiVector kept(ma, Teuchos::Copy);
      problem.clusters().removeJoined(kept);
      EXPECT_LT(distance(kept, ma), 1e-12 * normInf(ma)) << item.name;
    }
}

// Bricks of sixteen subdomains a cluster of membranes, of eight in the plane and in space: at most twice the
// products that it takes without clusters, by Dirichlet's preconditioner. Faces that move apart where they
// should move together leave the answer as it is, and take more. On one rank: those of several have stripes.
TEST(ClusterInverse, products_of_bricks_are_within_twice_those_without) {
  if (testComm()->getSize() > 1)
    GTEST_SKIP() << "of one rank";
  using scene::Physics;
  ClusterOptions none;
  none.kind = ClusterOptions::Kind::None;
  for (const auto& [grid, size] : {std::pair(GridOptions{Physics::Membrane, {8, 8, 1}, {4, 4, 1}, {0}}, 16),
                                   {GridOptions{Physics::PlaneStrain, {8, 4, 1}, {4, 4, 1}, {0, 1}}, 8},
                                   {GridOptions{Physics::Solid, {4, 2, 2}, {2, 2, 2}, {0, 1, 2}}, 8}}) {
    const TestModel model = gridModel(grid);
    const int without = productsOf(model, none, PreconditionerKind::Dirichlet),
              with = productsOf(model, clusterOptions(size), PreconditionerKind::Dirichlet);
    EXPECT_LE(with, 2 * without) << size;
    EXPECT_GE(with, without / 2) << size;
  }
}

} // namespace test_cluster_inverse
