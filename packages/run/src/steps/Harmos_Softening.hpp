// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AnswerSpan.hpp"
#include "Harmos_Effect.hpp"

namespace Harmos::run {

/// The way to the answer of a step, of all effects together whose points soften (scene::Effect::softens()).
/// A solution is one of springs, a convex problem; each says how bodies open then, and forces of the laws at
/// these openings are others. AnswerSpan finds the best openings x̂ among all that is known; springs of the
/// next solution go through force and opening there, as stiff as a quarter of the slope s of softening:
///
///     f = f_law(x̂) + θs(x − x̂),   θ = 1/4.
///
/// They bound the law's energy from above, so that it falls from solution to solution (Hunter, Lange: Amer.
/// Statist. 58, 2004). When forces are those of the laws the last solution is one at frozen damage, of
/// springs through the origin: convex, with the energies of such springs. A step in which loads go on as in
/// the last one begins with springs through openings that do, if anything softens there.
///
/// Openings and forces are the same on all ranks, multipliers shared. Members are local unless they say
/// otherwise. Guarded by tests/unit/effects/test_damage_update.cpp.
class Softening {
 public:
  struct Part {
    const scene::Effect* effect;
    const std::vector<scene::Effect::Row>* rows;
    std::vector<scene::Effect::RowAnswer> answer;
    std::vector<double>* trial;
  };

  /// @param stiffnesses of intact springs: of all rows of all parts, in their order.
  explicit Softening(std::vector<double> stiffnesses);

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

  /// @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const feti::DualProblem& problem);

 private:
  struct Answer {
    std::vector<double> openings;
    feti::WarmStart multipliers;
  };
  void watch(double misfit);
  std::vector<double> forces(const std::vector<Part>& parts, const std::vector<double>& openings) const;

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
