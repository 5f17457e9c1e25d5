// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DeformedBodies.hpp"
#include "Harmos_IncrementSolver.hpp"
#include "Harmos_Motion.hpp"
#include "Harmos_MovedBonds.hpp"
#include "Harmos_RunContext.hpp"
#include "Harmos_RunDirectory.hpp"
#include "Harmos_RunMonitor.hpp"
#include "Harmos_Solution.hpp"
#include "Harmos_TimedLoads.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

/// The stages of one run, in their order. Each makes a value from those of the stages before, which is then
/// left alone; is timed; and tells the log and the report what came of it.
///
///     decompose() → assemble() → makePipeline() → solve() → recover() → write()
///
/// What lies between the torn system and the dual problem is feti::DualPipeline's, which this observes.
///
/// A run of several steps (StepSequence) goes through the first ones once, and for each step from prepare(),
/// which brings new loads and bounds to what is there, to write().
///
/// All members are collective; they throw what run::runScene() throws, on all ranks.
class RunStages : private feti::PipelineObserver {
 public:
  /// Names for the timers.
  static const std::vector<std::string>& names();

  explicit RunStages(const RunContext& context);
  ~RunStages() override;

  /// All of them, once: a static state.
  Solution goOnce();

  /// From the meshes to the dual problem of the first step. @param motion of a transient run, to outlive
  /// this.
  void setUp(Motion* motion = nullptr);
  /// Loads, prescribed values and bounds of another time, by subdomain and row as the system and the
  /// constraints take them; the dual problem is made anew.
  struct Data {
    double time;
    std::vector<std::shared_ptr<const std::vector<double>>> loads;
    const std::vector<std::vector<double>>* prescribed; ///< null: as they were
    const std::vector<ConstraintRow>* rows;             ///< null: as they were
  };
  void prepare(const Data& data);
  /// Whether prescribed values of some time can be met; prepare() has to follow.
  /// @throws InputError on all ranks if they contradict each other or a row that holds nothing else.
  void checkBounds(const std::vector<std::vector<double>>& prescribed);
  /// Of finite displacements: the problem of a Newton iteration, of how they change.
  struct Iterate {
    double time;
    DeformedBodies::Tangent tangent;
    std::vector<std::optional<feti::Frame>> frames;                ///< of it
    std::vector<std::shared_ptr<const std::vector<double>>> loads; ///< less internal forces
    std::vector<std::vector<double>> prescribed;
    scene::ContactSetup contact;
    std::vector<double> slipsBefore; ///< of limited rows, when the step began; none: zeros
  };
  void prepare(Iterate iterate);
  /// And the equilibrium that it came to, in the place of recover(): contact states, reactions and forces
  /// follow, the audit is given.
  struct Equilibrium {
    feti::TornSolution change; ///< the last one, in the frames, with its multiplier
    feti::TornVector displacement;
    std::vector<std::shared_ptr<const std::vector<double>>> loads;
    std::vector<std::vector<double>> reactions; ///< of prescribed values
    feti::KktAudit audit;
    const DeformedBodies::States* states; ///< of materials
  };
  void take(Equilibrium equilibrium);
  /// Contact states of what adhesion binds, or has bound, in that equilibrium.
  void tellBonds(MovedBonds& bonds) { bonds.tell(contact_, context_.report.slips, context_.report.contact); }
  /// Solves from a start, or from the options' own (null). @param log for what is told of the solution.
  /// @param secondsSpent by solutions before, which the limit of the options counts too. @param tolerance
  /// fixed one in the place of the options'.
  void solve(const feti::WarmStart* start, const Teuchos::RCP<RunMonitor>& monitor, const Log& log,
             double secondsSpent, double tolerance);
  /// The solution on the primal side, judged, and its contact states and forces.
  void recover();
  /// The fields, to a file of the output directory.
  void writeFields(const std::string& file);
  /// What the log says of the last solution.
  void tellResult() const;
  /// Counts numerical factorisations so far into the report.
  void countFactorisations();
  /// How the last answer changes. @note Collective.
  feti::IncrementSolver::Increment increment(const feti::IncrementSolver::Task& task);
  /// The solution, of which this keeps nothing.
  Solution hand();

  // What there is, once it has been set up, and after a solution.
  const std::vector<scene::OwnedSubdomain>& owned() const { return owned_; }
  const scene::ContactSetup& contact() const { return contact_; }
  /// Of a run with several steps.
  const scene::TimedLoads& loads() const { return *loads_; }
  /// @note Collective after checkBounds().
  const feti::DualProblem& dualProblem() const { return pipeline_->problem(); }
  const feti::DualSolution& dualSolution() const { return solve_->solution(); }
  const feti::TornSolution& torn() const { return torn_; }
  const std::vector<std::vector<double>>& reactions() const { return reactions_; }
  /// λ of the rows of contact(), as they were given. @note Collective.
  std::vector<double> multipliers() const {
    return pipeline_->constraints()->givenMultipliers(*torn_.multiplier);
  }
  feti::DualPipeline& pipeline() { return *pipeline_; }
  const RunDirectory& directory() const { return directory_; }
  /// A monitor of the next solution. @param checkpoint that it goes on from, or null.
  Teuchos::RCP<RunMonitor> monitor(const CheckpointReader* checkpoint, const Log& log, SolvePlace place);

 private:
  void announce();
  void decompose();
  feti::SubdomainSystem assemble();
  void makePipeline();
  feti::DualOptions dualOptions() const;
  feti::ProblemTraits traits() const;
  std::shared_ptr<void> during(feti::PipelineStage stage) override;
  void made(feti::PipelineStage stage, const feti::DualPipeline& pipeline) override;
  void tellConstraints(const feti::DualPipeline& pipeline);
  void tellInverses(const feti::DualPipeline& pipeline);
  void tellFactors(const feti::DualPipeline& pipeline);
  void tellCoarse(const feti::DualPipeline& pipeline);
  feti::AnswerCriteria criteria() const;
  void write();

  void tellContact(const feti::TornSolution& solution);
  void tellForces(const feti::TornSolution& solution,
                  const std::vector<std::shared_ptr<const std::vector<double>>>* loads);
  void tellWhatIsAttainable();
  void leaveInterrupted();
  StepRow onlyStep();
  std::optional<QuantityValue> quantity();
  void judgeDrift();
  std::string escapingBodies() const;
  bool isElastic() const { return context_.scene.physics != scene::Physics::Membrane; }

  RunContext context_;
  RunDirectory directory_;

  // What the stages make.
  scene::EffectCosts costs_;
  std::vector<scene::OwnedSubdomain> owned_;
  std::optional<scene::TimedLoads> loads_; // where there are several steps
  scene::ContactSetup contact_;
  std::unique_ptr<feti::DualPipeline> pipeline_;
  std::optional<feti::JudgedSolve> solve_; // the last one
  std::optional<feti::IncrementSolver> increments_;
  feti::TornSolution torn_;
  std::vector<std::vector<double>> reactions_; // of prescribed values
  DeformedBodies::States materials_;           // their states, of those that have any
  std::vector<double> slipsBefore_;            // of limited rows, when the step began; none: zeros
  double time_;                                // of loads and bounds
  Motion* motion_ = nullptr;
};

} // namespace Harmos::run
