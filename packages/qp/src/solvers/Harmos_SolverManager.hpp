// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows.hpp"
#include "Harmos_Explanations.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_StatusTest.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace Harmos::qp {

/// The contract of all solvers; mirrors Belos::SolverManager.
///
/// Life cycle: setParameters() (checked against the specification at once, the first call included),
/// setProblem(), solve(). solve() reads the solution vector of the problem as initial guess and writes the
/// answer there. By default the solver converges when ‖g^P‖ ≤ tol‖b‖ and the distance of x from the
/// equalities is at most tol‖x‖; setConvergenceTest() puts another test in its place. Where b = 0 (least
/// norms) max(‖Ax_l‖, ‖Ax_c‖) takes the place of ‖b‖: x_l is the point within the bounds and x_c that on the
/// equalities next to zero, and moving the origin there makes b − Ax of b. Where these are zero too, as the
/// answer x = 0 then is, the initial guess counts, ‖Ax₀‖.
///
/// Before the first iteration every solver looks for what makes the problem senseless: crossed bounds,
/// contradictory equality rows, a load along a known kernel direction that nothing stops.
template<class Scalar, class MV, class OP>
class SolverManager {
 public:
  using ProblemType = Problem<Scalar, MV, OP>;

  virtual ~SolverManager() = default;

  /// "MPRGP", "SMALBE", ...
  virtual std::string name() const = 0;

  /// A new solver of the same kind and parameters, without a problem.
  virtual Teuchos::RCP<SolverManager> clone() const = 0;

  /// Whether it solves problems with limits that follow the solution; FixedPointSolver does so with others.
  virtual bool letsLimitsFollow() const { return false; }

  /// Whether it solves problems with terms that are no sets, as soft bounds are; others refuse them.
  virtual bool takesAllBlocks() const { return false; }

  /// Whether its default test is about equalities, too: not of those that meet them by a penalty.
  virtual bool meetsEqualities() const { return true; }

  /// Whether another solver goes on where this one gives up: see AutoSolver, which has the order.
  void setSuccessor(bool isThere) { outer_.hasSuccessor = isThere; }
  /// After solve(): why it gave up, where another method may do better; empty if it did not.
  const std::string& gaveUp() const { return session_.gaveUp; }

  /// Type, default, range and meaning of every parameter.
  virtual const ParameterSpec& parameterSpec() const = 0;

  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters() const {
    return parameterSpec().teuchosList();
  }
  Teuchos::RCP<const Teuchos::ParameterList> getCurrentParameters() const { return parameters_; }

  /// @throws InputError for an unknown name, a wrong type or a value out of range.
  void setParameters(const Teuchos::RCP<Teuchos::ParameterList>& parameters);

  /// @throws InputError if the problem is not marked as set.
  void setProblem(const Teuchos::RCP<ProblemType>& problem);
  const ProblemType& getProblem() const { return *problem_; }

  /// In the place of the default test; null brings the default back. A test may also stop the solver for
  /// another reason than convergence, see StatusTest::reason().
  void setConvergenceTest(const Teuchos::RCP<StatusTest<MV>>& test) { tests_.given = test; }

  /// Is asked when the solver would stop as converged, with x and the multiplier in the problem as they would
  /// be returned; if it says no, having made the convergence test stricter, the solver goes on from where it
  /// is, conjugate directions and all. For criteria that cost too much to be looked at in every iteration.
  /// Null: what passes the test is accepted. Called on all ranks at once; the answer has to be the same.
  void setAcceptance(std::function<bool()> acceptance) { tests_.acceptance = std::move(acceptance); }

  /// Is asked about every iterate, and its answer ignored; null for none.
  void setDebugStatusTest(const Teuchos::RCP<StatusTest<MV>>& test) { tests_.debug = test; }

  /// Looks after the solver while it works: live views, checkpoints, signals. Null for none. With a state to
  /// go on from, solve() goes on from there: the iterates are those of the run that was left, up to what
  /// another number of ranks rounds differently.
  void setMonitor(const Teuchos::RCP<SolverMonitor<MV>>& monitor) { monitor_ = monitor; }

  /// Progress goes here; silent by default.
  void setLog(const Log& log) { log_ = log; }

  /// Forgets counters, history and certificate.
  void reset() {
    result_ = Result();
    certificate_ = Teuchos::null;
  }

  /// @throws InputError if no problem is set or its structure is not what this solver is for, as soft bounds
  /// are not for all.
  /// @note Collective.
  Result solve();

  /// After Infeasible the y, after Unbounded the d that Result::certificate speaks of; else null, and also
  /// for crossed bounds, where the entry is the proof.
  Teuchos::RCP<const MV> certificate() const { return certificate_; }

  int getNumIters() const { return static_cast<int>(result_.history.size()); }
  /// ‖g^P‖ reached.
  double achievedTol() const { return result_.projectedGradientNorm; }

 protected:
  SolverManager() = default;

  /// The solution itself; result_ is fresh, the problem is set.
  virtual void doSolve() = 0;

  /// The parameters every solver has.
  static void addCommonParameters(ParameterSpec& spec);

  /// Applies the tests and limits to a state: a reason to stop, or none. A caller whose state is no candidate
  /// yet does not take "converged" for an answer.
  std::optional<Reason> judge(const IterationState<MV>& state);

  /// What setAcceptance() was given says of the answer that the problem holds now.
  bool accepted() const { return !tests_.acceptance || tests_.acceptance(); }

  /// The rows as solvers use them; null, with the solver stopped, if they contradict each other.
  Teuchos::RCP<EqualityRows<Scalar, MV, OP>> makeRows();

  using Archive = StateArchive<MV>;
  /// What a state is called in an archive where several solvers of a kind delegate to each other.
  std::string stateName(const std::string& name) const { return prefix(outer_.depth) + name; }

  /// Describes what doSolve() knows; to be said once, before the first iteration. What it refers to has to
  /// live as long as doSolve() works.
  void describeState(const std::function<void(Archive&)>& own) { session_.state = own; }
  /// Whether doSolve() is to go on from a state instead of beginning.
  bool resumes() const { return outer_.mayResume && !session_.hasResumed && hasStateOf(outer_.depth); }
  /// The same, where that state belongs to the solver to which this one delegated.
  bool resumesDelegate() const { return resumes() && hasStateOf(outer_.depth + 1); }
  /// Brings the described state back, counters and history too.
  void resume();
  /// Asks the monitor, at a point where the described state is all there is; true if the solver has stopped.
  bool isInterrupted(const IterationState<MV>& state);
  /// At a limit: another run may go on from here.
  void keepState(Reason reason);

  /// Stores a row of the history and prints it when its turn has come.
  void record(const IterationState<MV>& state, StepKind step, double penalty, double precision,
              long long active);

  void stop(Reason reason, const std::string& explanation) {
    result_.reason = reason;
    result_.explanation = explanation;
  }
  /// With the residuals of a last state.
  void stop(Reason reason, const std::string& explanation, const IterationState<MV>& state);
  /// Stops where another method may go on, with reason and residuals as if there were none.
  void giveUp(const std::string& why, const IterationState<MV>& state) {
    session_.gaveUp = why;
    stop(Reason::Stagnation, Explanations::noOtherMethod(why), state);
  }
  bool hasSuccessor() const { return outer_.hasSuccessor; }
  /// For a reason that judge() gave.
  void stopFor(Reason reason, const IterationState<MV>& state);
  void stopInfeasible(const Teuchos::RCP<const MV>& y, const Certificate& certificate);
  void stopUnbounded(const Teuchos::RCP<const MV>& d, const Certificate& certificate);

  /// What another solver is to do.
  struct Delegation {
    Teuchos::RCP<ProblemType> problem = Teuchos::null;   ///< null: the same one
    Teuchos::RCP<StatusTest<MV>> orTest = Teuchos::null; ///< what passes it is enough, too; null for none
    bool isWhole = true; ///< its answer is one; if not, nobody is asked whether to accept it
  };
  /// Lets another solver finish the problem from the present solution, under this one's tests and with those
  /// of its parameters that the other one knows; its counters, history and result are added to this one's.
  void delegate(SolverManager& other, const Delegation& what);
  void delegate(SolverManager& other) { delegate(other, Delegation()); }
  /// Describes what this knows while another solver works for it.
  void describeDelegation(const std::function<void(Archive&)>& own) { session_.delegation = own; }
  /// Brings that back at once, if resumesDelegate(): what is given to delegate() may depend on it.
  void resumeDelegation() {
    if (resumesDelegate())
      monitor_->restore(session_.delegation);
  }

  /// The expert parameters of a method: "PDAS", "PCPG" ...
  const Teuchos::ParameterList& methodParameters(const std::string& method) const {
    return parameters_->sublist("Expert").sublist(method);
  }
  int maximumIterations() const { return parameters_->template get<int>("Maximum Iterations"); }
  double elapsedSeconds() const;

  Teuchos::RCP<ProblemType> problem_;
  Teuchos::RCP<Teuchos::ParameterList> parameters_;
  Teuchos::RCP<const MV> certificate_;
  Log log_;
  Result result_;
  int firstInner_ = 0; // iterations of the solver that delegates to this one

 private:
  struct Tests {
    Teuchos::RCP<StatusTest<MV>> given, debug, active;
    Teuchos::RCP<StatusTestProjectedGradient<MV>> load; // of the default test, till its scale is known
    std::function<bool()> acceptance;
  };
  // What the solvers that delegate to this one have told.
  struct Outer {
    std::function<void(Archive&)> state;
    int depth = 0;    // how many they are
    int products = 0; // of theirs
    double seconds = 0.0;
    bool mayResume = true; // of several solvers to which one delegates, the first after a state
    bool hasTest = false;  // the test was begun there
    bool hasSuccessor = false;
  };
  // Of one solve.
  struct Session {
    std::chrono::steady_clock::time_point start;
    double secondsBefore = 0.0; // of the runs before this one
    bool hasResumed = false;
    std::string gaveUp;
    std::function<void(Archive&)> state;      // of doSolve()
    std::function<void(Archive&)> delegation; // of doSolve(), beside that of the solver it delegates to
  };

  Teuchos::RCP<StatusTest<MV>> defaultTest() const;
  void makeTest();
  void measureLoad(const EqualityRows<Scalar, MV, OP>* rows);
  double imageNorm(const MV& x);
  bool isSenseless();
  bool fallsAlongNullSpace();
  static std::string prefix(int depth) { return "solver" + std::to_string(depth) + " "; }
  bool hasStateOf(int depth) const {
    return !monitor_.is_null() && monitor_->hasState() && monitor_->holds(prefix(depth) + "seconds");
  }
  void save();
  double sessionSeconds() const;

  Tests tests_;
  Teuchos::RCP<SolverMonitor<MV>> monitor_;
  Outer outer_;
  Session session_;
};

} // namespace Harmos::qp
