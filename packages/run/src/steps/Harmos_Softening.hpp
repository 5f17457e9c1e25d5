// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerSpan.hpp"
#include "Harmos_InterfaceLaw.hpp"
#include "Harmos_KeyedNumbers.hpp"

namespace Harmos::run {

/// The iteration to the solution of a step for all laws with softening points together
/// (scene::InterfaceLaw::softens()). Each solve has springs in place of the laws and is convex; the forces of
/// the laws at its openings differ from those of the springs. AnswerSpan finds the best openings x̂ in the
/// span of the solutions. The springs of the next solve pass through force and opening there, with a quarter
/// of the softening slope s as stiffness:
///
///     f = f_law(x̂) + θs(x − x̂),   θ = 1/4.
///
/// Their energy bounds that of the law from above, so the energy decreases from solve to solve (Hunter,
/// Lange: Amer. Statist. 58, 2004). When the forces satisfy the laws, the last solve has frozen damage:
/// springs through the origin, a convex problem with the energies of such springs. If points soften there, a
/// step whose loads continue those of the previous step starts with springs at extrapolated openings.
///
/// Openings and forces are those of this rank's rows, multipliers shared; members are collective. Guarded by
/// tests/unit/effects/test_damage_update.cpp.
class Softening {
 public:
  struct Part {
    const scene::InterfaceLaw* law;
    const std::vector<scene::InterfaceLaw::Row>* rows;
    std::vector<scene::InterfaceLaw::RowAnswer> answer;
    scene::PointStates* trial;
  };

  /// @param keys, stiffnesses of intact springs: of this rank's rows of all parts, in their order.
  Softening(const Teuchos::Comm<int>& comm, std::vector<long long> keys, std::vector<double> stiffnesses);
  Softening(const Softening&) = delete;
  Softening& operator=(const Softening&) = delete;

  /// A step begins: where loads go on as in the last one openings do, if points soften then. @param advance
  /// of loads, in terms of that of the last step; nothing where that says nothing.
  void begin(const std::vector<Part>& parts, std::optional<double> advance);
  /// The last answer was accepted, as that of the step.
  void commit();
  /// Whether the step has been solved more than once.
  bool hasChanged() const { return answers_ > 1.0; }
  /// Of the next solution: on the way, a tenth of what the last one began with. @param asked of the answer.
  double tolerance(double asked) const;
  /// @param tolerance asked of the answer. @param startedAt residual with which its solution began, as a
  /// share of the problem's. @return whether the problem is to be solved again.
  bool update(const std::vector<Part>& parts, const feti::WarmStart& multipliers, double tolerance,
              double startedAt);
  /// Of the next solution, after update(): null where the last answer is it.
  const feti::WarmStart& start() const { return start_; }

  void exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  struct Answer {
    std::vector<double> openings;
    feti::WarmStart multipliers;
  };
  void watch(double misfit);
  std::vector<double> forces(const std::vector<Part>& parts, const std::vector<double>& openings) const;
  bool follow(const std::vector<Part>& parts, const std::vector<double>& openings,
              std::optional<double> times, double known) const;

  KeyedNumbers rows_;
  std::vector<double> stiffnesses_;
  AnswerSpan span_;
  Answer last_;
  std::vector<Answer> accepted_; // the last two at most
  feti::WarmStart start_;
  bool isOnTheWay_ = false; // the next solution is not the last one
  double startedAt_ = 1.0;
  double answers_ = 0.0, agreed_ = 0.0;     // of the step; of those that met the laws
  double leastMisfit_ = 0.0, waited_ = 0.0; // for a smaller one
};

} // namespace Harmos::run
