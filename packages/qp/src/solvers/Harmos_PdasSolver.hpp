// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveSetOps.hpp"
#include "Harmos_BalancedActiveSet.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_DescentOfSets.hpp"
#include "Harmos_FirstActiveSet.hpp"
#include "Harmos_FollowingOps.hpp"
#include "Harmos_FrozenSides.hpp"
#include "Harmos_InteriorPath.hpp"
#include "Harmos_ProjectedCg.hpp"
#include "Harmos_SolverManager.hpp"

#include <limits>
#include <set>
#include <utility>

namespace Harmos::qp {

/// "PDAS": the primal-dual active set method (a semismooth Newton method; Hintermüller, Ito, Kunisch, SIAM J.
/// Optim. 13, 2002) with projected conjugate gradients inside, see ProjectedCg.
///
/// For a guess of the active set, the equality-constrained problem with these entries held at their bounds is
/// solved, from the solution of the last guess; entries whose multiplier has the wrong sign are freed, free
/// ones beyond their bound become active. Until the set settles, the inner residual is only reduced by
/// "Inner reduction"; an iterate is accepted as soon as its projection onto the bounds passes the convergence
/// test. Superlinear near the solution, and mesh-independent from a good initial guess: the sign of its
/// gradient tells the first active set. Where nothing is known, FirstActiveSet may do so better.
///
/// Far from the solution sets may wander. When a set comes back, or when the bound on the projected gradient
/// does not get on, faces are followed further: to a fifth of "Inner reduction", and once more. When that
/// does not help either, or when the equalities cannot be met on a face, it goes back to the best iterate and
/// makes the sets descend from there, see DescentOfSets; then it converges from everywhere (counters:
/// descents). When A is singular on a face, when conjugate gradients take twice its dimension, when there
/// were too many guesses, or when the share of the iterations is used up that is meant for it, MPRGP or
/// SMALBE takes over from the best iterate (counters: safeguards) and has the rest of the iterations.
///
/// Where limits follow the solution there is no cost that could fall: the first set that comes back after
/// another one is a circle, and sets are balanced with stiffer springs from there on (BalancedActiveSet).
///
/// Entries that are outside of soft bounds are springs of the face (SpringOps), by the side where they are:
/// Newton's method for a gradient that bends there. Where that goes in circles, sides stay until the rest has
/// settled, and x goes from answer to answer as far as the cost falls on the way (generalised Newton's method
/// with line search; Facchinei, SIAM J. Optim. 5, 1995). No other method takes over then.
///
/// Needs orthonormal rows (made so if they are few). With equalities the dense C_FC_Fᵀ is factored for each
/// guess, at a product with C and Cᵀ a row.
///
/// Guarded by tests/unit/qp/test_pdas_budget.cpp, tests/unit/qp/test_random_problems.cpp and
/// tests/verification/test_obstacle.cpp.
template<class Scalar, class MV, class OP>
class PdasSolver : public SolverManager<Scalar, MV, OP> {
 public:
  std::string name() const override { return "PDAS"; }
  Teuchos::RCP<SolverManager<Scalar, MV, OP>> clone() const override;
  const ParameterSpec& parameterSpec() const override { return spec(); }
  bool letsLimitsFollow() const override { return true; }
  bool takesSoftBounds() const override { return true; }
  static const ParameterSpec& spec();
  /// The list "PDAS" alone.
  static ParameterSpec methodSpec();

 protected:
  void doSolve() override;

 private:
  class Run;
  void fallBack(const std::string& why);
};

/// One solution of a problem, from the first active set to the answer or to the hand-over:
///
///     begin() → enterFace() → descend() → look() ┬→ considerCandidate(), confirmAnswer() → the end
///                   ↑             ↑              ├→ settled: descend() to the end
///                   └─────────────┴──────────────┴→ another set: advanceOrFallBack()
template<class Scalar, class MV, class OP>
class PdasSolver<Scalar, MV, OP>::Run {
 public:
  Run(PdasSolver& solver, EqualityRows<Scalar, MV, OP>& rows);
  void go();

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Bounds = BoundOps<Scalar, MV>;
  using Sets = ActiveSetOps<Scalar, MV>;
  using Limits = FollowingOps<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  using Cg = ProjectedCg<Scalar, MV, OP>;

  enum class FirstSet { Auto, Tried, Nearest, Gradient };

  // How the sets get on.
  struct Progress {
    std::set<std::pair<double, double>> seen; // signatures
    std::pair<double, double> last{0.0, 0.0};
    // Inexact solves may come back to a set on their way; exact ones that do so go round in circles.
    static constexpr int mostRepeats = 3;
    int repeats = 0;
    // The least bound on ‖g^P‖ so far, and what it was when it had last fallen by half. Newton's method on
    // sets has no such decrease far from the solution: it may wander for hundreds of sets, where matrices are
    // far from M-matrices (elements of second order in contact).
    double least = std::numeric_limits<double>::infinity(), mark = least;
    int setsSinceMark = 0;

    void exchange(StateArchive<MV>& archive);
    /// Counts begin anew.
    void forget() {
      seen.clear();
      repeats = 0;
      setsSinceMark = 0;
    }
    /// Whether there were as many sets as `patience` since the bound was last halved.
    bool isLost(double bound, int patience);
    /// Whether sets have come back too often.
    bool isCircle(const ActiveSetChange& change);
    /// Whether a set came back after another one.
    bool isBack(const ActiveSetChange& change);
  };

  // What goes wrong: a face cannot be entered; its equations are singular, or break down; sets do not get on;
  // there were too many.
  enum class Trouble { NoFace, BadFace, NoProgress, ManySets };

  // The projected iterate with the least bound on ‖g^P‖, or the first one, and the multiplier with it. Where
  // sets may be balanced from there: the gradient of the Lagrangian and the next set.
  struct Best {
    Teuchos::RCP<MV> x, multiplier, gradient;
    LocalActiveSet set;
    bool isFound = false;

    void exchange(StateArchive<MV>& archive, const Problem<Scalar, MV, OP>& problem);
  };

  // How all sets are balanced, where limits follow or pairs turn.
  struct Balance {
    bool isOn = false;
    double stiffening = 1.0; // of the springs of next_
    int paths = 0;           // through interior points, that were followed

    void exchange(StateArchive<MV>& archive);
  };

  struct Options {
    double innerReduction;
    int patience, mostSets, mostKept;
    FirstSet firstSet;
    int budget; // inner iterations before another method takes over
  };

  // The steps, in their order. Where one of them returns false, the solver has stopped or handed over.
  void begin();
  bool enterFace();
  bool startsOnFace();
  void aim();
  bool descend();
  bool isFarEnough() const;
  bool isInterrupted();
  bool advance();
  void look();
  bool considerCandidate();
  bool confirmAnswer();
  bool advanceOrFallBack();
  bool findWayOn(Trouble trouble, const std::string& why);
  bool followFaces(const std::string& why);
  bool mayBalance() const;
  bool balanceSets(const std::string& why);
  bool restartFromInteriorPoint(const std::string& why);
  void findSetBeside(const MV& x, const MV& y, double q);
  bool startDescent(const std::string& why);
  bool freezeSides(const std::string& why);
  bool moveSides();
  void guessSprings();
  void lookAtSprings(double noise);

  void describeState();
  void guess();
  void guessBounds();
  bool isAtAllBounds(double scale);
  bool triesNearest(FirstActiveSet<Scalar, MV, OP>& nearest);
  bool startsWithActive();
  void addMultiplier();
  void lookAtFollowing(double stepLength);
  bool isExhausted() const;
  static LocalActiveSet springsOf(const LocalActiveSet& set) {
    LocalActiveSet result;
    result.springs = set.springs;
    return result;
  }
  bool hasFollowing() const { return problem_.hasFollowingLimits(); }
  // No solver but this takes soft bounds.
  bool hasNoOther() const { return problem_.hasSoftBounds() && !hasFollowing(); }
  void freeFollowing();
  IterationState<MV> evaluate(double gradientNorm, int inner);
  IterationState<MV> measure(int inner, bool feasible);
  void handOver(const std::string& why);

  PdasSolver& solver_;
  EqualityRows<Scalar, MV, OP>& rows_;
  const Problem<Scalar, MV, OP>& problem_;
  Counters& counters_;
  MV& x_;
  FeasibleSet<MV> feasible_;

  static constexpr double carefulReduction = 0.05; // below, faces are followed no further
  Options options_;
  double disproved_ = std::numeric_limits<double>::infinity(); // ‖g^P‖ that was expected, and was not

  Teuchos::RCP<MV> y_;
  Cg cg_;
  LocalActiveSet set_;
  LocalActiveSet before_;  // the last look
  ActiveSetChange change_; // by it
  double faceCost_ = 0.0;  // there; where sets descend
  double expected_ = 0.0;  // ‖g^P‖ at the projection of x is at most that
  long long active_ = 0;
  Progress progress_;
  DescentOfSets<Scalar, MV, OP> descent_;
  BalancedActiveSet<Scalar, MV, OP> next_;
  Best best_;

  bool isCold_ = false;   // nothing is known of the solution
  bool settled_ = false;  // the last look changed nothing
  bool isMoved_ = false;  // x, since then
  bool restarts_ = false; // on another face
  bool newFace_ = true, started_ = false;
  Balance balance_;
  FrozenSides<Scalar, MV, OP> sides_;
  double wrongSprings_ = 0.0; // what springs are wrong by
  // On a face.
  double target_ = 0.0;
  bool stepped_ = false, resumed_ = false;
  long long faceSteps_ = 0;
  int inner_;
  IterationState<MV> state_;
};

} // namespace Harmos::qp
