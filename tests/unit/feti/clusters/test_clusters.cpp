// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterPartition.hpp"
#include "Harmos_ClusterTestSupport.hpp"
#include "Harmos_TestErrors.hpp"

#include <Tpetra_Vector.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace test_clusters {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

using Centres = std::vector<std::array<double, 3>>;
using Groups = std::vector<std::vector<int>>;
using Joins = ClusterOptions::Joins;

// A grid of unit subdomains, numbered along x, then y; neighbours along x share `weight` dofs, along y ten.
struct Grid {
  Grid(int columns, int rows, int weight = 10) {
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const int k = j * columns + i;
        centres.push_back({static_cast<double>(i), static_cast<double>(j), 0.0});
        if (i > 0)
          links.push_back({k - 1, k, weight});
        if (j > 0)
          links.push_back({k - columns, k, 10});
      }
  }
  std::vector<SubdomainLink> links;
  Centres centres;
};

// Each subdomain once, members and groups by rising numbers, and each group in one piece.
void expectGroups(const Groups& groups, int subdomains, const std::vector<SubdomainLink>& links) {
  std::vector<int> of(static_cast<std::size_t>(subdomains), -1);
  int last = -1;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ASSERT_FALSE(groups[g].empty());
    EXPECT_GT(groups[g].front(), last);
    last = groups[g].front();
    EXPECT_TRUE(std::is_sorted(groups[g].begin(), groups[g].end()));
    for (int i : groups[g]) {
      EXPECT_EQ(of[static_cast<std::size_t>(i)], -1) << i;
      of[static_cast<std::size_t>(i)] = static_cast<int>(g);
    }
    std::set<int> reached = {groups[g].front()};
    for (std::size_t before = 0; before < reached.size();) {
      before = reached.size();
      for (const SubdomainLink& link : links)
        for (const auto& [a, b] : {std::pair(link.first, link.second), std::pair(link.second, link.first)})
          if (reached.count(a) > 0 && std::binary_search(groups[g].begin(), groups[g].end(), b))
            reached.insert(b);
    }
    EXPECT_EQ(reached.size(), groups[g].size()) << "group " << g << " is in pieces";
  }
  EXPECT_EQ(std::count(of.begin(), of.end(), -1), 0);
}

// All averages of this rank: of a vector of rows.
std::vector<double> averagesOf(const ClusteredProblem& problem, const MultiVector& rows) {
  std::vector<double> result;
  for (const Clusters::Cluster& cluster : problem.clusters().all())
    for (double value : Harmos::averagesOf(problem.constraints, cluster, rows))
      result.push_back(value);
  return result;
}

double largest(const std::vector<double>& v) {
  double result = 0.0;
  for (double entry : v)
    result = std::max(result, std::abs(entry));
  return result;
}

// |B₀RT| over all columns; of the size of rounding errors if T is closed. @note Collective.
double opening(const ClusteredProblem& problem) {
  const RigidMotions& motions = problem.clusters().motions();
  double most = 0.0;
  for (int c = 0; c < motions.dimension(); ++c) {
    std::vector<double> alpha(motions.ownColumns().size(), 0.0);
    for (std::size_t k = 0; k < alpha.size(); ++k)
      alpha[k] = motions.ownColumns()[k] == c ? 1.0 : 0.0;
    MultiVector bu(problem.constraints.rowMap(), 1);
    problem.constraints.applyB(rigid(motions, alpha), bu);
    most = std::max(most, largest(averagesOf(problem, bu)));
  }
  return globalMax(*testComm(), most);
}

// |TᵀT − I|; columns of R_i are orthonormal, and of RT too then.
double skewness(const ClusteredProblem& problem) {
  const RigidMotions& motions = problem.clusters().motions();
  const std::size_t n = motions.ownColumns().size();
  std::vector<std::vector<double>> columns;
  std::vector<double> alpha(n, 0.0);
  for (std::size_t c = 0; c < n; ++c) {
    alpha[c] = 1.0;
    columns.push_back(motions.amplitudes(alpha));
    alpha[c] = 0.0;
  }
  double most = 0.0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const double product =
          std::inner_product(columns[a].begin(), columns[a].end(), columns[b].begin(), 0.0);
      most = std::max(most, std::abs(product - (a == b ? 1.0 : 0.0)));
    }
  return globalMax(*testComm(), most);
}

// What has to hold of any clusters. Values of B₀ and of R are of order one, and sums of some ten of them are
// right to 1e-14; what is taken for a motion opens joins by 1e-10 at most.
void expectSound(const ClusteredProblem& problem) {
  EXPECT_LT(opening(problem), 1e-10);
  EXPECT_LT(skewness(problem), 1e-12);
  std::set<int> rows;
  for (const Clusters::Cluster& cluster : problem.clusters().all()) {
    int averages = 0;
    for (const Clusters::Join& join : cluster.joins) {
      EXPECT_EQ(join.first, averages);
      averages += join.count;
      const std::size_t n = join.rows.size();
      ASSERT_EQ(join.weights.size(), n * static_cast<std::size_t>(join.count));
      for (int row : join.rows) {
        EXPECT_EQ(problem.constraints.rowType(row), RowType::Gluing);
        EXPECT_TRUE(rows.insert(row).second) << "row " << row << " is in two joins";
      }
      for (std::size_t a = 0; a < join.weights.size(); a += n)
        for (std::size_t b = 0; b <= a; b += n)
          EXPECT_NEAR(std::inner_product(&join.weights[a], &join.weights[a] + n, &join.weights[b], 0.0),
                      a == b ? 1.0 : 0.0, 1e-12);
    }
    EXPECT_EQ(cluster.averages, averages);
  }
}

// Two plane subdomains that have one node in common, (1, 1), and nothing else.
TestModel hinge() {
  TestModel model = gridModel({scene::Physics::PlaneStrain, {2, 2, 1}, {2, 2, 1}, {}});
  if (testComm()->getSize() > 1)
    return {};
  // Of four in a square those at a diagonal.
  TestModel result;
  for (int k : {0, 3}) {
    result.subdomains.push_back(model.subdomains[static_cast<std::size_t>(k)]);
    result.subdomains.back().number = k / 3;
  }
  return result;
}

} // namespace

// Sixteen subdomains of a square in fours: squares, not stripes; in eights: halves.
TEST(ClusterPartition, grids_are_cut_to_bricks) {
  const Grid grid(4, 4);
  const Groups fours = partitionIntoClusters(16, grid.links, grid.centres, 4);
  EXPECT_EQ(fours, (Groups{{0, 1, 4, 5}, {2, 3, 6, 7}, {8, 9, 12, 13}, {10, 11, 14, 15}}));
  const Groups eights = partitionIntoClusters(16, grid.links, grid.centres, 8);
  ASSERT_EQ(eights.size(), 2u);
  expectGroups(eights, 16, grid.links);
  EXPECT_EQ(eights[0].size(), 8u);
  // The long side of a strip.
  const Grid strip(8, 2);
  EXPECT_EQ(partitionIntoClusters(16, strip.links, strip.centres, 8),
            (Groups{{0, 1, 2, 3, 8, 9, 10, 11}, {4, 5, 6, 7, 12, 13, 14, 15}}));
}

// Centres that differ by rounding errors from those of a grid give the same bricks.
TEST(ClusterPartition, rounding_errors_of_centres_have_no_say) {
  Grid grid(4, 4);
  for (std::size_t k = 0; k < grid.centres.size(); ++k)
    for (std::size_t d = 0; d < 2; ++d)
      grid.centres[k][d] += 1e-13 * (static_cast<double>((7 * k + 3 * d) % 5) - 2.0);
  EXPECT_EQ(partitionIntoClusters(16, grid.links, grid.centres, 4),
            (Groups{{0, 1, 4, 5}, {2, 3, 6, 7}, {8, 9, 12, 13}, {10, 11, 14, 15}}));
}

// Bricks about as long as wide, of about so many: six of 2 × 2, and not of 3 × 2 or of five.
TEST(ClusterPartition, cuts_are_between_layers) {
  const Grid grid(6, 4);
  const Groups groups = partitionIntoClusters(24, grid.links, grid.centres, 5);
  ASSERT_EQ(groups.size(), 6u);
  expectGroups(groups, 24, grid.links);
  for (const std::vector<int>& group : groups)
    EXPECT_EQ(group, (std::vector<int>{group[0], group[0] + 1, group[0] + 6, group[0] + 7}));
  // Three layers in two pieces, on both axes.
  const Grid odd(3, 3);
  EXPECT_EQ(partitionIntoClusters(9, odd.links, odd.centres, 3), (Groups{{0, 1, 3, 4}, {2, 5}, {6, 7}, {8}}));
}

// Centres that stand on no grid, whose columns hang together by few dofs and whose rows by many: bricks would
// cut the rows, the graph keeps them whole.
TEST(ClusterPartition, links_of_many_dofs_are_kept_where_bricks_would_cut_them) {
  // Eight columns of two, wide and flat: bricks cut across x. Along x subdomains share 1000 dofs, along y 10.
  Grid grid(8, 2, 1000);
  for (std::size_t k = 0; k < grid.centres.size(); ++k)
    grid.centres[k][0] += 0.02 * static_cast<double>(k % 5);
  const Groups groups = partitionIntoClusters(16, grid.links, grid.centres, 8);
  EXPECT_EQ(groups, (Groups{{0, 1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14, 15}}));
}

// Without centres by the graph alone: four cliques in a ring, linked by one dof each.
TEST(ClusterPartition, without_centres_the_graph_decides) {
  std::vector<SubdomainLink> links;
  for (int clique = 0; clique < 4; ++clique) {
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b)
        links.push_back({4 * clique + a, 4 * clique + b, 20});
    const int next = 4 * ((clique + 1) % 4), last = 4 * clique + 3;
    links.push_back({std::min(last, next), std::max(last, next), 1});
  }
  EXPECT_EQ(partitionIntoClusters(16, links, {}, 4),
            (Groups{{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}}));
}

// What does not hang together is no group, whatever the size asked for: bodies, subdomains without links, a
// size of one; and a size that is larger than all.
TEST(ClusterPartition, pieces_and_sizes) {
  Grid two(2, 2);
  const std::vector<SubdomainLink> one = two.links;
  for (const SubdomainLink& link : one)
    two.links.push_back({link.first + 4, link.second + 4, link.weight});
  for (int k = 0; k < 4; ++k)
    two.centres.push_back({two.centres[static_cast<std::size_t>(k)][0] + 10.0,
                           two.centres[static_cast<std::size_t>(k)][1], 0.0});
  for (int size : {0, 8, 100})
    for (const Centres& centres : {two.centres, Centres()})
      EXPECT_EQ(partitionIntoClusters(8, two.links, centres, size), (Groups{{0, 1, 2, 3}, {4, 5, 6, 7}}))
          << size;
  const Groups alone = {{0}, {1}, {2}, {3}, {4}};
  for (int size : {0, 1, 2, 5})
    EXPECT_EQ(partitionIntoClusters(5, {}, {}, size), alone) << size;
  EXPECT_EQ(partitionIntoClusters(4, one, {}, 1).size(), 4u);
  EXPECT_EQ(partitionIntoClusters(1, {}, {}, 4), (Groups{{0}}));
  EXPECT_TRUE(partitionIntoClusters(0, {}, {}, 4).empty());
  EXPECT_TRUE(partitionIntoClusters(0, {}, {}, 0).empty());
}

// Any sizes on a grid with a hole: each subdomain once, groups in one piece, about as many as asked for.
TEST(ClusterPartition, any_size_gives_sound_groups) {
  Grid grid(7, 5);
  // Subdomain 17 in the middle is linked with nothing.
  grid.links.erase(std::remove_if(grid.links.begin(), grid.links.end(),
                                  [](const SubdomainLink& l) { return l.first == 17 || l.second == 17; }),
                   grid.links.end());
  for (int size = 1; size <= 40; ++size)
    for (const Centres& centres : {grid.centres, Centres()}) {
      const Groups groups = partitionIntoClusters(35, grid.links, centres, size);
      expectGroups(groups, 35, grid.links);
      // One by itself; what is left in pieces of about so many, some of which may be joined to others.
      EXPECT_LE(groups.size(), 36.0 / std::max(1.0, size / 2.0) + 2.0) << size;
      EXPECT_GE(groups.size(), 35.0 / (2.0 * size)) << size;
    }
}

// A floating cluster has the motions of one floating body: constants, three in the plane, six in space.
TEST(Clusters, floating_ones_move_as_one_body) {
  const std::vector<int> motions = {1, 3, 6};
  std::size_t k = 0;
  for (const GridOptions& grid : gridsOfAllPhysics()) {
    for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual})
      for (int size : {0, 2, 4}) {
        const ClusteredProblem problem(gridModel(grid), clusterOptions(size), form);
        expectSound(problem);
        for (std::size_t c = 0; c < problem.clusters().all().size(); ++c)
          EXPECT_EQ(problem.kernelOf(c), motions[k]) << size;
        if (size == 0)
          EXPECT_EQ(problem.clusters().total(), testComm()->getSize());
        EXPECT_EQ(problem.clusters().motions().dimension(), motions[k] * problem.clusters().total());
      }
    ++k;
  }
}

// Faces, corners and both: fewer joins leave more motions, never less.
TEST(Clusters, all_joins_give_sound_kernels) {
  for (const GridOptions& grid : gridsOfAllPhysics())
    for (Joins joins : {Joins::Faces, Joins::Corners, Joins::All}) {
      const ClusteredProblem problem(gridModel(grid), clusterOptions(0, joins));
      expectSound(problem);
      for (std::size_t c = 0; c < problem.clusters().all().size(); ++c)
        EXPECT_GE(problem.kernelOf(c), grid.physics == scene::Physics::Membrane      ? 1
                                       : grid.physics == scene::Physics::PlaneStrain ? 3
                                                                                     : 6);
    }
}

// Held at one side, all or one component: in the matrices the cluster is held, or keeps the motions along the
// side; by multipliers it floats.
TEST(Clusters, held_ones_keep_what_is_left) {
  for (const std::vector<int>& held : {std::vector<int>{0, 1}, std::vector<int>{0}}) {
    const TestModel model = gridModel({scene::Physics::PlaneStrain, {4, 2, 1}, {2, 2, 1}, held});
    for (DirichletForm form : {DirichletForm::Primal, DirichletForm::Dual}) {
      const ClusteredProblem problem(model, clusterOptions(), form);
      expectSound(problem);
      for (std::size_t c = 0; c < problem.clusters().all().size(); ++c) {
        bool isHeld = false;
        for (int i : problem.clusters().all()[c].members)
          isHeld = isHeld || !problem.system.subdomain(i).fixed.empty();
        // What is prescribed in the matrices is in no average.
        for (const Clusters::Join& join : problem.clusters().all()[c].joins)
          for (const Clusters::Side& side : join.sides)
            for (const FixedDof& fixed : problem.system.subdomain(side.subdomain).fixed)
              EXPECT_FALSE(std::binary_search(side.dofs.begin(), side.dofs.end(), fixed.dof));
        // A side at which u_x = 0 may move along itself.
        const int left = held.size() == 2 ? 0 : 1;
        EXPECT_EQ(problem.kernelOf(c), isHeld && form == DirichletForm::Primal ? left : 3);
      }
    }
  }
}

// Bodies that touch are no cluster, whatever the rank has; a cluster of each subdomain is no cluster at all.
TEST(Clusters, bodies_of_a_rank_are_clusters_of_their_own) {
  const TestModel model = testModel(2, 3); // two membranes of four
  const ClusteredProblem problem(model, clusterOptions());
  expectSound(problem);
  std::size_t expected = testComm()->getSize() == 1 ? 2 : 1;
  EXPECT_EQ(problem.clusters().all().size(), expected);
  const ClusteredProblem each(model, clusterOptions(1));
  EXPECT_EQ(each.clusters().total(), each.system.globalSubdomains());
  for (const Clusters::Cluster& cluster : each.clusters().all())
    EXPECT_EQ(cluster.averages, 0);
  EXPECT_EQ(each.clusters().motions().dimension(), each.system.kernelDimension());
}

// A cluster of a rank without any subdomain.
TEST(Clusters, ranks_may_have_none) {
  TestModel model = gridModel({scene::Physics::PlaneStrain, {1, 1, 1}, {2, 2, 1}, {}});
  const ClusteredProblem problem(model, clusterOptions());
  EXPECT_EQ(problem.clusters().total(), 1);
  EXPECT_EQ(problem.clusters().motions().dimension(), 3);
}

// Two subdomains that turn about the node that they share, by corners of four subdomains or by two bodies at
// one node: each turns by itself.
TEST(Clusters, hinges_have_more_motions) {
  if (testComm()->getSize() > 1)
    GTEST_SKIP() << "of one rank";
  const ClusteredProblem two(hinge(), clusterOptions());
  expectSound(two);
  ASSERT_EQ(two.clusters().all().size(), 1u);
  EXPECT_EQ(two.kernelOf(0), 4);
  const TestModel four = gridModel({scene::Physics::PlaneStrain, {2, 2, 1}, {2, 2, 1}, {}});
  const ClusteredProblem corner(four, clusterOptions(0, Joins::Corners));
  expectSound(corner);
  ASSERT_EQ(corner.clusters().all().size(), 1u);
  EXPECT_EQ(corner.kernelOf(0), 6); // two translations, and a rotation of each
}

// Congruent subdomains may come with different bases of their motions: those of a cluster are told in the
// basis that stands for all of them.
TEST(Clusters, congruent_subdomains_may_have_other_bases_of_their_motions) {
  for (const GridOptions& grid : gridsOfAllPhysics()) {
    TestModel model = gridModel(grid);
    for (Subdomain& subdomain : model.subdomains)
      if (subdomain.number % 2 == 1) {
        Kernel other = *subdomain.motions;
        const auto rows = static_cast<std::size_t>(other.rows);
        // Columns in the reverse order, each less the one before it.
        for (std::size_t c = 0; c < static_cast<std::size_t>(other.columns); ++c)
          for (std::size_t j = 0; j < rows; ++j) {
            const std::size_t from = static_cast<std::size_t>(other.columns) - 1 - c;
            other.values[c * rows + j] = -subdomain.motions->values[from * rows + j];
            if (from > 0)
              other.values[c * rows + j] += 0.5 * subdomain.motions->values[(from - 1) * rows + j];
          }
        subdomain.motions = std::make_shared<Kernel>(other);
      }
    const ClusteredProblem problem(model, clusterOptions());
    expectSound(problem);
  }
}

// I − UUᵀ: a projector that takes U out and leaves what is orthogonal to it.
TEST(Clusters, removal_of_averages_is_a_projector) {
  for (const GridOptions& grid : gridsOfAllPhysics()) {
    const ClusteredProblem problem(gridModel(grid), clusterOptions(4));
    const Clusters& clusters = problem.clusters();
    MultiVector v(problem.constraints.rowMap(), 2);
    {
      const auto view = v.getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t r = 0; r < view.extent(0); ++r)
        for (std::size_t x = 0; x < 2; ++x)
          view(r, x) = std::sin(1.0 + static_cast<double>(r) * (1.3 + static_cast<double>(x)));
    }
    MultiVector once(v, Teuchos::Copy);
    clusters.removeJoined(once);
    EXPECT_LT(largest(averagesOf(problem, once)), 1e-13);
    EXPECT_LT(largest(averagesOf(problem, *once.getVector(1))), 1e-13);
    MultiVector twice(once, Teuchos::Copy);
    clusters.removeJoined(twice);
    twice.update(-1.0, once, 1.0);
    std::vector<double> change(2);
    twice.normInf(Teuchos::arrayViewFromVector(change));
    EXPECT_LT(largest(change), 1e-13);
    // v = (I − UUᵀ)v + U(Uᵀv).
    const std::vector<double> mu = averagesOf(problem, v);
    MultiVector first(*once.getVector(0), Teuchos::Copy);
    clusters.addJoined(mu, first);
    first.update(-1.0, *v.getVector(0), 1.0);
    change.resize(1);
    first.normInf(Teuchos::arrayViewFromVector(change));
    EXPECT_LT(change[0], 1e-13);
  }
}

// With weights, and dofs that ties make one, rows weigh copies differently: U is made of them all the same,
// and a cluster goes across the tie.
TEST(Clusters, weighted_rows_and_ties) {
  TestModel model = testModel(2, 3, true);
  for (Subdomain& subdomain : model.subdomains)
    if (subdomain.number % 3 == 0) {
      auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : copy->values)
        value *= 1e3;
      subdomain.stiffness = copy;
    }
  const ClusteredProblem problem(model, clusterOptions(), DirichletForm::Primal, {}, RowWeights::Stiffness);
  expectSound(problem);
  EXPECT_EQ(problem.clusters().total(), testComm()->getSize());
}

// A cluster does not go across a tie to what is stiffer by orders of magnitude.
TEST(Clusters, jumps_of_materials_are_borders) {
  if (testComm()->getSize() > 1)
    GTEST_SKIP() << "of one rank";
  for (double jump : {1e2, 1e6}) {
    TestModel model = testModel(2, 3, true);
    for (Subdomain& subdomain : model.subdomains)
      if (subdomain.number >= 4) { // the second membrane
        auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
        for (double& value : copy->values)
          value *= jump;
        subdomain.stiffness = copy;
      }
    const ClusteredProblem problem(model, clusterOptions(), DirichletForm::Primal, {}, RowWeights::Stiffness);
    expectSound(problem);
    EXPECT_EQ(problem.clusters().all().size(), jump < 1e4 ? 1u : 2u);
  }
}

// A tie that makes two dofs of one subdomain one: a link of a subdomain with itself.
TEST(Clusters, a_subdomain_may_be_tied_to_itself) {
  TestModel model = gridModel({scene::Physics::Membrane, {8, 1, 1}, {2, 2, 1}, {}});
  for (const Subdomain& subdomain : model.subdomains) {
    // The middle of the lower and of the upper side.
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Equality;
    row.number = subdomain.number;
    row.terms = {{subdomain.numbers[1], 1.0}, {subdomain.numbers[subdomain.numbers.size() - 2], -1.0}};
    model.rows.push_back(row);
  }
  for (RowWeights weights : {RowWeights::None, RowWeights::Stiffness})
    for (int size : {0, 1, 2, 3}) {
      const ClusteredProblem problem(model, clusterOptions(size), DirichletForm::Primal, {}, weights);
      expectSound(problem);
      for (std::size_t c = 0; c < problem.clusters().all().size(); ++c)
        EXPECT_EQ(problem.kernelOf(c), 1);
    }
}

TEST(Clusters, none_are_made_where_none_are_asked_for) {
  const TestModel model = testModel(2, 3);
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Primal);
  const Constraints constraints(system, model.rows);
  ClusterOptions options;
  options.kind = ClusterOptions::Kind::None;
  EXPECT_EQ(makeClusters(system, constraints, options), nullptr);
}

} // namespace test_clusters
