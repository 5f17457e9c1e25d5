// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceArchive.hpp"
#include "Harmos_FaceSolver.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace Harmos::qp {

/// How the faces of a semismooth Newton method get on.
class NewtonProgress {
 public:
  /// Whether there were as many faces as `patience` since the bound on ‖g^P‖ was last halved. Newton's method
  /// on sets has no such decrease far from the solution: it may wander for hundreds of sets, where matrices
  /// are far from M-matrices (elements of second order in contact).
  bool isLost(double bound, int patience) {
    least_ = std::min(least_, bound);
    if (least_ < 0.5 * mark_) {
      mark_ = least_;
      facesSinceMark_ = 0;
      return false;
    }
    return ++facesSinceMark_ >= patience;
  }
  /// Whether faces have come back too often. Inexact solves may come back to a face on their way; exact ones
  /// that do so go round in circles.
  bool isCircle(const FaceChange& change) {
    return !seen_.insert(of(change)).second && ++repeats_ > mostRepeats;
  }
  /// Whether a face came back after another one.
  bool isBack(const FaceChange& change) {
    const bool isSame = of(change) == std::exchange(last_, of(change));
    return !seen_.insert(of(change)).second && !isSame;
  }
  /// Counts begin anew.
  void forget() {
    seen_.clear();
    repeats_ = 0;
    facesSinceMark_ = 0;
  }
  /// The least bound on ‖g^P‖ so far.
  double least() const { return least_; }
  void setLeast(double bound) { least_ = bound; }

  template<class Archive>
  void exchange(Archive& archive) {
    archive.number("pdas repeats", repeats_);
    archive.number("pdas least", least_);
    archive.number("pdas mark", mark_);
    archive.number("pdas faces since mark", facesSinceMark_);
    archive.number("pdas last face", last_.first);
    archive.number("pdas last face's other", last_.second);
    std::vector<double> signatures;
    for (const auto& [first, second] : seen_)
      signatures.insert(signatures.end(), {first, second});
    archive.numbers("pdas faces seen", signatures);
    for (std::size_t k = 0; k + 1 < signatures.size(); k += 2)
      seen_.insert({signatures[k], signatures[k + 1]});
  }

 private:
  using Signature = std::pair<double, double>;
  static constexpr int mostRepeats = 3;
  static Signature of(const FaceChange& change) { return {change.signature[0], change.signature[1]}; }

  std::set<Signature> seen_;
  Signature last_{0.0, 0.0};
  int repeats_ = 0;
  double least_ = std::numeric_limits<double>::infinity(), mark_ = least_; // and when it was last halved
  int facesSinceMark_ = 0;
};

/// The projected iterate with the least bound on ‖g^P‖, or the first one, and the multiplier with it; the
/// gradient of the Lagrangian and the face after it.
template<class Scalar, class MV>
struct BestIterate {
  Teuchos::RCP<MV> x, multiplier, gradient;
  ActiveFace face;
  bool isFound = false;

  void exchange(StateArchive<MV>& archive) {
    archive.vector("pdas best", *x);
    archive.number("pdas has best", isFound);
    if (!multiplier.is_null())
      archive.rowVector("pdas best multiplier", *multiplier);
    if (!isFound)
      return;
    archive.vector("pdas best gradient", *gradient);
    FaceArchive<Scalar, MV>(archive, "pdas best", *x).exchange(face);
  }
};

struct NewtonOptions {
  enum class FirstFace { Auto, Tried, Nearest, Gradient };

  double innerReduction;
  int patience, mostFaces, mostKept;
  FirstFace firstFace;
  int budget; ///< inner iterations before it gives up
  int mostIterations;
  CgOptions cg;
};

/// What the steps and the strategies of a semismooth Newton method work on.
template<class Scalar, class MV, class OP>
struct NewtonState {
  NewtonState(Problem<Scalar, MV, OP>& itsProblem, EqualityRows<Scalar, MV, OP>& itsRows,
              const NewtonOptions& itsOptions, Counters& itsCounters, const Log& itsLog)
      : problem(itsProblem),
        rows(itsRows),
        options(itsOptions),
        counters(itsCounters),
        log(itsLog),
        x(*problem.solution()),
        y(MVT::Clone(x, 1)),
        solver(problem, rows, options.cg, counters) {}

  using MVT = Belos::MultiVecTraits<Scalar, MV>;

  Problem<Scalar, MV, OP>& problem;
  EqualityRows<Scalar, MV, OP>& rows;
  NewtonOptions options;
  Counters& counters;
  const Log& log;
  MV& x;
  Teuchos::RCP<MV> y; ///< the gradient of the Lagrangian
  FaceSolver<Scalar, MV, OP> solver;
  ActiveFace face;
  long long active = 0;
  FaceChange change;     ///< by the last update
  double expected = 0.0; ///< ‖g^P‖ at the projection of x is at most that
  NewtonProgress progress;
  BestIterate<Scalar, MV> best;
  IterationState<MV> now;
  bool turns() const { return !problem.kind().isPiecewiseLinear || !problem.kind().isCost; }

  void exchange(StateArchive<MV>& archive) {
    archive.number("pdas active", active);
    archive.number("pdas inner reduction", options.innerReduction);
    archive.number("pdas slips", change.slips);
    progress.exchange(archive);
    best.exchange(archive);
    FaceArchive<Scalar, MV>(archive, "pdas", x).exchange(face);
    const Teuchos::RCP<MV> limits = MVT::Clone(x, 1);
    if (!problem.kind().isCost) {
      problem.limits(*limits);
      archive.vector("pdas limits", *limits);
      if (archive.isReading())
        problem.setLimits(*limits);
    }
    solver.exchange(archive);
  }
};

} // namespace Harmos::qp
