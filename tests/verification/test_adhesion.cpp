// SPDX-License-Identifier: BSD-3-Clause

/// Interfaces that hold until they break, against what is known in closed form: a spring interface at 45° to
/// the load, two stiff blocks whose force is the law itself, in each mode and between them, pulled, let go
/// and pressed; and the energies of whole paths.

#include "Harmos_Adhesion.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

using namespace Harmos;
using effects::CohesiveLaw;
using fem::CellType;
using fem::Point;
using scene::Physics;

namespace {

std::shared_ptr<const scene::Effect> joint(scene::Scene& scene) {
  effects::SurfacePair pair;
  pair.first = {1, "bottom"};
  pair.second = {0, "top"};
  const auto contact = std::make_shared<effects::Contact>(pair, 0.0, "joint");
  scene.effects.push_back(contact);
  return contact;
}

void glue(scene::Scene& scene, const CohesiveLaw::Options& law) {
  const auto contact = joint(scene);
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, CohesiveLaw(law), "glue"));
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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

CohesiveLaw::Options softLaw() {
  CohesiveLaw::Options law;
  law.normalStiffness = 100.0;
  law.tangentialStiffness = 60.0;
  law.normalStrength = 1.0;
  law.tangentialStrength = 0.8;
  law.fractureEnergy = 0.05;
  law.fractureEnergyII = 0.08;
  return law;
}

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

std::vector<double> upTo(std::size_t count) {
  std::vector<double> result;
  for (std::size_t k = 1; k <= count; ++k)
    result.push_back(static_cast<double>(k));
  return result;
}

std::array<double, 2> forceOf(const run::StepRow& row) { // of the lower block on the upper one
  for (const run::Forces::Of& effect : row.forces)
    if (effect.path == "Contact/joint")
      return {-effect.resultant.force[0], -effect.resultant.force[1]};
  throw InternalError("no force of the joint");
}

double defect(const run::StepRow& row) {
  return row.externalWork - row.energy - row.dissipated - row.released;
}

// All along: work is stored, dissipated or released, but for an energy; nothing heals.
// @return the most that was missing.
double expectEnergies(const std::vector<run::StepRow>& rows, double allowed) {
  double most = 0.0;
  run::StepRow before;
  for (const run::StepRow& row : rows) {
    most = std::max(most, std::abs(defect(row)));
    EXPECT_NEAR(defect(row), 0.0, allowed) << row.time;
    EXPECT_GE(row.broken, before.broken) << row.time;
    EXPECT_GE(row.released, before.released) << row.time;
    // Where no point is damaged further it is the same number.
    EXPECT_GE(row.dissipated, before.dissipated) << row.time;
    before = row;
  }
  return most;
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
