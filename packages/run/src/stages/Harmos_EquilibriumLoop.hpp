// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AndersonMixing.hpp"
#include "Harmos_Balance.hpp"
#include "Harmos_CarriedForces.hpp"
#include "Harmos_DeformedBodies.hpp"
#include "Harmos_PointSlips.hpp"
#include "Harmos_RenewedTangent.hpp"
#include "Harmos_RunStages.hpp"
#include "Harmos_TornArchive.hpp"

#include <functional>
#include <optional>
#include <string>

namespace Harmos::run {

/// Equilibrium of bodies at finite displacements, or of materials that yield: Newton's iterations of a step,
/// a sequence of quadratic programs
///
///     du = argmin ½duᵀK̂du − (f − f_int(u))ᵀdu  over  B(u)du ≤ gap(u),   u ← u + du,
///
/// with contacts searched anew on the deformed bodies in each. Forces f_int and gaps are exact, the tangent K̂
/// is the material part (DeformedBodies), whose kernel is that of rigid motions of the deformed body:
/// Anderson's acceleration makes up for what is missing in it, the stiffness by stresses and by turning
/// normals. Where bodies yield the tangent of their subdomains, and no other, is made anew in each iteration.
///
/// The merit is ‖du‖_K̂, by which a body would still move (the natural level function: Deuflhard, Newton
/// Methods for Nonlinear Problems, 2004, section 3.3). The step has converged where it is below the
/// tolerance, as a share of the strains' √(2W); then the equilibrium is audited: f − f_int(u) − B(u)ᵀλ and
/// gaps, with rows made once more. Of bodies in motion f is without their forces of inertia, K̂ with κM, see
/// Motion, and changes are also judged as a share of √(ΔvᵀMΔv), what the step changes velocities by. It has
/// failed where the merit does not come down, or cells turn inside out.
///
/// All members are collective. Guarded by tests/verification/finite.
class EquilibriumLoop {
 public:
  /// @param run set up. @param motion of bodies that have inertia, or null. All to outlive it.
  EquilibriumLoop(const RunContext& context, RunStages& run, Motion* motion = nullptr);

  /// What bodies at rest, where they are, are moved by when the run begins: loads less internal forces.
  Balance::Loads forcesAtRest();
  /// A step begins, for the first time or again, from what was committed at a time.
  void begin(double from);
  enum class Outcome { Converged, Failed, Interrupted };
  /// Iterates to equilibrium at a time. @param log of the solver. @param monitor of the solves. @param save
  /// keeps the state between two iterations, when the monitor asks for it. @return of what failed, failure()
  /// says why, also where bodies on the way are none that can be solved for; what was interrupted is where it
  /// was before its last iteration.
  Outcome solve(double time, const Log& log, RunMonitor& monitor, const std::function<void()>& save);
  void commit();
  /// For checkpoints. @param isWithinStep or after one that was committed.
  void exchange(qp::StateArchive<MultiVector>& archive, bool isWithinStep);

  /// What adhesion binds, and its states are of.
  MovedBonds& bonds() { return balance_.bonds(); }
  long long bondCount() const { return balance_.bondCount(); }
  /// Equations that are locked at a time; to outlive it.
  void follow(const Locks& locks) { balance_.follow(locks); }
  /// The step is to be solved once more, with other springs, from where it is.
  void goOn();

  const std::string& failure() const { return failure_; }
  /// Of the step so far.
  int iterations() const { return iterations_; }
  /// What loads that go with the bodies, and temperatures, have done in the step, by the trapezoidal rule.
  double furtherWork() const { return work_; }
  /// By materials, since the run began.
  double dissipated() const { return trial_.dissipated; }

 private:
  using Loads = Balance::Loads;
  // What u is in, or was.
  struct State {
    feti::TornVector displacement;
    CarriedForces forces;
    PointSlips slips;                 // since the run began
    feti::TornVector following = {};  // loads that go with the bodies; none without any
    std::vector<double> motions = {}; // of the coarse problem that was solved last
    double time = 0.0, energy = 0.0, dissipated = 0.0, forceSize = 0.0;
    DeformedBodies::States states = {}; // of materials, of an answer
  };
  // How the merit came down.
  struct Progress {
    double tolerance = 0.0; // of solves
    double scale = 0.0, last = 0.0;
    std::vector<double> logarithms; // of the last ones
    bool isSlow = false;            // the tangent is to be made anew
    double yielding = 0.0;          // points
    int before = 0;                 // iterations of the step, of solves before this one
  };
  // What a quadratic program says: du in the frames, and with equal copies, without; ‖du‖_K̂.
  struct Change {
    feti::TornSolution torn;
    std::vector<double> motions; // of the coarse problem
    feti::TornVector joined;
    double jump = 0.0, merit = 0.0; // jump: the largest that was joined
  };
  Outcome iterate(double time, const Log& log, RunMonitor& monitor, const std::function<void()>& save);
  void blameFault(const feti::TornVector& displacement);
  void pose(double time, const DeformedBodies::Forces& forces);
  void renewTangent(const DeformedBodies::Forces& forces);
  Outcome solveProblem(const Log& log, RunMonitor& monitor, Change& change);
  Outcome solveTo(const std::optional<feti::WarmStart>& start, const Log& log, RunMonitor& monitor,
                  Change& change);
  double forcing(double merit) const;
  Outcome solveOnce(const feti::WarmStart* start, const Log& log, RunMonitor& monitor,
                    feti::DualSolution& solution);
  bool advance(const Change& change, feti::TornVector& answer, DeformedBodies::Forces& forces,
               double& stiffness);
  bool isShortened(const std::function<bool(double)>& go, double& stiffness) const;
  feti::TornVector image(const feti::TornVector& change) const;
  double meritOf(const feti::TornVector& change) const;
  bool hasConverged(double time, const feti::TornVector& answer, const DeformedBodies::Forces& forces,
                    const Change& change, const Log& log, RunMonitor& monitor);
  std::string instability(const feti::TornVector& answer, const Change& change, const Log& log,
                          RunMonitor& monitor);
  std::optional<feti::TornVector> motionUnder(const feti::TornVector& force, const Change& change,
                                              const Log& log, RunMonitor& monitor);
  feti::TornVector wholeStiffness(const feti::TornVector& answer, const feti::TornVector& motion,
                                  double share) const;
  void exchangeStates(TornArchive& torn);
  double workOf(const feti::TornVector& forces, const feti::TornVector& displacement) const;
  double weighed(const feti::TornVector& values) const;
  double scaleOf(const feti::TornVector& answer, double energy) const;
  bool isStuck(double merit);
  std::vector<std::optional<feti::Frame>> frames() const;
  void tell(double merit) const;
  void moveOn(const feti::TornVector& answer, bool isWhole, DeformedBodies::Forces& forces);
  double followingWork(double time, const feti::TornVector& answer);
  double thermalWork(const feti::TornVector& answer, double energy) const;
  bool agrees(const feti::KktAudit& audited, const feti::TornVector& answer) const;

  RunContext context_;
  RunStages& run_;
  DeformedBodies bodies_;
  Balance balance_;
  // By which changes are mixed and judged.
  struct Norm {
    feti::TornVector weights;                  // diag(K)
    double ofPlaces = 0.0, largestPlace = 0.0; // √(Xᵀdiag(K)X), |X|
  } norm_;
  AndersonMixing mixing_;
  State committed_, trial_;
  RenewedTangent tangent_;
  Loads posed_; // of the problem that was posed last
  Progress progress_;
  double work_ = 0.0; // of following loads and temperatures
  int iterations_ = 0;
  bool isSaveDue_ = false;
  std::string failure_;
};

} // namespace Harmos::run
