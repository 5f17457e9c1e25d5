// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerCheck.hpp"
#include "Harmos_CoarseSpace.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_RankTable.hpp"
#include "Harmos_RunDirectory.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Solution.hpp"
#include "Harmos_StageTimers.hpp"

#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

/// The stages of one run, in their order. Each makes a value from those of the stages before, which is then
/// left alone; is timed; and tells the log and the report what came of it.
///
///     decompose() → assemble() → constrain() → factorise() → makeDualProblem() → solve() → recover() →
///     write()
///
/// All members are collective; they throw what run::runScene() throws, on all ranks.
class RunStages {
 public:
  /// Names for the timers.
  static const std::vector<std::string>& names();

  /// All to outlive this. @param report, share are filled as far as the run gets.
  RunStages(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
            const RunOptions& options, const Log& log, const StageTimers& timers, RunReport& report,
            RankShare& share);

  /// All of them, once.
  Solution go();

 private:
  void announce();
  void decompose();
  void assemble();
  void constrain();
  void factorise();
  void makeDualProblem();
  void solve();
  void recover();
  void write();

  void sayConstraints();
  void sayCoarse() const;
  void askSolver();
  void leaveInterrupted();
  void judgeAudit();
  void writeFields();
  std::string escapingBodies() const;
  bool isElastic() const { return scene_.physics != scene::Physics::Membrane; }
  // The penalty method leaves jumps by design, and says so.
  bool leavesJumps() const { return report_.solver == "Dual Penalty"; }

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  const scene::Scene& scene_;
  const RunOptions& options_;
  const Log& log_;
  const StageTimers& timers_;
  RunReport& report_;
  RankShare& share_;
  RunDirectory directory_;

  // What the stages make.
  scene::EffectCosts costs_;
  std::vector<scene::OwnedSubdomain> owned_;
  std::optional<feti::SubdomainSystem> system_;
  scene::ContactSetup contact_;
  std::optional<feti::Constraints> constraints_;
  std::optional<feti::LocalInverses> inverses_;
  std::optional<feti::DualOperator> dualOperator_;
  Teuchos::RCP<const feti::DualPreconditioner> preconditioner_; // or null
  std::optional<feti::CoarseSpace> coarse_;
  std::optional<feti::DualProblem> dual_;
  std::optional<feti::DualStages> dualStages_; // the last six together
  std::optional<AnswerCheck> check_;
  feti::DualSolution solution_;
  feti::TornSolution torn_;
};

} // namespace Harmos::run
