// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AdaptiveSpace.hpp"
#include "Harmos_DualOptions.hpp"
#include "Harmos_DualSolution.hpp"

#include <memory>
#include <string>
#include <vector>

namespace Harmos::feti {

class DualPreconditioner;

/// The stages between a torn system and the answer to its dual problem.
enum class PipelineStage {
  Constraints,
  Inverses,
  Coarse,
  Operators, ///< F, its preconditioner, and the space of adaptive vectors
  Problem,
  Solve ///< of that problem; see JudgedSolve
};

class DualPipeline;

/// Follows a pipeline, for a log and timers.
class PipelineObserver {
 public:
  virtual ~PipelineObserver() = default;
  /// What it returns lives while the stage is made.
  virtual std::shared_ptr<void> during(PipelineStage) { return nullptr; }
  /// The stage has been made. @note Collective.
  virtual void made(PipelineStage, const DualPipeline&) {}
};

/// How often each stage was made.
struct StageCounts {
  int constraints = 0, inverses = 0, coarse = 0, operators = 0, problem = 0;
  int decisions = 0; ///< of form, preconditioner and clusters
};

/// What the stages are known to, on all ranks.
struct StageAccuracy {
  double boundRounding = 0.0;          ///< ConstraintRow::rounding, the largest
  double condition = 1.0;              ///< LocalInverses::condition()
  double defect = 0.0;                 ///< LocalInverses::defect()
  long long roundedFactorizations = 0; ///< with products in single precision
};

/// What is known of a problem beside its matrices and rows.
struct ProblemTraits {
  double contrast = 1.0;            ///< of the stiffness of subdomains, the largest over the smallest
  bool hasSeveralMaterials = false; ///< within a subdomain or beside each other
  bool mayLump = false;             ///< FormLimits::mayLump
  int usualApplications = 0;        ///< of F, that the cost model expects
  double tolerance = 0.0;           ///< of all solves; 0: not known, and products are not rounded
};

/// The one owner of what lies between a torn system and its dual problem, and of what each change makes
/// stale:
///
///     SubdomainSystem → Constraints → LocalInverses → CoarseSpace → operators → DualProblem
///
///     change                        constraints  inverses               coarse, operators  problem
///     loads, prescribed, bounds     –            –                      –                  anew
///     rows                          anew         of other boundaries    anew               anew
///     matrices                      –            of other matrices      anew               anew
///     shape: matrices and rows      anew         of either              anew               anew
///     precision                     –            all                    operators          anew
///
/// The problem is made when it is asked for. Form, preconditioner and clusters are decided once, and again
/// where subdomains that shared a factorisation do not any more, or the other way round.
///
/// After an error in the midst of a change only system() and constraints() are there, until matrices or a
/// shape that succeed were set.
///
/// Guarded by tests/unit/feti/pipeline/test_dual_pipeline.cpp.
class DualPipeline {
 public:
  /// The stages up to the operators. @param rows this rank's share; see ConstraintRow. @param observer or
  /// null, to outlive this.
  /// @throws InputError, NumericalError on all ranks, with the subdomain and a remedy. @note Collective.
  DualPipeline(SubdomainSystem system, const std::vector<ConstraintRow>& rows, const DualOptions& options,
               const ProblemTraits& traits, const Log& log, PipelineObserver* observer = nullptr);
  ~DualPipeline();
  DualPipeline(const DualPipeline&) = delete;
  DualPipeline& operator=(const DualPipeline&) = delete;

  // Changes; all collective. See SubdomainSystem and Constraints for arguments and errors.
  void setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads);
  void setPrescribed(const std::vector<std::vector<double>>& values);
  /// @param rows those that are here, with other bounds, limits, softness and statuses.
  void setBounds(const std::vector<ConstraintRow>& rows);
  /// @param rows of any number and kind: contacts that come and go.
  void setRows(const std::vector<ConstraintRow>& rows);
  /// @param stiffness with the graphs of before, not to be changed in place. @param motions null pointers, or
  /// nothing: kernels as they were.
  void setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                   const std::vector<std::shared_ptr<const Kernel>>& motions = {});
  /// @param frames of matrices and kernels, see SubdomainSystem::setFrames().
  void setShape(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                const std::vector<std::shared_ptr<const Kernel>>& motions,
                std::vector<std::shared_ptr<const std::vector<double>>> loads,
                const std::vector<ConstraintRow>& rows, std::vector<std::optional<Frame>> frames = {});
  /// Products, and factors, in double precision from here on. @note Collective.
  void useDoublePrecision();

  /// Whether the last change succeeded.
  bool isComplete() const { return !made_.dual.is_null(); }
  /// As long as this lives.
  const SubdomainSystem& system() const { return *made_.system; }
  // What is made anew by changes. Whoever keeps one keeps all that it was made of; of inverses that were
  // factored anew it is that of the new matrices.
  Teuchos::RCP<const Constraints> constraints() const { return made_.constraints; }
  /// Those of other rows on the system as it is, for an audit; nothing here changes. To live as long as this.
  /// @throws InputError on all ranks, as setRows(). @note Collective.
  Teuchos::RCP<const Constraints> constraintsOf(const std::vector<ConstraintRow>& rows) const;
  // Once it is complete.
  Teuchos::RCP<const LocalInverses> inverses() const { return made_.inverses; }
  Teuchos::RCP<const CoarseSpace> coarse() const { return made_.coarse; }
  Teuchos::RCP<const DualOperator> dualOperator() const { return made_.dual; }
  /// Null before it was asked for, and after changes.
  Teuchos::RCP<const DualProblem> currentProblem() const { return made_.problem; }
  /// @throws NumericalError on all ranks for loads on a motion that nothing can hold; InputError for
  /// prescribed values that contradict each other or a row. @note Collective.
  const DualProblem& problem();
  /// All of them, with the problem, as problem().
  DualStages stages();
  /// Those of the matrices and rows that are here to other loads and bounds, with prescribed values of zero:
  /// how an answer changes. @note Collective.
  DualStages incrementStages(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                             const std::vector<ConstraintRow>& rows);
  /// A failure of this rank within a product is thrown on all ranks. @note Collective.
  void rethrowFailures() const;

  /// What was decided.
  const DualOptions::Decided& decided() const { return decided_; }
  PreconditionerScaling scaling() const;
  const StageAccuracy& accuracy() const { return accuracy_; }
  const StageCounts& counts() const { return counts_; }
  /// PipelineObserver::during(), null without one.
  std::shared_ptr<void> during(PipelineStage stage) const;
  /// What this rank spent on factors so far.
  FactorizationCounts factorizations() const;

 private:
  using Factored = std::vector<std::pair<const LocalMatrix*, const Kernel*>>;
  void tell(PipelineStage stage) const;
  void constrain(const std::vector<ConstraintRow>& rows);
  void decide();
  void makeInverses();
  void renewInverses(const Factored& before);
  void measureInverses();
  void makeCoarse();
  void makeOperators();
  void forgetOperators();
  Factored factored() const;
  bool haveClassesChanged() const;

  struct Stages {
    Teuchos::RCP<SubdomainSystem> system;
    Teuchos::RCP<Constraints> constraints;
    Teuchos::RCP<LocalInverses> inverses;
    Teuchos::RCP<const CoarseSpace> coarse;
    Teuchos::RCP<const DualPreconditioner> preconditioner; // or null
    Teuchos::RCP<const DualOperator> dual;
    Teuchos::RCP<AdaptiveSpace> adaptive;
    Teuchos::RCP<const DualProblem> problem;
  };

  DualOptions options_;
  ProblemTraits traits_;
  Log log_;
  PipelineObserver* observer_;
  DualOptions::Decided decided_ = {};
  ClusterOptions clusters_; // the same
  Stages made_;
  StageAccuracy accuracy_;
  bool areBoundsStale_ = false; // by prescribed values, of which they have a share
  FactorizationCounts spent_;   // on inverses that are no more
  StageCounts counts_;
};

} // namespace Harmos::feti
