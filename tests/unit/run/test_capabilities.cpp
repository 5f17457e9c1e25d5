// SPDX-License-Identifier: BSD-3-Clause

/// What a deck can ask for and what an embedding application can, by the same tests: each runs once through
/// run::runScene() with a deck's options, and once through feti::FetiSolver with the scene's matrices.

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_MemoryArchive.hpp"
#include "Harmos_RandomScene.hpp"
#include "Harmos_RunStages.hpp"
#include "Harmos_StressRecovery.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace test_capabilities {

using namespace Harmos;
using Settings = std::vector<std::string>;

namespace {

struct Answer {
  feti::SolveReport report;
  feti::AnswerQuality quality;
  long long clusters = 0;
  bool isSingle = false;
  feti::TornVector displacement;
};

// A way to an answer.
class Client {
 public:
  virtual ~Client() = default;
  virtual std::string name() const = 0;
  virtual Answer solve(const scene::Scene& scene, double tolerance, const Settings& settings) const = 0;
  /// Interrupted after the first step, and then by another solver to the end.
  virtual Answer solveTwice(const scene::Scene& scene, double tolerance, const Settings& settings) const = 0;
  /// By how much displacements change with loads that grow by this share, where all contacts stay closed.
  virtual feti::TornVector change(const scene::Scene& scene, double tolerance, double share) const = 0;
};

std::vector<std::shared_ptr<const std::vector<double>>>
loadsOf(const std::vector<feti::Subdomain>& subdomains, double factor) {
  std::vector<std::shared_ptr<const std::vector<double>>> result;
  for (const feti::Subdomain& subdomain : subdomains) {
    std::vector<double> load = *subdomain.load;
    for (double& value : load)
      value *= factor;
    result.push_back(std::make_shared<const std::vector<double>>(load));
  }
  return result;
}

// Of a linear problem: contacts stay closed, gaps do not change.
feti::IncrementSolver::Task taskOf(const std::vector<feti::Subdomain>& subdomains,
                                   std::vector<ConstraintRow> rows, double tolerance, double share) {
  for (ConstraintRow& row : rows) {
    row.bound = 0.0;
    if (row.kind == ConstraintRow::Kind::Inequality)
      row.status = ConstraintRow::Status::Closed;
  }
  return {loadsOf(subdomains, share), std::move(rows), tolerance};
}

class DeckClient : public Client {
 public:
  std::string name() const override { return "deck"; }
  Answer solve(const scene::Scene& scene, double tolerance, const Settings& settings) const override {
    return run(scene, testOptions(tolerance, settings));
  }
  Answer solveTwice(const scene::Scene& scene, double tolerance, const Settings& settings) const override {
    run::RunOptions options = testOptions(tolerance, settings);
    options.outputDirectory += "_restart";
    options.checkpoint.told = [] { return run::Told::Stop; };
    const Answer first = run(scene, options);
    EXPECT_EQ(first.report.result.reason, qp::Reason::Interrupted);
    options.checkpoint.told = nullptr;
    options.checkpoint.restart = options.outputDirectory;
    return run(scene, options);
  }
  feti::TornVector change(const scene::Scene& scene, double tolerance, double share) const override {
    const run::RunOptions options = testOptions(tolerance);
    const StageTimers timers(run::RunStages::names());
    const Log log;
    run::RunReport report;
    run::RankShare ofRank;
    run::RunStages stages({testComm(), scene, options, log, timers, report, ofRank});
    stages.setUp();
    stages.solve(nullptr, stages.monitor(nullptr, log, {}), log, 0.0, tolerance);
    stages.recover();
    EXPECT_TRUE(report.converged) << report.reason;
    const auto increment = stages.increment(
        taskOf(scene::assemble(scene, stages.owned()), stages.contact().rows, tolerance, share));
    EXPECT_TRUE(increment.report.converged) << increment.report.reason;
    return increment.displacement;
  }

 private:
  static Answer run(const scene::Scene& scene, const run::RunOptions& options) {
    run::RunReport report;
    run::Solution solution =
        run::runScene(testComm(), scene, options, Log(), std::chrono::steady_clock::now(), report);
    return {report, report, report.clusters, report.isSingle, std::move(solution.displacement)};
  }
};

// Keeps the state before each step, or goes on from one; may interrupt.
class Memory : public feti::DualMonitor {
 public:
  explicit Memory(std::optional<MemoryState<MultiVector>> state = std::nullopt) : state_(std::move(state)) {}
  const std::optional<MemoryState<MultiVector>>& state() const { return state_; }
  void begins(const feti::DualRun&) override {}
  void recorded(const qp::IterationRecord&) override {}
  Wish ask(const qp::IterationState<MultiVector>&) override {
    return isResumed_ ? Wish::GoOn : Wish::SaveAndStop;
  }
  void save(const Exchange& exchange) override {
    state_.emplace();
    MemoryArchive<MultiVector> archive(*state_, false);
    exchange(archive);
  }
  bool hasState() const override { return isResumed_; }
  bool holds(const std::string& name) const override { return state_->numbers.count(name) > 0; }
  void restore(const Exchange& exchange) override {
    MemoryArchive<MultiVector> archive(*state_, true);
    exchange(archive);
  }

 private:
  std::optional<MemoryState<MultiVector>> state_;
  bool isResumed_ = state_.has_value();
};

class SolverClient : public Client {
 public:
  std::string name() const override { return "FetiSolver"; }
  Answer solve(const scene::Scene& scene, double tolerance, const Settings& settings) const override {
    const Problem problem(scene);
    return problem.answer(*problem.solver(tolerance, settings));
  }
  Answer solveTwice(const scene::Scene& scene, double tolerance, const Settings& settings) const override {
    const Problem problem(scene);
    const auto first = Teuchos::rcp(new Memory);
    const auto interrupted = problem.solver(tolerance, settings);
    interrupted->setMonitor(first);
    EXPECT_EQ(interrupted->solve().result.reason, qp::Reason::Interrupted);
    const auto resumed = problem.solver(tolerance, settings);
    resumed->setMonitor(Teuchos::rcp(new Memory(first->state())));
    return problem.answer(*resumed);
  }
  feti::TornVector change(const scene::Scene& scene, double tolerance, double share) const override {
    const Problem problem(scene);
    const auto solver = problem.solver(tolerance, {});
    EXPECT_TRUE(solver->solve().converged) << solver->report().reason;
    const feti::IncrementSolver::Task task =
        taskOf(problem.subdomains, problem.contact.rows, tolerance, share);
    const feti::FetiSolver::Increment increment = solver->solveIncrement(task.loads, task.rows, tolerance);
    EXPECT_TRUE(increment.report.converged) << increment.report.reason;
    return increment.displacement;
  }

 private:
  // A scene as an application of its own would hand it over.
  struct Problem {
    explicit Problem(const scene::Scene& ofScene)
        : scene(ofScene),
          owned(scene::decompose(*testComm(), scene)),
          subdomains(scene::assemble(scene, owned)),
          contact(scene::setUpContact(*testComm(), scene, owned)) {}

    std::unique_ptr<feti::FetiSolver> solver(double tolerance, const Settings& settings) const {
      const ParameterSpec spec = feti::FetiSolver::parameters();
      Teuchos::ParameterList list = spec.defaults();
      for (const std::string& setting : settings) {
        const std::size_t sign = setting.find('=');
        spec.set(list, setting.substr(0, sign), setting.substr(sign + 1), "test");
      }
      list.sublist("Solver").set("Tolerance", tolerance).set("Progress frequency", 0);
      auto result = std::make_unique<feti::FetiSolver>(testComm(), subdomains, contact.rows, list);
      feti::AnswerCriteria criteria;
      criteria.estimate = [this](const feti::TornVector& displacement) {
        return run::estimateDiscretisationError(*testComm(), scene, owned, displacement,
                                                scene.timeline.ends().front());
      };
      criteria.groups = {"contact"};
      criteria.groupOf.assign(contact.rows.size(), 0);
      result->judgeBy(criteria);
      return result;
    }
    Answer answer(feti::FetiSolver& solver) const {
      const feti::SolveReport& report = solver.solve();
      return {report, solver.quality(), solver.pipeline().decided().clusters(),
              solver.pipeline().decided().isSingle(),
              solver.hasSolution() ? solver.displacement() : feti::TornVector()};
    }

    const scene::Scene& scene;
    std::vector<scene::OwnedSubdomain> owned;
    std::vector<feti::Subdomain> subdomains;
    scene::ContactSetup contact;
  };
};

const std::vector<std::shared_ptr<const Client>>& clients() {
  static const std::vector<std::shared_ptr<const Client>> result = {std::make_shared<DeckClient>(),
                                                                    std::make_shared<SolverClient>()};
  return result;
}

// A block pressed onto another, both clamped at the far side; contact closes in part.
scene::Scene pressed(double modulus = 10.0) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {4, 4, 1};
  options.elements = {4, 4, 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin = {0.0, 1.0, 0.0};
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(modulus, 0.3)));
  for (int c : {0, 1})
    prescribe(scene, {0, "bottom"}, c);
  prescribe(scene, {1, "left"}, 0);
  prescribe(scene, {1, "left"}, 1);
  addTraction(scene, {1, "top"}, {0.0, -0.02, 0.0});
  addContact(scene, {0, "top"}, {1, "bottom"}, 0.002);
  return scene;
}

// A block pressed onto another evenly, without a gap.
scene::Scene stacked() {
  scene::Scene scene = pressed();
  removeEffects(scene, "Contact");
  removeEffects(scene, "Prescribed displacement");
  for (int c : {0, 1})
    prescribe(scene, {0, "bottom"}, c);
  prescribe(scene, {1, "left"}, 0);
  addContact(scene, {0, "top"}, {1, "bottom"});
  return scene;
}

double largest(const feti::TornVector& u) {
  double result = 0.0;
  for (const std::vector<double>& part : u)
    for (double value : part)
      result = std::max(result, std::abs(value));
  return globalMax(*testComm(), result);
}

feti::TornVector sum(double a, const feti::TornVector& x, double b, const feti::TornVector& y) {
  feti::TornVector result = x;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < x[i].size(); ++k)
      result[i][k] = a * x[i][k] + b * y[i][k];
  return result;
}

} // namespace

TEST(Capabilities, clusters) {
  const scene::Scene scene = pressed();
  for (const auto& client : clients()) {
    const Answer alone = client->solve(scene, 1e-9, {"Decomposition/Clusters=none"}),
                 joined = client->solve(scene, 1e-9, {"Decomposition/Clusters=4"});
    ASSERT_TRUE(alone.report.converged && joined.report.converged) << client->name();
    EXPECT_EQ(alone.clusters, 0) << client->name();
    EXPECT_GE(joined.clusters, 8) << client->name(); // 32 subdomains
    // Ten tolerances of each.
    EXPECT_NEAR(joined.quality.audit.energy / alone.quality.audit.energy, 1.0, 2e-8) << client->name();
  }
}

TEST(Capabilities, adaptive_vectors) {
  const scene::Scene scene = pressed();
  for (const auto& client : clients()) {
    const std::string expert = "Dual operator/Expert/Adaptive ";
    const Answer none = client->solve(scene, 1e-9, {expert + "coarse vectors=none"}),
                 all = client->solve(scene, 1e-9, {expert + "coarse vectors=all", expert + "threshold=2"});
    ASSERT_TRUE(none.report.converged && all.report.converged) << client->name();
    EXPECT_EQ(none.report.adaptiveVectors, 0) << client->name();
    EXPECT_GT(all.report.adaptiveVectors, 0) << client->name();
    EXPECT_NEAR(all.quality.audit.energy / none.quality.audit.energy, 1.0, 2e-8) << client->name();
  }
}

// The solver goes on in double precision from where it has come to.
TEST(Capabilities, recovery_from_single_precision) {
  const RandomScene drawn = randomScene(127u); // materials that jump; dense blocks
  Settings settings = drawn.settings;
  for (const auto& client : clients()) {
    for (std::string& setting : settings)
      if (setting.rfind("Dual operator/Precision=", 0) == 0)
        setting = "Dual operator/Precision=double";
    const Answer exact = client->solve(drawn.scene, drawn.tolerance, settings);
    ASSERT_TRUE(exact.report.converged) << client->name();
    for (std::string& setting : settings)
      if (setting.rfind("Dual operator/Precision=", 0) == 0)
        setting = "Dual operator/Precision=single";
    const Answer single = client->solve(drawn.scene, drawn.tolerance, settings);
    EXPECT_TRUE(single.report.converged) << client->name() << ": " << single.report.reason;
    EXPECT_TRUE(feti::auditAgrees(single.quality)) << client->name();
    EXPECT_FALSE(single.isSingle) << client->name();
    EXPECT_NEAR(single.quality.audit.energy / exact.quality.audit.energy, 1.0, 20.0 * drawn.tolerance)
        << client->name();
  }
}

// The solver's error, by the energy that it lacks of the exact one, is below its share of the other.
TEST(Capabilities, balanced_tolerance) {
  const scene::Scene scene = pressed();
  for (const auto& client : clients()) {
    const Answer exact = client->solve(scene, 1e-11, {}),
                 balanced = client->solve(scene, 1e-4, {"Solver/Tolerance rule=balanced"});
    ASSERT_TRUE(exact.report.converged && balanced.report.converged) << client->name();
    const feti::AnswerQuality& quality = balanced.quality;
    const double missing = std::sqrt(2.0 * std::max(0.0, exact.quality.audit.energy - quality.audit.energy));
    EXPECT_GT(quality.discretisationError, 0.01) << client->name();
    EXPECT_LE(missing, 1.001 * quality.solverError) << client->name();
    EXPECT_LE(quality.solverError, 0.33 * quality.discretisationError * quality.audit.energyNorm)
        << client->name();
    EXPECT_GT(quality.tolerance, 1e-6) << client->name();
    EXPECT_LT(balanced.report.result.counters.hessianApplications,
              exact.report.result.counters.hessianApplications)
        << client->name();
  }
}

// A small contact beside a large load: its forces are as accurate as all else, by an answer to 1e-12.
TEST(Capabilities, forces_of_small_contacts) {
  scene::Scene scene = stacked();
  addTraction(scene, {0, "left"}, {-0.5, 0.0, 0.0});
  addTraction(scene, {0, "right"}, {0.5, 0.0, 0.0});
  for (const auto& client : clients()) {
    const Answer loose = client->solve(scene, 1e-3, {});
    ASSERT_TRUE(loose.report.converged) << client->name();
    ASSERT_EQ(loose.quality.pairErrors.size(), 1u) << client->name();
    const feti::PairError& pair = loose.quality.pairErrors.front();
    EXPECT_LT(pair.force, 0.1 * loose.quality.audit.forces) << client->name();
    EXPECT_LE(pair.error, feti::allowedForceError(loose.quality, pair)) << client->name();
    EXPECT_LT(loose.quality.reachedTolerance, 0.9e-3) << client->name();
  }
}

// To the last bit, and with the products of a run that was not interrupted.
TEST(Capabilities, restart) {
  const scene::Scene scene = pressed();
  for (const auto& client : clients())
    for (const char* method : {"PDAS", "SMALBE"}) {
      const Settings settings = {std::string("Solver/Method=") + method};
      const Answer whole = client->solve(scene, 1e-8, settings),
                   twice = client->solveTwice(scene, 1e-8, settings);
      ASSERT_TRUE(whole.report.converged && twice.report.converged) << client->name() << " " << method;
      EXPECT_EQ(twice.displacement, whole.displacement) << client->name() << " " << method;
      EXPECT_EQ(twice.report.result.counters.hessianApplications,
                whole.report.result.counters.hessianApplications)
          << client->name() << " " << method;
    }
}

// Where all contacts are closed and stay so the answer is linear in the load.
TEST(Capabilities, increments) {
  constexpr double tolerance = 1e-10, share = 0.5;
  const scene::Scene scene = stacked();
  for (const auto& client : clients()) {
    const Answer at = client->solve(scene, tolerance, {});
    ASSERT_TRUE(at.report.converged) << client->name();
    const feti::TornVector change = client->change(scene, tolerance, share);
    // u(f) is linear: a change of the load by a share changes it by that share.
    EXPECT_LE(largest(sum(1.0, change, -share, at.displacement)), 1e3 * tolerance * largest(at.displacement))
        << client->name();
  }
}

} // namespace test_capabilities
