// SPDX-License-Identifier: BSD-3-Clause

/// Runs of several steps, against static solutions of each step's loads, and energies against each other.

#include "Harmos_CrushableFloor.hpp"
#include "Harmos_EffectStates.hpp"
#include "Harmos_StepClock.hpp"
#include "Harmos_StepTable.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace test_step_sequence {

using namespace Harmos;

namespace {

constexpr double tolerance = 1e-9;
// Of forces and energies: residuals by the condition of these F, a hundred at most.
constexpr double bound = 1e3 * tolerance;

fem::StructuredBlock::Options gridOptions() {
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {2, 2, 1};
  options.elements = {4, 4, 1};
  return options;
}

// A block held at its left side in x, over a floor; its top moves by `down`.
scene::Scene overFloor(double gap, double down, bool onCylinder = false) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options = gridOptions();
  options.origin = {0.0, gap, 0.0};
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  prescribe(scene, {0, "left"}, 0);
  prescribe(scene, {0, "top"}, 1, -down);
  contact::Obstacle floor;
  floor.direction = {0.0, 1.0, 0.0};
  if (onCylinder) {
    floor.shape = contact::Obstacle::Shape::Cylinder;
    floor.point = {0.0, -2.0, 0.0};
    floor.direction = {0.0, 0.0, 1.0};
    floor.radius = 2.0;
  }
  addObstacle(scene, {0, "bottom"}, floor);
  return scene;
}

// Numbers in memory, in the place of a checkpoint.
class Numbers : public qp::StateArchive<MultiVector> {
 public:
  bool reads = false;
  bool isReading() const override { return reads; }
  void numbers(const std::string& name, std::vector<double>& values) override {
    if (reads)
      values = kept_.at(name);
    else
      kept_[name] = values;
  }
  void vector(const std::string&, MultiVector&) override { FAIL() << "none is kept here"; }
  void rowVector(const std::string&, MultiVector&) override { FAIL() << "none is kept here"; }

 private:
  std::map<std::string, std::vector<double>> kept_;
};

void follow(scene::Scene& scene, const std::string& kind, const std::string& history) {
  for (const auto& effect : scene.effects)
    if (effect->kind() == kind)
      scene.timeline.follow(*effect, history);
}

} // namespace

// Presses, lifts off, presses again: what a step leaves behind is no part of the next one's answer.
TEST(StepSequence, each_step_is_the_static_solution_of_its_load) {
  const std::vector<double> ends = {1.0, 2.0, 3.0, 4.0}, factors = {1.0, 0.3, -0.5, 0.8};
  for (const char* dirichlet : {"primal", "dual"}) {
    const std::vector<std::string> setting = {std::string("Decomposition/Dirichlet=") + dirichlet};
    scene::Scene scene = overFloor(0.01, 0.05, true);
    scene.timeline = scene::Timeline(ends);
    scene.timeline.add("press", scene::History({0.0, 1.0, 2.0, 3.0, 4.0},
                                               {0.0, factors[0], factors[1], factors[2], factors[3]}));
    follow(scene, "Prescribed displacement", "press");
    const TestRun run = runScene(scene, tolerance, setting);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    ASSERT_EQ(run.report.steps.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      const run::StepRow& row = run.report.steps[k];
      const TestRun alone = runScene(overFloor(0.01, 0.05 * factors[k], true), tolerance, setting);
      ASSERT_TRUE(alone.report.converged);
      const run::StepRow& expected = alone.report.steps.at(0);
      EXPECT_EQ(row.time, ends[k]);
      EXPECT_NEAR(row.energy, expected.energy, bound) << k;
      EXPECT_EQ(row.closed, expected.closed) << k;
      EXPECT_EQ(row.closed > 0, factors[k] > 0.25) << "the load does not do what this test is about";
      for (std::size_t e = 0; e < row.forces.size(); ++e)
        for (std::size_t d = 0; d < 3; ++d)
          EXPECT_NEAR(row.forces[e].resultant.force[d], expected.forces[e].resultant.force[d], bound) << k;
    }
    EXPECT_EQ(run.report.factorisations, run.report.distinctFactorizations);
  }
}

// Work goes in as energy; the trapezoidal rule's error is of second order where contact closes bit by bit.
TEST(StepSequence, external_work_is_the_energy_gained) {
  std::vector<double> lengths, errors;
  for (int steps : {4, 8, 16, 32}) {
    scene::Scene scene = overFloor(0.0, 0.1, true);
    std::vector<double> ends;
    for (int k = 1; k <= steps; ++k)
      ends.push_back(k / static_cast<double>(steps));
    scene.timeline = scene::Timeline(ends);
    const TestRun run = runScene(scene, 1e-11);
    ASSERT_TRUE(run.report.converged) << run.report.reason;
    const run::StepRow& last = run.report.steps.back();
    lengths.push_back(1.0 / steps);
    errors.push_back(std::abs(last.externalWork - last.energy));
  }
  const double rate = fittedRate(lengths, errors);
  EXPECT_GT(rate, 1.6);
  EXPECT_LT(rate, 2.4);
}

// Of temperatures: a body that may expand stores nothing, one that may not ½∫ε_T:C:ε_T, here with C of plane
// strain ½ · 3αT · 3αT · E/(3(1 − 2ν)).
TEST(StepSequence, stored_energy_knows_strains_of_temperatures) {
  constexpr double young = 2.0, poisson = 0.25, expansion = 1e-2, rise = 3.0;
  fem::Material material = fem::Material::isotropic(young, poisson);
  material.expansion = {expansion, expansion, expansion};
  for (bool held : {false, true})
    for (int steps : {1, 3}) {
      scene::Scene scene;
      scene.physics = scene::Physics::Solid;
      fem::StructuredBlock::Options options;
      options.cellType = fem::CellType::Hexahedron8;
      options.subdomains = {2, 1, 1};
      options.elements = {2, 2, 2};
      scene.bodies.push_back(blockBody("block", options, material));
      const std::vector<std::string> sides = {"left", "front", "bottom", "right", "back", "top"};
      for (std::size_t k = 0; k < (held ? 6u : 3u); ++k)
        prescribe(scene, {0, sides[k]}, static_cast<int>(k % 3));
      addTemperature(scene, 0, rise);
      if (steps > 1)
        scene.timeline = scene::Timeline({1.0, 2.0, 3.0});
      const TestRun run = runScene(scene, 1e-10);
      ASSERT_TRUE(run.report.converged) << run.report.reason;
      const double strain = expansion * rise;
      const double whole = 0.5 * 9.0 * strain * strain * young / (3.0 * (1.0 - 2.0 * poisson));
      const run::StepRow& last = run.report.steps.back();
      // A hundred times the tolerance, for the condition of these blocks.
      EXPECT_NEAR(last.energy, held ? whole : 0.0, 1e-8 * whole) << held << steps;
      EXPECT_NEAR(last.externalWork, last.energy, 1e-8 * whole) << held << steps;
    }
}

// What has been crushed stays: a second pressing to the same place crushes no more, and meets the same force.
TEST(StepSequence, states_of_effects_are_kept) {
  constexpr double strength = 0.02;
  const auto sceneOf = [&](double most) {
    scene::Scene scene = overFloor(0.0, 0.05);
    removeEffects(scene, "Obstacle");
    scene.effects.push_back(std::make_shared<CrushableFloor>(0, "bottom", most, 2.0));
    scene.timeline = scene::Timeline({1.0, 2.0, 3.0});
    scene.timeline.add("press", scene::History({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 0.0, 1.0}));
    follow(scene, "Prescribed displacement", "press");
    return scene;
  };
  const TestRun hard = runScene(sceneOf(1e9), tolerance), soft = runScene(sceneOf(strength), tolerance);
  ASSERT_TRUE(hard.report.converged && soft.report.converged) << soft.report.reason;
  const auto force = [](const TestRun& run, std::size_t step) {
    for (const run::Forces::Of& effect : run.report.steps.at(step).forces)
      if (effect.path == "Crushable floor/floor")
        return effect.resultant.force[1];
    return 0.0;
  };
  EXPECT_GT(force(hard, 0), 2.0 * strength);
  EXPECT_NEAR(force(hard, 2), force(hard, 0), bound);
  // The edge is of length one; what gives way at one point relieves others, which may have given way too far.
  EXPECT_LE(force(soft, 0), (1.0 + CrushableFloor::accuracy) * strength + bound);
  EXPECT_GE(force(soft, 0), 0.99 * strength);
  EXPECT_NEAR(force(soft, 2), force(soft, 0), bound);
  EXPECT_EQ(soft.report.steps[1].closed, 0);
}

TEST(EffectStates, a_trial_that_fails_leaves_nothing_behind) {
  scene::Scene scene = overFloor(0.0, 0.05);
  const auto floor = std::make_shared<CrushableFloor>(0, "bottom", 1.0, 2.0);
  scene.effects = {floor};
  scene::ContactSetup contact;
  const Teuchos::MpiComm<int> alone(MPI_COMM_SELF);
  contact.points.resize(2);
  contact.pointCount = 2;
  contact.effects = {floor.get(), floor.get()};
  contact.rows.resize(2);
  for (std::size_t k = 0; k < 2; ++k) {
    contact.points[k].area = 1.0;
    contact.points[k].number = static_cast<long long>(k);
    contact.rows[k].kind = ConstraintRow::Kind::Inequality;
    contact.rows[k].number = static_cast<long long>(k);
    contact.rows[k].bound = 0.5;
  }
  run::EffectStates states(alone, scene, contact);
  ASSERT_TRUE(states.any());
  const std::vector<run::ContactState> answer = {{3.0, 3.0, 0.0, true}, {0.5, 0.5, 0.0, true}};
  states.begin();
  EXPECT_TRUE(states.update(answer));
  EXPECT_EQ(states.rows()[0].bound, 0.5 + 1.0); // (3 − 1)/2
  EXPECT_EQ(states.rows()[1].bound, 0.5);
  states.begin(); // the step failed
  EXPECT_EQ(states.rows()[0].bound, 0.5);
  EXPECT_TRUE(states.update(answer));
  states.commit();
  states.begin();
  EXPECT_EQ(states.rows()[0].bound, 1.5);

  // A checkpoint in the middle of the next step: both come back.
  EXPECT_TRUE(states.update(answer));
  EXPECT_EQ(states.rows()[0].bound, 2.5);
  Numbers archive;
  states.exchange(archive);
  archive.reads = true;
  run::EffectStates again(alone, scene, contact);
  again.exchange(archive);
  EXPECT_EQ(again.rows()[0].bound, 2.5);
  again.begin();
  EXPECT_EQ(again.rows()[0].bound, 1.5);
}

TEST(StepClock, halves_down_to_the_smallest_and_no_further) {
  const scene::Timeline timeline({1.0, 3.0}, 0.25);
  run::StepClock clock(timeline);
  EXPECT_EQ(clock.to(), 1.0);
  clock.accept();
  EXPECT_EQ(clock.step(), 2);
  EXPECT_TRUE(clock.halve());
  EXPECT_EQ(clock.to(), 2.0);
  EXPECT_TRUE(clock.halve());
  EXPECT_EQ(clock.to(), 1.5);
  EXPECT_FALSE(clock.halve());
  EXPECT_EQ(clock.to(), 1.5);
  std::vector<double> times;
  while (!clock.isOver()) {
    times.push_back(clock.to());
    EXPECT_EQ(clock.endsStep(), clock.to() == 3.0);
    Numbers archive;
    clock.exchange(archive);
    archive.reads = true;
    run::StepClock again(timeline);
    again.exchange(archive);
    EXPECT_EQ(again.to(), clock.to());
    EXPECT_EQ(again.from(), clock.from());
    clock.accept();
  }
  EXPECT_EQ(times, (std::vector<double>{1.5, 2.0, 2.5, 3.0}));
}

TEST(StepRow, rows_come_back_from_a_checkpoint) {
  run::StepRow row;
  row.step = 3;
  row.time = 0.1;
  row.converged = true;
  row.products = 7;
  row.activeSets = 2;
  row.energy = 1.0 / 3.0;
  row.externalWork = 0.7;
  row.dissipated = 0.8;
  row.released = 0.9;
  row.closed = 4;
  row.open = 5;
  row.sticking = 6;
  row.slipping = 7;
  row.broken = 8;
  row.forces = {{"Contact/a, b", {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}}};
  std::vector<run::StepRow> rows = {row}, again;
  Numbers archive;
  run::exchange(archive, rows, {"Contact/a, b"});
  archive.reads = true;
  run::exchange(archive, again, {"Contact/a, b"});
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(run::csvLine(again[0]), run::csvLine(row));
  EXPECT_EQ(again[0].forces[0].resultant.moment, row.forces[0].resultant.moment);
  EXPECT_EQ(run::toCsv(rows, {"Contact/a, b"}),
            "step,time,converged,products,active_sets,energy,external_work,dissipated,released,closed,open,"
            "sticking,slipping,broken,\"Contact/a, b/fx\",\"Contact/a, b/fy\",\"Contact/a, b/fz\"\n"
            "3,0.10000000000000001,1,7,2,0.33333333333333331,0.69999999999999996,0.80000000000000004,"
            "0.90000000000000002,4,5,6,7,8,1,2,3\n");
}

} // namespace test_step_sequence
