// SPDX-License-Identifier: BSD-3-Clause

/// Interfaces that hold until they break, against what is known in closed form: a spring interface at 45° to
/// the load, two stiff blocks whose force is the law itself, in each mode and between them, pulled, let go
/// and pressed; and the energies of whole paths.

#include "Harmos_Friction.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"
#include "adhesion/Harmos_AdhesionScene.hpp"

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

void glue(scene::Scene& scene, const CohesiveLaw::Options& law) {
  const auto contact = joint(scene);
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, CohesiveLaw(law), "glue"));
}

// A column of section one and height two in mm and MPa, cut at 45°, under a uniaxial stress.
scene::Scene cutColumn(Physics physics, bool doesMatch, double stress) {
  const bool inSpace = physics == Physics::Solid;
  scene::Scene scene;
  scene.physics = physics;
  fem::StructuredBlock::Options options;
  options.cellType = inSpace ? CellType::Hexahedron8 : CellType::Quadrilateral4;
  options.subdomains = {2, inSpace ? 1 : 2, inSpace ? 2 : 1};
  const std::size_t up = inSpace ? 2 : 1;
  const fem::Material material = fem::Material::isotropic(30e3, 0.2);
  for (const bool upper : {false, true}) {
    const int finer = upper && !doesMatch ? 1 : 0;
    options.elements = {2 + finer, 2 + finer, inSpace ? 2 + finer : 1};
    options.map = [=](Point x) {
      const double cut = 0.5 + x[0];
      x[up] = upper ? cut + x[up] * (2.0 - cut) : x[up] * cut;
      return x;
    };
    scene.bodies.push_back(blockBody(upper ? "upper" : "lower", options, material));
  }
  prescribe(scene, {0, "bottom"}, static_cast<int>(up));
  prescribe(scene, {0, "left"}, 0);
  if (inSpace)
    prescribe(scene, {0, "front"}, 1);
  Point load{};
  load[up] = stress;
  addTraction(scene, {1, "top"}, load);
  CohesiveLaw::Options law;
  law.kind = CohesiveLaw::Kind::Brittle;
  law.normalStiffness = 20.0;
  law.tangentialStiffness = 40.0;
  law.normalStrength = law.tangentialStrength = 1.5;
  glue(scene, law);
  return scene;
}

} // namespace

// Normal and tangential stress are both half of the load: 1 MPa over 20 and 40 MPa/mm. In compression the
// interface closes, and slips the other way. Everything is linear, and the patch test exact on any mesh.
TEST(Adhesion, spring_interface_at_45_degrees) {
  constexpr double tolerance = 1e-9;
  for (const Physics physics : {Physics::PlaneStress, Physics::PlaneStrain, Physics::Solid})
    for (const bool doesMatch : {true, false})
      for (const double stress : {2.0, -2.0}) {
        const TestRun run = runScene(cutColumn(physics, doesMatch, stress), tolerance);
        ASSERT_TRUE(run.report.converged) << run.report.reason;
        const double opening = stress > 0.0 ? 0.05 : 0.0;
        ASSERT_FALSE(run.report.contact.empty());
        for (std::size_t k = 0; k < run.report.contact.size(); ++k) {
          const run::ContactState& state = run.report.contact[k];
          const Point& n = run.report.contactPoints[k].normal;
          EXPECT_TRUE(state.isBound);
          EXPECT_EQ(state.damage, 0.0);
          // The upper body goes up along the cut, or down: along (1, 1)/√2.
          const std::size_t up = physics == Physics::Solid ? 2 : 1;
          const double across = -dot(state.jump, n);
          const double along = (state.jump[0] + state.jump[up]) / std::sqrt(2.0);
          EXPECT_NEAR(across, opening, 10.0 * tolerance * 0.05);
          EXPECT_NEAR(along, std::copysign(0.025, stress), 10.0 * tolerance * 0.05);
          EXPECT_NEAR(dot(state.jump, state.jump), across * across + along * along, 1e-9);
          EXPECT_NEAR(state.wholeTraction[up], -0.5 * std::sqrt(2.0) * stress,
                      10.0 * tolerance * std::abs(stress));
          EXPECT_EQ(state.closed, stress < 0.0);
        }
        // What is stored: σ²/2E of a volume of two, and the springs' by the area √2.
        const double stiffness = physics == Physics::PlaneStrain ? 30e3 / (1.0 - 0.04) : 30e3;
        const double springs = std::sqrt(2.0) * 0.5 * (opening + 0.025);
        EXPECT_NEAR(run.report.steps.at(0).energy, 4.0 / stiffness + springs, 1e-8);
        EXPECT_NEAR(run.report.steps.at(0).externalWork, run.report.steps.at(0).energy, 1e-8);
        EXPECT_EQ(run.report.steps.at(0).broken, 0);
        EXPECT_EQ(run.report.steps.at(0).released, 0.0);
      }
}

namespace {

constexpr double young = 1e6, height = 1.0; // of blocks beside springs of 100

// Two blocks, glued together; the top of the upper one moves along a path, to the right and up, at its right
// end by a tilt more.
scene::Scene pulledBlocks(const CohesiveLaw::Options& law, const std::vector<double>& ends,
                          const std::vector<double>& rights, const std::vector<double>& ups,
                          bool doesMatch = true, double tilt = 0.0) {
  scene::Scene scene;
  scene.physics = Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral4;
  options.size = {1.0, height, 1.0};
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, 1};
  const fem::Material material = fem::Material::isotropic(young, 0.0);
  scene.bodies.push_back(blockBody("lower", options, material));
  options.origin[1] = height;
  if (!doesMatch)
    options.elements = {3, 2, 1};
  scene.bodies.push_back(blockBody("upper", options, material));
  for (int c = 0; c < 2; ++c)
    prescribe(scene, {0, "bottom"}, c);
  prescribe(scene, {1, "top"}, 0, 1.0);
  const auto right = scene.effects.back();
  prescribe(scene, {1, "top"}, 1, [tilt](const Point& x) { return 1.0 + tilt * x[0]; });
  const auto up = scene.effects.back();
  glue(scene, law);
  scene.timeline = scene::Timeline(ends);
  const auto path = [&](const std::string& name, const scene::Effect& effect, std::vector<double> values) {
    std::vector<double> times = {0.0};
    times.insert(times.end(), ends.begin(), ends.end());
    values.insert(values.begin(), 0.0);
    scene.timeline.add(name, scene::History(times, values));
    scene.timeline.follow(effect, name);
  };
  path("right", *right, rights);
  path("up", *up, ups);
  return scene;
}

std::vector<double> multiplesOf(double factor, const std::vector<double>& values) {
  std::vector<double> result;
  for (double value : values)
    result.push_back(factor * value);
  return result;
}

std::array<double, 2> forceOf(const run::StepRow& row) { // of the lower block on the upper one
  for (const run::Forces::Of& effect : row.forces)
    if (effect.path == "Contact/joint")
      return {-effect.resultant.force[0], -effect.resultant.force[1]};
  throw InternalError("no force of the joint");
}

} // namespace

// The force that two blocks are pulled apart with, over the opening, is the law, in both modes and between
// them: from the strength on down to nothing; all of the work is dissipated, and that is the fracture energy
// of the mixture. Blocks give way by 2e-4 of what the springs do.
TEST(Adhesion, blocks_pulled_apart_follow_the_law) {
  for (const auto mixed : {CohesiveLaw::MixedMode::Power, CohesiveLaw::MixedMode::BenzeggaghKenane})
    for (const double angle : {0.0, 0.6, 1.1, 1.5707963267948966}) {
      CohesiveLaw::Options options = softLaw();
      options.mixedMode = mixed;
      options.exponent = 1.5;
      const double cosine = std::cos(angle), sine = std::sin(angle);
      // Once more, by hand.
      const double tangential = 60.0 * sine * sine, normal = 100.0 * cosine * cosine;
      const double share = tangential / (tangential + normal), stiffness = tangential + normal;
      const double first =
          1.0 / std::sqrt(std::pow(100.0 * cosine / 1.0, 2) + std::pow(60.0 * sine / 0.8, 2));
      const double energy =
          mixed == CohesiveLaw::MixedMode::Power
              ? std::pow(std::pow((1.0 - share) / 0.05, 1.5) + std::pow(share / 0.08, 1.5), -1.0 / 1.5)
              : 0.05 + 0.03 * std::pow(share, 1.5);
      const double last = 2.0 * energy / (stiffness * first);
      std::vector<double> lengths = {0.5 * first, first};
      for (int k = 1; k <= 9; ++k)
        lengths.push_back(first + (last - first) * k / 10.0);
      lengths.push_back(0.9999 * last);
      lengths.push_back(1.2 * last);
      const TestRun run = runScene(pulledBlocks(options, upTo(lengths.size()), multiplesOf(sine, lengths),
                                                multiplesOf(cosine, lengths), angle < 1.0),
                                   1e-6);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      ASSERT_EQ(run.report.steps.size(), lengths.size()) << "a step was halved";
      for (std::size_t k = 0; k < lengths.size(); ++k) {
        const double length = lengths[k];
        const double left = length <= first  ? 1.0
                            : length >= last ? 0.0
                                             : first * (last - length) / (length * (last - first));
        const std::array<double, 2> force = forceOf(run.report.steps[k]);
        EXPECT_NEAR(force[0], left * 60.0 * sine * length, 1e-3) << angle << " " << k;
        // In pure shear blocks bend a little, and some points press: a hundredth of the shear.
        EXPECT_NEAR(force[1], left * 100.0 * cosine * length, angle > 1.5 ? 0.01 : 1e-3) << angle << " " << k;
      }
      expectEnergies(run.report.steps, 1e-3 * energy);
      const run::StepRow& end = run.report.steps.back();
      EXPECT_NEAR(end.externalWork, energy, 1e-3 * energy);
      EXPECT_NEAR(end.dissipated, energy, 1e-3 * energy);
      EXPECT_NEAR(end.released, 0.0, 1e-3 * energy);
      EXPECT_EQ(end.broken, static_cast<long long>(run.report.contact.size()));
    }
}

// Half broken: let go, the force goes straight to the origin; pressed, the crack carries the load as if it
// were none; pulled again it comes back on that line to where it was, and goes on along the law.
TEST(Adhesion, unloading_goes_to_the_origin_and_closed_cracks_press) {
  const double first = 0.01, last = 0.1, half = 0.5 * (first + last);
  const std::vector<double> lengths = {first, 0.7 * half, half,       0.5 * half, 0.0,
                                       -1e-7, 0.0,        0.5 * half, half,       0.5 * (half + last)};
  const TestRun run =
      runScene(pulledBlocks(softLaw(), upTo(lengths.size()), multiplesOf(0.0, lengths), lengths), 1e-8);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  const std::vector<double> forces = {1.0, (last - 0.7 * half) / (last - first),
                                      0.5, 0.25,
                                      0.0, -1e-7 * young / (2.0 * height),
                                      0.0, 0.25,
                                      0.5, 0.25};
  std::vector<run::StepRow> rows;
  for (const run::StepRow& row : run.report.steps)
    if (row.time == std::floor(row.time))
      rows.push_back(row);
  ASSERT_EQ(rows.size(), lengths.size());
  for (std::size_t k = 0; k < lengths.size(); ++k)
    EXPECT_NEAR(forceOf(rows[k])[1], forces[k], 1e-3) << k;
  expectEnergies(run.report.steps, 1e-3 * 0.05);
  // Back where it was, but for ten tolerances of the opening.
  EXPECT_NEAR(rows[8].dissipated, rows[2].dissipated, 10.0 * 1e-8 * 0.05);
  EXPECT_NEAR(rows[2].dissipated, 0.5 * 0.05, 1e-3 * 0.05); // half of the law is behind
}

// A step in which too much breaks at once is halved, and its parts are those of a path that was given them:
// the same answers. So they are with many steps: the path is proportional, no point's mode changes, and the
// law alone says how far each is damaged and what that took, whatever the steps were.
TEST(Adhesion, halved_steps_end_as_small_ones_do) {
  constexpr double tolerance = 1e-8, first = 0.001, last = 0.02;
  const auto blocks = [](const std::vector<double>& ends) {
    std::vector<double> ups;
    for (const double end : ends)
      ups.push_back(first + (last - first) * (end - 1.0));
    // Openings from a to 4a, and slips of 3a, for the upper block turns.
    return runScene(pulledBlocks(softLaw(), ends, multiplesOf(0.0, ups), ups, false, 3.0), tolerance);
  };
  const TestRun halved = blocks({1.0, 2.0});
  ASSERT_TRUE(halved.report.converged) << halved.report.reason;
  std::vector<double> same, small = {1.0};
  for (const run::StepRow& row : halved.report.steps)
    same.push_back(row.time);
  ASSERT_GT(same.size(), 2U) << "nothing was halved";
  for (int k = 1; k <= 20; ++k)
    small.push_back(1.0 + k / 20.0);
  for (const std::vector<double>& ends : {same, small}) {
    const TestRun given = blocks(ends);
    ASSERT_TRUE(given.report.converged) << given.report.reason;
    ASSERT_EQ(given.report.steps.size(), ends.size()) << "a step was halved";
    // Both know tractions to ten tolerances of the strength, and a damage is how much less than kδ, which is
    // no less than the strength, a traction is.
    constexpr double allowed = 2.0 * 10.0 * tolerance;
    ASSERT_EQ(given.report.contact.size(), halved.report.contact.size());
    double least = 1.0, most = 0.0;
    for (std::size_t k = 0; k < given.report.contact.size(); ++k) {
      const run::ContactState &one = halved.report.contact[k], &other = given.report.contact[k];
      EXPECT_NEAR(one.damage, other.damage, allowed) << k;
      for (std::size_t d = 0; d < 2; ++d)
        EXPECT_NEAR(one.wholeTraction[d], other.wholeTraction[d], allowed) << k;
      least = std::min(least, one.damage);
      most = std::max(most, one.damage);
    }
    EXPECT_GT(least, 0.0);
    EXPECT_LT(most, 1.0);
    EXPECT_GT(most, least + 0.1) << "points are alike";
    const run::StepRow &one = halved.report.steps.back(), &other = given.report.steps.back();
    for (const int d : {0, 1})
      EXPECT_NEAR(forceOf(one)[d], forceOf(other)[d], allowed);
    constexpr double energy = 0.08; // of the law, the larger one
    EXPECT_NEAR(one.energy, other.energy, allowed * energy);
    // Modes do change by what blocks give way: 2e-4 of what the springs do.
    EXPECT_NEAR(one.dissipated, other.dissipated, (ends.size() == same.size() ? allowed : 2e-4) * energy);
  }
}

namespace {

// A beam that is split from its left end on over 30 of 100 mm, and pulled open there: the crack is a gap of a
// thousandth. The beam of Alfano and Crisfield, but of isotropic halves, per thickness.
scene::Scene splitBeam(double opening, int steps) {
  constexpr double half = 1.5, length = 100.0, crack = 30.0;
  scene::Scene scene;
  scene.physics = Physics::PlaneStress;
  fem::StructuredBlock::Options options;
  options.cellType = CellType::Quadrilateral9;
  options.size = {length, half, 1.0};
  options.subdomains = {8, 1, 1};
  options.elements = {5, 1, 1};
  const fem::Material material = fem::Material::isotropic(135300.0, 0.0);
  scene.bodies.push_back(blockBody("lower", options, material));
  options.origin[1] = half;
  options.map = [=](Point x) {
    x[1] += 1e-3 * std::max(0.0, 1.0 - x[0] / crack);
    return x;
  };
  scene.bodies.push_back(blockBody("upper", options, material));
  for (const int body : {0, 1})
    prescribe(scene, {body, "right"}, 0);
  prescribe(scene, {0, "left"}, 1);
  prescribe(scene, {1, "left"}, 1, opening);
  CohesiveLaw::Options law;
  law.normalStiffness = law.tangentialStiffness = 1e3;
  law.normalStrength = law.tangentialStrength = 1.7;
  law.fractureEnergy = law.fractureEnergyII = 0.28;
  glue(scene, law);
  std::vector<double> ends;
  for (int k = 1; k <= steps; ++k)
    ends.push_back(k / static_cast<double>(steps));
  scene.timeline = scene::Timeline(ends);
  return scene;
}

} // namespace

// A beam that is split further and further: the work goes into what the beam stores and what the interface
// dissipates, to 1e-3 of it all the way. What is missing is the trapezoidal rule's, which makes straight what
// bends between two states, and what tractions are beside the law by tolerance: less with more steps, where
// points break one by one by the first power of their length. Damage never falls; the force has a peak, and
// the peak is behind where points have broken.
TEST(Adhesion, split_beam_keeps_its_energies) {
  std::vector<double> defects;
  for (const int steps : {12, 24, 48}) {
    const TestRun run = runScene(splitBeam(5.0, steps), 1e-5);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    double most = 0.0;
    std::vector<int> products;
    for (const run::StepRow& row : run.report.steps) {
      most = std::max(most, forceOf(row)[1]);
      products.push_back(row.products);
    }
    const run::StepRow& end = run.report.steps.back();
    const double allowed = 1e-3 * 48.0 / steps * end.externalWork;
    defects.push_back(expectEnergies(run.report.steps, allowed) / end.externalWork);
    std::sort(products.begin(), products.end());
    std::cout << steps << " steps: " << defects.back() << " of the work is missing, " << end.released
              << " released, peak " << most << ", products " << products[products.size() / 2] << ", "
              << products.back() << " at most\n";
    EXPECT_GT(end.broken, 0);
    EXPECT_LT(forceOf(end)[1], 0.9 * most);
    // Points break one by one: the beam's force has teeth, of which little is left over.
    EXPECT_LE(end.released, 2e-3 * end.externalWork);
  }
  EXPECT_LT(defects[2], 0.5 * defects[0]);
}

// By the brittle law all of it breaks at its strength, and what was stored is dissipated.
TEST(Adhesion, brittle_blocks_break_at_once) {
  CohesiveLaw::Options law = softLaw();
  law.kind = CohesiveLaw::Kind::Brittle;
  const std::vector<double> lengths = {0.0099, 0.0102, 0.02};
  scene::Scene scene = pulledBlocks(law, upTo(3), multiplesOf(0.0, lengths), lengths);
  const TestRun run = runScene(scene, 1e-8);
  ASSERT_TRUE(run.report.converged) << run.report.reason;
  EXPECT_NEAR(forceOf(run.report.steps[0])[1], 0.99, 1e-3);
  EXPECT_EQ(run.report.steps[0].broken, 0);
  const run::StepRow& end = run.report.steps.back();
  EXPECT_EQ(end.broken, static_cast<long long>(run.report.contact.size()));
  EXPECT_NEAR(forceOf(end)[1], 0.0, 1e-9);
  // σ²/2k by the area of one.
  EXPECT_NEAR(end.dissipated, 0.5 / 100.0, 1e-12);
  EXPECT_NEAR(end.energy, 0.0, 1e-9);
  // The step was halved to a 64th: work by the trapezoidal rule is known to half of that one's.
  expectEnergies(run.report.steps, 0.5 * 0.0003 / 64.0);
  EXPECT_NEAR(end.externalWork, 0.5 / 100.0, 0.0003);
}
