// SPDX-License-Identifier: BSD-3-Clause

/// Adhesion in space: the law itself in every direction, and friction that takes over where points break.

#include "Harmos_AdhesionScene.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

using namespace Harmos;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

// Two blocks of one height, pressed and sheared, or pulled, by the top of the upper one: of a square section
// in space, of unit thickness in the plane.
struct Blocks {
  CellType cellType = CellType::Hexahedron8;
  int elements = 1; // a side of the interface
  double width = 1.0, modulus = 1e6;
  CohesiveLaw::Options law = softLaw();
  double friction = 0.0; // coefficient; 0: none
};

// @param along of the top's motion, up at last. @param ups, rights by which it is multiplied at the ends of
// steps: the part across and that along the interface.
scene::Scene movedBlocks(const Blocks& blocks, const Point& along, const std::vector<double>& ups,
                         const std::vector<double>& rights) {
  const bool inSpace = blocks.cellType != CellType::Quadrilateral4;
  scene::Scene scene;
  scene.physics = inSpace ? Physics::Solid : Physics::PlaneStrain;
  const std::size_t up = inSpace ? 2 : 1;
  fem::StructuredBlock::Options options;
  options.cellType = blocks.cellType;
  options.size = {blocks.width, inSpace ? blocks.width : 1.0, 1.0};
  options.subdomains = {1, 1, 1};
  options.elements = {blocks.elements, inSpace ? blocks.elements : 1, 1};
  const fem::Material material = fem::Material::isotropic(blocks.modulus, 0.0);
  scene.bodies.push_back(blockBody("lower", options, material));
  options.origin[up] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, material));
  const std::vector<double> ends = upTo(ups.size());
  const auto path = [&](const std::string& name, std::vector<double> values) {
    std::vector<double> times = {0.0};
    times.insert(times.end(), ends.begin(), ends.end());
    values.insert(values.begin(), 0.0);
    scene.timeline.add(name, scene::History(times, values));
  };
  scene.timeline = scene::Timeline(ends);
  path("up", ups);
  path("right", rights);
  for (std::size_t c = 0; c <= up; ++c) {
    prescribe(scene, {0, "bottom"}, static_cast<int>(c));
    prescribe(scene, {1, "top"}, static_cast<int>(c), along[c]);
    scene.timeline.follow(*scene.effects.back(), c == up ? "up" : "right");
  }
  const auto contact = joint(scene);
  if (blocks.friction > 0.0)
    scene.effects.push_back(
        std::make_shared<effects::Friction>(contact, effects::Coulomb(blocks.friction), "rough"));
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, CohesiveLaw(blocks.law), "glue"));
  return scene;
}

Point wholeForceOf(const run::StepRow& row) { // of the lower block on the upper one
  for (const run::Forces::Of& effect : row.forces)
    if (effect.path == "Contact/joint")
      return {-effect.resultant.force[0], -effect.resultant.force[1], -effect.resultant.force[2]};
  throw InternalError("no force of the joint");
}

// Rows at the ends of given steps.
std::vector<run::StepRow> wholeSteps(const run::RunReport& report) {
  std::vector<run::StepRow> rows;
  for (const run::StepRow& row : report.steps)
    if (row.time == std::floor(row.time))
      rows.push_back(row);
  return rows;
}

struct LawAlong { // a direction of length one
  double first, last, energy;
};

LawAlong lawAlong(const CohesiveLaw::Options& law, const Point& along) { // by hand
  const double slip2 = along[0] * along[0] + along[1] * along[1], open2 = along[2] * along[2];
  const double tangential = law.tangentialStiffness * slip2, normal = law.normalStiffness * open2;
  const double stiffness = tangential + normal, share = tangential / stiffness, p = law.exponent;
  const double first = 1.0 / std::sqrt(std::pow(law.normalStiffness / law.normalStrength, 2) * open2 +
                                       std::pow(law.tangentialStiffness / law.tangentialStrength, 2) * slip2);
  if (law.kind == CohesiveLaw::Kind::Brittle)
    return {first, first, 0.5 * stiffness * first * first};
  const double energy =
      law.mixedMode == CohesiveLaw::MixedMode::Power
          ? std::pow(std::pow((1.0 - share) / law.fractureEnergy, p) +
                         std::pow(share / law.fractureEnergyII, p),
                     -1.0 / p)
          : law.fractureEnergy + (law.fractureEnergyII - law.fractureEnergy) * std::pow(share, p);
  return {first, 2.0 * energy / (stiffness * first), energy};
}

void expectLawInSpace(const Blocks& blocks, const Point& along, const std::string& what) {
  const CohesiveLaw::Options& law = blocks.law;
  const auto [first, last, energy] = lawAlong(law, along);
  std::vector<double> lengths = {0.5 * first, 0.98 * first};
  for (int k = 1; k <= 4 && last > first; ++k)
    lengths.push_back(first + (last - first) * k / 5.0);
  lengths.push_back(1.02 * last);
  lengths.push_back(1.5 * last);
  constexpr double tolerance = 1e-6;
  const TestRun run = runScene(movedBlocks(blocks, along, lengths, lengths), tolerance);
  ASSERT_TRUE(run.report.converged) << what << ": " << run.report.reason;
  const std::vector<run::StepRow> rows = wholeSteps(run.report);
  ASSERT_EQ(rows.size(), lengths.size()) << what;
  // Blocks give way by 4/E a unit of force, the law by 1/k: so tractions differ by a share of kE⁻¹·4 of the
  // strength, 4e-4, and where steps soften by the slope, which is less steep.
  constexpr double allowed = 5e-4;
  // Of several elements corners press in pure shear, and what presses pulls elsewhere.
  const bool bends = along[2] == 0.0 && blocks.elements > 1;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const double length = lengths[k];
    const double left = length <= first  ? 1.0
                        : length >= last ? 0.0
                                         : first * (last - length) / (length * (last - first));
    const Point force = wholeForceOf(rows[k]);
    for (const std::size_t d : {0, 1})
      EXPECT_NEAR(force[d], left * law.tangentialStiffness * length * along[d], allowed) << what << " " << k;
    EXPECT_NEAR(force[2], left * law.normalStiffness * length * along[2], bends ? 0.05 : allowed)
        << what << " " << k;
  }
  const run::StepRow& end = rows.back();
  EXPECT_NEAR(end.dissipated, energy, 1e-4 * energy) << what;
  EXPECT_EQ(end.broken, run.report.contactCounts.points) << what;
}

std::vector<Point> directionsInSpace() {
  std::vector<Point> directions = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},   {0.8, -0.6, 0.0},
                                   {0.0, 0.0, 1.0}, {0.6, 0.48, 0.64}, {0.0, 0.8, 0.6}};
  return directions;
}

} // namespace

// As in the plane, with two directions of slip, alone, oblique and with an opening: where points soften their
// springs are stiffer across the way in which they slip than along it.
TEST(Adhesion, law_in_space) {
  using Mixed = CohesiveLaw::MixedMode;
  std::size_t count = 0;
  for (const Point& along : directionsInSpace())
    for (const auto& [kind, mixed] : {std::pair(CohesiveLaw::Kind::Bilinear, Mixed::Power),
                                      std::pair(CohesiveLaw::Kind::Bilinear, Mixed::BenzeggaghKenane),
                                      std::pair(CohesiveLaw::Kind::Brittle, Mixed::Power)})
      for (const auto& [cellType, elements] :
           {std::pair(CellType::Hexahedron8, 1), std::pair(CellType::Tetrahedron4, 2)}) {
        Blocks blocks;
        blocks.cellType = cellType;
        blocks.elements = elements;
        blocks.law.kind = kind;
        blocks.law.mixedMode = mixed;
        blocks.law.exponent = 1.5;
        // Nothing presses but corners: with friction the answer is the same.
        blocks.friction = ++count % 2 == 0 ? 0.3 : 0.0;
        expectLawInSpace(blocks, along,
                         "direction " + std::to_string(along[0]) + " " + std::to_string(along[1]) + " " +
                             std::to_string(along[2]) + ", law " + std::to_string(static_cast<int>(kind)) +
                             std::to_string(static_cast<int>(mixed)) + ", cells of " +
                             std::to_string(elements));
      }
}

namespace {

// Pressed by one, a shear modulus of E/2: the upper side has to go by 4/E for a shear of one beyond what the
// interface slips.
constexpr double roughness = 0.3, slipAtEnd = 2.0 * 0.08 / 0.8;

Blocks pressedBlocks(CellType cellType, double modulus) {
  Blocks blocks;
  blocks.cellType = cellType;
  blocks.width = 10.0; // so that the moment of the shear changes pressures little
  blocks.modulus = modulus;
  blocks.friction = roughness;
  return blocks;
}

} // namespace

// A pressed interface that breaks while friction waits: the shear falls along the law to nothing, at the slip
// where that ends; from there on it stands still until the shear is the friction's limit, and slips. Bodies
// that are stiffer than softening is steep follow all of it. There is no answer in which friction acts from
// an earlier slip: it would hold the point where it is not broken.
TEST(Adhesion, friction_takes_over_where_a_point_breaks) {
  constexpr double modulus = 50.0, tolerance = 1e-6;
  for (const auto& [cellType, along] : {std::pair(CellType::Quadrilateral4, Point{1.0, 1.0, 0.0}),
                                        std::pair(CellType::Hexahedron8, Point{0.8, -0.6, 1.0})}) {
    const bool inSpace = cellType == CellType::Hexahedron8;
    const double area = inSpace ? 100.0 : 10.0, compliance = 4.0 / modulus;
    const double held = 0.4 * roughness; // of the shear, in the step in which it stands still
    std::vector<double> rights = {0.0, 0.08, 0.12, 0.16, 0.19};
    rights.push_back(slipAtEnd + compliance * held);
    rights.push_back(slipAtEnd + 2.0 * compliance * roughness);
    const std::vector<double> ups(rights.size(), -2.0 / modulus);
    const TestRun run =
        runScene(movedBlocks(pressedBlocks(cellType, modulus), along, ups, rights), tolerance);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const std::vector<run::StepRow> rows = wholeSteps(run.report);
    ASSERT_EQ(rows.size(), rights.size());
    const auto shearOf = [&](const run::StepRow& row) {
      const Point force = wholeForceOf(row);
      return inSpace ? std::hypot(force[0], force[1]) / area : std::abs(force[0]) / area;
    };
    const auto pressOf = [&](const run::StepRow& row) { return -wholeForceOf(row)[inSpace ? 2 : 1] / area; };
    const run::StepRow &stands = rows[rows.size() - 2], &slips = rows.back();
    // All of it is broken, and nothing has slipped since: the law's energy alone is dissipated.
    EXPECT_EQ(stands.broken, run.report.contactCounts.points);
    EXPECT_EQ(stands.slipping, 0);
    EXPECT_NEAR(stands.dissipated, 0.08 * area, 1e-4 * 0.08 * area);
    EXPECT_NEAR(shearOf(stands), held, 0.02 * held);
    EXPECT_EQ(slips.sticking, 0);
    EXPECT_NEAR(shearOf(slips), roughness * pressOf(slips), 1e-4 * roughness);
    // And then friction's, by a way of compliance · roughness. Blocks bend: that adds a share of the square
    // of height over width to their compliance, a hundredth or two.
    const double rubbed = roughness * compliance * roughness;
    EXPECT_NEAR(slips.dissipated, (0.08 + rubbed) * area, 0.02 * rubbed * area);
    for (const run::ContactState& state : run.report.contact)
      EXPECT_NEAR(std::sqrt(dot(state.slip, state.slip)), slipAtEnd + compliance * roughness, 1e-3);
    // The force falls to nothing and rises again within the step in which all breaks: of that the trapezoidal
    // rule knows half of force times motion.
    const double motion = slipAtEnd + compliance * held - 0.19;
    for (const run::StepRow& row : run.report.steps)
      EXPECT_NEAR(row.released, 0.0, 0.5 * held * motion * area) << row.time;
  }
}

// Bodies that are softer than softening is steep cannot follow: the interface snaps to friction, at once, and
// the run says what that released.
TEST(Adhesion, soft_bodies_snap_to_friction) {
  constexpr double modulus = 8.0, tolerance = 1e-6;
  for (const auto& [cellType, along] : {std::pair(CellType::Quadrilateral4, Point{1.0, 1.0, 0.0}),
                                        std::pair(CellType::Hexahedron8, Point{0.8, -0.6, 1.0})}) {
    const bool inSpace = cellType == CellType::Hexahedron8;
    const double area = inSpace ? 100.0 : 10.0;
    const std::vector<double> rights = {0.0, 0.3, 0.5, 0.7}, ups(rights.size(), -2.0 / modulus);
    const TestRun run =
        runScene(movedBlocks(pressedBlocks(cellType, modulus), along, ups, rights), tolerance);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const run::StepRow& end = run.report.steps.back();
    EXPECT_EQ(end.broken, run.report.contactCounts.points);
    EXPECT_EQ(end.sticking, 0);
    const Point force = wholeForceOf(end);
    EXPECT_NEAR(std::hypot(force[0], inSpace ? force[1] : 0.0), -roughness * force[inSpace ? 2 : 1],
                1e-4 * area);
    EXPECT_GT(end.released, 0.01 * area);
    EXPECT_NEAR(defect(end), 0.0, 1e-3 * end.externalWork);
  }
}
