// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualSolution.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Harmos::feti {
namespace {

using StatusTestType = qp::StatusTest<MultiVector>;

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

// Of a vector that every rank has whole; empty for null.
std::vector<double> valuesOf(const Teuchos::RCP<const MultiVector>& vector) {
  std::vector<double> values;
  if (vector.is_null())
    return values;
  const auto view = vector->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t k = 0; k < view.extent(0); ++k)
    values.push_back(view(k, 0));
  return values;
}

// What PDAS needs of G on faces, by the structure of the coarse space.
class CoarseFaceGram : public qp::FaceGramMaker<MultiVector> {
 public:
  explicit CoarseFaceGram(const CoarseSpace& coarse) : coarse_(coarse) {}

  Teuchos::RCP<const qp::FaceGram> build(const MultiVector& free) const override {
    return Teuchos::rcp(new Face(coarse_, free));
  }

 private:
  class Face : public qp::FaceGram {
   public:
    Face(const CoarseSpace& coarse, const MultiVector& free)
        : coarse_(coarse), factor_(coarse.faceFactor(free)) {}
    std::vector<double> solve(const std::vector<double>& r) const override {
      return coarse_.solveOnFace(factor_, r);
    }

   private:
    const CoarseSpace& coarse_;
    CoarseFactor factor_;
  };

  const CoarseSpace& coarse_;
};

// The convergence test of the stopping rule; the scales go to the report.
struct Test {
  Teuchos::RCP<StatusTestType> test;
  Teuchos::RCP<qp::StatusTestProjectedGradient<MultiVector>> gradient;
  Teuchos::RCP<qp::StatusTestEqualityResidual<MultiVector>> equality;
};

Test convergenceTest(const DualProblem& dual, const SolverOptions& options, double tolerance,
                     bool judgeEquality, SolveReport& report) {
  report.dNorm = norm(dual.d());
  report.gradientScale = options.stoppingRule == StoppingRule::Paper ? report.dNorm : norm(*dual.rhs());
  Test result;
  result.gradient =
      Teuchos::rcp(new qp::StatusTestProjectedGradient<MultiVector>(tolerance, report.gradientScale));
  std::vector<Teuchos::RCP<StatusTestType>> tests = {result.gradient};
  if (!dual.equalityRows().is_null()) {
    using EqualityTest = qp::StatusTestEqualityResidual<MultiVector>;
    switch (options.stoppingRule) {
    case StoppingRule::Scaled:
      report.equalityScale = norm(*dual.shift());
      result.equality = Teuchos::rcp(new EqualityTest(tolerance, report.equalityScale, dual.shift()));
      break;
    case StoppingRule::Paper:
      report.equalityScale = dual.scaledLoadNorm();
      result.equality = Teuchos::rcp(new EqualityTest(tolerance, report.equalityScale));
      break;
    case StoppingRule::Permon:
      report.equalityScale = norm(*dual.rhs());
      result.equality = Teuchos::rcp(new EqualityTest(tolerance, report.equalityScale));
      break;
    }
    if (judgeEquality)
      tests.push_back(result.equality);
  }
  result.test = Teuchos::rcp(
      new qp::StatusTestCombo<MultiVector>(qp::StatusTestCombo<MultiVector>::Type::Sequence, tests));
  return result;
}

// Adds to what the solver knows the tolerance that an acceptance has come to.
class MonitorWithTolerance : public qp::SolverMonitor<MultiVector> {
 public:
  MonitorWithTolerance(const Teuchos::RCP<DualMonitor>& monitor, double asked, double& tolerance)
      : monitor_(monitor), asked_(asked), tolerance_(tolerance) {}

  // A run that asks for another tolerance begins with that.
  void exchange(Archive& archive) {
    double asked = asked_, tolerance = tolerance_;
    archive.number("tolerance asked", asked);
    archive.number("tolerance", tolerance);
    if (asked == asked_)
      tolerance_ = tolerance;
  }

  void recorded(const qp::IterationRecord& record) override { monitor_->recorded(record); }
  Wish ask(const qp::IterationState<MultiVector>& state) override { return monitor_->ask(state); }
  void save(const Exchange& state) override {
    monitor_->save([&](Archive& archive) {
      exchange(archive);
      state(archive);
    });
  }
  bool hasState() const override { return monitor_->hasState(); }
  bool holds(const std::string& name) const override { return monitor_->holds(name); }
  void restore(const Exchange& state) override { monitor_->restore(state); }

 private:
  Teuchos::RCP<DualMonitor> monitor_;
  double asked_;
  double& tolerance_;
};

} // namespace

DualSolution solveDualProblem(const DualStages& stages, const SolverOptions& options, const WarmStart* start,
                              const Acceptance& acceptance, const Log& log, SolveReport& report,
                              const Teuchos::RCP<DualMonitor>& monitor) {
  const SubdomainSystem& system = stages.system;
  const Constraints& constraints = stages.constraints;
  const CoarseSpace& coarse = stages.coarse;
  const DualProblem& dual = stages.problem;
  DualSolution solution;
  solution.lambda = Teuchos::rcp(new MultiVector(constraints.rowMap(), 1));
  if (start != nullptr) {
    Tpetra::deep_copy(*solution.lambda, *start->multiplier);
    solution.lambda->update(-1.0, *dual.shift(), 1.0);
    coarse.project(*solution.lambda);
    // Open contacts stay at their bounds to the last bit, or active sets would begin without them.
    if (!dual.lowerBound().is_null()) {
      const auto total = start->multiplier->getLocalViewHost(Tpetra::Access::ReadOnly);
      const auto lower = dual.lowerBound()->getLocalViewHost(Tpetra::Access::ReadOnly);
      const auto lambda = solution.lambda->getLocalViewHost(Tpetra::Access::ReadWrite);
      for (std::size_t k = 0; k < total.extent(0); ++k)
        if (total(k, 0) == 0.0 && std::isfinite(lower(k, 0)))
          lambda(k, 0) = lower(k, 0);
    }
  } else if (options.initialGuess == InitialGuess::HalfLoad) {
    std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
    for (int i = 0; i < system.size(); ++i)
      constraints.addB(i, system.rhs(i).data(), overlap.data());
    constraints.fromOverlap(overlap, *solution.lambda);
    solution.lambda->scale(0.5);
  }

  const auto problem = Teuchos::rcp(new qp::TpetraProblem(dual.hessian(), solution.lambda, dual.rhs()));
  problem->setLowerBound(dual.lowerBound());
  Teuchos::RCP<MultiVector> multiplier;
  if (!dual.equalityRows().is_null()) {
    multiplier = Teuchos::rcp(new MultiVector(coarse.coarseMap(), 1));
    if (start != nullptr && start->mu.size() == multiplier->getLocalLength()) {
      const auto view = multiplier->getLocalViewHost(Tpetra::Access::OverwriteAll);
      std::copy(start->mu.begin(), start->mu.end(), view.data());
    }
    const auto zero = Teuchos::rcp(new MultiVector(coarse.coarseMap(), 1));
    problem->setEquality(dual.equalityRows(), zero, multiplier, qp::EqualityStructure::OrthonormalInvariant);
    problem->setHessianOnKernel(dual.hessianOnKernel());
    problem->setFaceGram(Teuchos::rcp(new CoarseFaceGram(coarse)));
  }
  if (!stages.preconditioner.is_null())
    problem->setPreconditioner(stages.preconditioner);
  if (!problem->setProblem())
    throw NumericalError("the dual problem cannot be solved: " + problem->whyNotSet());

  using Auto = qp::AutoSolver<Scalar, MultiVector, Operator>;
  const std::string method = options.method == "Auto" ? Auto::choice(*problem) : options.method;
  const auto list = Teuchos::parameterList();
  list->set("Maximum Iterations", options.maximumIterations);
  list->set("Maximum Seconds", options.maximumSeconds);
  list->set("Output Frequency", options.progressFrequency);
  // A solver takes the lists it has a use for; all of them were validated with the deck.
  if (method != "PCPG")
    list->sublist("MPRGP") = options.methodLists.sublist("MPRGP");
  if (method == "SMALBE" || method == "PDAS")
    list->sublist("SMALBE") = options.methodLists.sublist("SMALBE");
  if (method == "PCPG" || method == "PDAS")
    list->sublist("PCPG") = options.methodLists.sublist("PCPG");
  if (method == "Dual Penalty" || method == "PDAS")
    list->sublist(method) = options.methodLists.sublist(method);
  const auto solver = qp::TpetraSolverFactory().create(method, list);
  report.solver = solver->name();
  const bool isPenalty = method == "Dual Penalty";
  double tolerance = options.tolerance;
  const Test test = convergenceTest(dual, options, tolerance, !isPenalty, report);
  solver->setConvergenceTest(test.test);
  if (acceptance && !isPenalty)
    solver->setAcceptance([&] {
      // The tolerance that these residuals would just meet.
      double met = tolerance * test.gradient->value() / test.gradient->limit();
      if (!test.equality.is_null())
        met = std::max(met, tolerance * test.equality->value() / test.equality->limit());
      const std::optional<double> next =
          acceptance(*solution.lambda, valuesOf(multiplier), std::isfinite(met) ? met : tolerance);
      if (!next)
        return true;
      tolerance = *next;
      test.gradient->setTolerance(tolerance);
      if (!test.equality.is_null())
        test.equality->setTolerance(tolerance);
      return false;
    });
  MonitorWithTolerance watched(monitor, options.tolerance, tolerance);
  if (!monitor.is_null()) {
    monitor->begins({stages, method, [&] {
                       // What the tests last measured against.
                       DualTargets targets{tolerance * report.gradientScale, 0.0};
                       if (!test.equality.is_null())
                         targets.equality = tolerance * test.equality->scale();
                       return targets;
                     }});
    solver->setMonitor(Teuchos::rcpFromRef<qp::SolverMonitor<MultiVector>>(watched));
    if (monitor->hasState()) {
      monitor->restore([&](qp::StateArchive<MultiVector>& archive) { watched.exchange(archive); });
      test.gradient->setTolerance(tolerance);
      if (!test.equality.is_null())
        test.equality->setTolerance(tolerance);
    }
  }
  solver->setLog(log);
  solver->setProblem(problem);
  std::ostringstream text;
  text << "Solving by " << report.solver << " to " << scientific(tolerance, 0) << " ("
       << toString(options.stoppingRule) << " rule)";
  log.info(text.str());
  if (options.progressFrequency > 0)
    log.info("  outer  inner  step              |g^P|   |G lambda|   active     F*x  seconds");
  report.result = solver->solve();
  report.result.counters.setupApplications += dual.setupApplications();
  report.solved = true;
  if (!test.equality.is_null()) {
    // The scale that belongs to the last iterate, which the solver may not have asked for.
    qp::IterationState<MultiVector> last;
    last.x = solution.lambda.get();
    last.equalityResidual = report.result.equalityNorm;
    const bool met = test.equality->checkStatus(last) == qp::Status::Passed;
    report.equalityScale = test.equality->scale();
    if (!met && report.result.converged())
      log.info("Note: the penalty leaves |G lambda| = " + scientific(report.result.equalityNorm) +
               ", above the tolerance of the stopping rule, " + scientific(test.equality->limit()));
  }
  if (report.result.reason == qp::Reason::Infeasible && !solver->certificate().is_null()) {
    // y with yᵀGλ > 0 for all admissible λ: forces of one sign act on the motion R L⁻ᵀy.
    solution.escape = coarse.solveLt(valuesOf(solver->certificate()));
  }
  report.converged = report.result.converged();
  report.reason = qp::toString(report.result.reason);
  if (!report.converged)
    report.reason += ": " + report.result.explanation;
  solution.mu = valuesOf(multiplier);
  return solution;
}

} // namespace Harmos::feti
