// SPDX-License-Identifier: BSD-3-Clause

/// What Newton's iterations at finite displacements are made of.

#include "Harmos_AndersonMixing.hpp"
#include "Harmos_CarriedForces.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DeformedBodies.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_MovedSubdomains.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace test_finite_displacements {

using namespace Harmos;
using fem::Point;

namespace {

// Two blocks, of which the upper one slides along the lower one.
scene::Scene slidingBlocks() {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  scene.strains = fem::Strains::Finite;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {4, 1, 1};
  options.elements = {2, 2, 1};
  options.size = {4.0, 1.0, 1.0};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.subdomains = {1, 1, 1};
  options.elements = {3, 2, 1};
  options.size = {1.0, 1.0, 1.0};
  options.origin = {0.3, 1.0, 0.0};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  addContact(scene, {1, "bottom"}, {0, "top"});
  return scene;
}

feti::TornVector displacementOf(const std::vector<scene::OwnedSubdomain>& owned,
                                const std::function<Point(int, const Point&)>& field) {
  feti::TornVector u;
  for (const scene::OwnedSubdomain& item : owned) {
    std::vector<double>& values = u.emplace_back();
    for (int node = 0; node < item.mesh.mesh->numberOfNodes(); ++node) {
      const Point value = field(item.body, item.mesh.position(node));
      values.insert(values.end(), value.begin(), value.begin() + item.mesh.mesh->dimension());
    }
  }
  return u;
}

// Each row's its number.
MultiVector numberedForces(const feti::Constraints& constraints) {
  MultiVector forces(constraints.rowMap(), 1);
  const auto view = forces.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) =
        1.0 + static_cast<double>(constraints.rowMap()->getGlobalElement(static_cast<LocalOrdinal>(r)));
  return forces;
}

} // namespace

// u ← Au + b with a matrix A of three eigenvalues, one of which diverges: mixed, it is there after four
// iterations but for rounding errors. And a component that all answers agree on stays.
TEST(AndersonMixing, solves_linear_problems) {
  const bool isHere = testComm()->getRank() == 0;
  const std::vector<double> factor = {0.9, 0.9, -1.5, -1.5, 0.4, 0.0};
  const std::vector<double> load = {1.0, 2.0, 3.0, -1.0, 0.5, 7.0};
  feti::TornVector weights, u;
  if (isHere) {
    weights = {std::vector<double>(6, 2.0)};
    u = {std::vector<double>(6, 0.0)};
  }
  run::AndersonMixing mixing(*testComm(), weights);
  for (int k = 0; k < 5; ++k) {
    feti::TornVector answer = u, change = u;
    for (std::size_t i = 0; i < (isHere ? 6U : 0U); ++i) {
      answer[0][i] = factor[i] * u[0][i] + load[i];
      change[0][i] = answer[0][i] - u[0][i];
    }
    u = mixing.next(answer, change);
    if (isHere && k > 0) {
      EXPECT_NEAR(u[0][5], 7.0, 1e-12);
    }
  }
  for (std::size_t i = 0; i < (isHere ? 6U : 0U); ++i)
    EXPECT_NEAR(u[0][i], load[i] / (1.0 - factor[i]), 1e-6); // what regularises, 1e-10, by a condition of 1e3
}

TEST(DeformedBodies, copies_get_their_mean) {
  const scene::Scene scene = slidingBlocks();
  const auto owned = scene::decompose(*testComm(), scene);
  const run::DeformedBodies bodies(*testComm(), scene, owned);
  // By the number of the subdomain: copies differ by one.
  feti::TornVector u = displacementOf(owned, [](int, const Point&) { return Point{}; });
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (double& value : u[i])
      value = static_cast<double>(owned[i].number);
  EXPECT_DOUBLE_EQ(bodies.joinCopies(u), 0.5);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (int node = 0; node < owned[i].mesh.mesh->numberOfNodes(); ++node) {
      const double x = owned[i].mesh.position(node)[0];
      const bool isBetween = owned[i].body == 0 && x > 0.5 && x < 3.5 && std::abs(x - std::round(x)) < 1e-9;
      EXPECT_DOUBLE_EQ(u[i][static_cast<std::size_t>(2 * node)],
                       isBetween ? std::round(x) - 0.5 : static_cast<double>(owned[i].number));
    }
}

// Frames are the rotations by which subdomains have turned, strained as they are; none of those that have
// not moved.
TEST(DeformedBodies, frames_turn_with_subdomains) {
  const scene::Scene scene = slidingBlocks();
  const auto owned = scene::decompose(*testComm(), scene);
  const run::DeformedBodies bodies(*testComm(), scene, owned);
  const double angle = 2.1, c = std::cos(angle), s = std::sin(angle);
  const feti::TornVector rest = displacementOf(owned, [](int, const Point&) { return Point{}; });
  const feti::TornVector turned = displacementOf(owned, [&](int body, const Point& x) {
    const Point strained = {1.2 * x[0], 0.9 * x[1], 0.0};
    return body == 0 ? Point{}
                     : Point{c * strained[0] - s * strained[1] - x[0] + 3.0,
                             s * strained[0] + c * strained[1] - x[1], 0.0};
  });
  const auto frames = bodies.frames(rest, turned);
  for (std::size_t i = 0; i < owned.size(); ++i) {
    EXPECT_EQ(frames[i].has_value(), owned[i].body == 1);
    if (!frames[i])
      continue;
    EXPECT_NEAR((*frames[i])(0, 0), c, 1e-14);
    EXPECT_NEAR((*frames[i])(1, 0), s, 1e-14);
  }
}

// A block that slides by more than a cell: each of its nodes keeps its force, whatever row it has now, on the
// rank that has the row; gluing rows keep theirs.
TEST(CarriedForces, go_with_nodes) {
  const scene::Scene scene = slidingBlocks();
  const auto owned = scene::decompose(*testComm(), scene);
  const feti::SubdomainSystem system(testComm(), scene::assemble(scene, owned), feti::DirichletForm::Dual);
  scene::EffectCosts costs(scene);
  const auto contactAfter = [&](double way) {
    return scene::setUpMovedContact(*testComm(), scene, {owned},
                                    scene::moved(owned, displacementOf(owned,
                                                                       [way](int body, const Point&) {
                                                                         return Point{body * way, 0.0, 0.0};
                                                                       })),
                                    costs);
  };
  const auto forcesOf = [](const feti::Constraints& constraints, const scene::ContactSetup& contact,
                           const MultiVector& lambda) {
    std::map<long long, double> forces;
    const std::vector<double> all = constraints.givenMultipliers(lambda);
    for (std::size_t k = 0; k < contact.rows.size(); ++k)
      for (const contact::ContactPoint& point : contact.points)
        if (point.number == contact.rows[k].number)
          forces[point.node] = all[k];
    return forces;
  };
  const scene::ContactSetup before = contactAfter(0.0), after = contactAfter(1.4);
  const feti::Constraints first(system, before.rows), second(system, after.rows);
  const MultiVector lambda = numberedForces(first);
  run::CarriedForces carried(scene);
  EXPECT_TRUE(carried.isEmpty());
  carried.keep(first, before, lambda);
  const Teuchos::RCP<MultiVector> now = carried.on(second, after);
  const auto had = forcesOf(first, before, lambda), has = forcesOf(second, after, *now);
  EXPECT_EQ(had.size(), has.size());
  for (const auto& [node, force] : had)
    EXPECT_NEAR(has.at(node), force, 1e-12 * force);
  // Gluing rows, which stand behind as many contacts.
  const auto then = lambda.getLocalViewHost(Tpetra::Access::ReadOnly),
             later = now->getLocalViewHost(Tpetra::Access::ReadOnly);
  std::size_t compared = 0;
  for (std::size_t r = 0, q = 0; r < then.extent(0); ++r) {
    if (first.rowType(static_cast<int>(r)) != feti::RowType::Gluing)
      continue;
    while (second.rowType(static_cast<int>(q)) != feti::RowType::Gluing)
      ++q;
    EXPECT_DOUBLE_EQ(later(q++, 0), then(r, 0));
    ++compared;
  }
  EXPECT_GT(globalSum(*testComm(), static_cast<long long>(compared)), 0);
}

// Forces of friction are vectors: where a surface of normal (0, 0, 1) turns by a hair's breadth about x or y,
// its tangents are others.
TEST(CarriedForces, turn_with_surfaces) {
  scene::Scene scene;
  scene.physics = scene::Physics::Solid;
  scene.strains = fem::Strains::Finite;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Hexahedron8;
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 2};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin = {0.0, 0.0, 1.0};
  options.elements = {3, 3, 1};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  addContact(scene, {1, "bottom"}, {0, "top"});
  scene.effects.push_back(std::make_shared<effects::Friction>(scene.effects.back(), 0.3, "rough"));
  const auto owned = scene::decompose(*testComm(), scene);
  const feti::SubdomainSystem system(testComm(), scene::assemble(scene, owned), feti::DirichletForm::Dual);
  scene::EffectCosts costs(scene);
  const auto contactTurned = [&](double aboutX, double aboutY) {
    const auto turn = [=](int, const Point& x) {
      return Point{aboutY * x[2], -aboutX * x[2], aboutX * x[1] - aboutY * x[0]};
    };
    return scene::setUpMovedContact(*testComm(), scene, {owned},
                                    scene::moved(owned, displacementOf(owned, turn)), costs);
  };
  // Of each point, by node.
  const auto forcesOf = [](const feti::Constraints& constraints, const scene::ContactSetup& contact,
                           const MultiVector& lambda) {
    std::map<long long, Point> forces;
    const std::vector<double> all = constraints.givenMultipliers(lambda);
    for (const contact::SlipPoint& slip : contact.slips)
      for (std::size_t t = 0; t < slip.tangents.size(); ++t)
        for (std::size_t d = 0; d < 3; ++d)
          forces[contact.points[slip.point].node][d] +=
              all[contact.points.size() + slip.firstPlace + t] * slip.tangents[t][d];
    return forces;
  };
  constexpr double angle = 1e-7;
  const scene::ContactSetup before = contactTurned(angle, 0.0), after = contactTurned(0.0, angle);
  const feti::Constraints first(system, before.rows), second(system, after.rows);
  const MultiVector lambda = numberedForces(first);
  run::CarriedForces carried(scene);
  carried.keep(first, before, lambda);
  const auto had = forcesOf(first, before, lambda), has = forcesOf(second, after, *carried.on(second, after));
  long long turned = 0;
  for (const auto& [node, force] : had)
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_NEAR(has.at(node)[d], force[d], 10.0 * angle * (std::abs(force[0]) + std::abs(force[1])));
  for (std::size_t s = 0; s < before.slips.size(); ++s)
    turned += std::abs(before.slips[s].tangents[0][0] - after.slips[s].tangents[0][0]) > 0.5 ? 1 : 0;
  EXPECT_GT(globalSum(*testComm(), turned), 0); // it says something
}

} // namespace test_finite_displacements
