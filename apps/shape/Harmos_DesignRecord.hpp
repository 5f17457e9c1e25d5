// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CheckpointFile.hpp"
#include "Harmos_DesignProblem.hpp"

#include <functional>
#include <string>
#include <vector>

namespace Harmos::shape {

/// A function of designs that remembers all that it was asked: optimisers always ask the same where they get
/// the same answers, so that a run that begins anew with the record of an earlier one comes to where that one
/// was without a solution, to the last bit, whatever state the optimiser has.
///
/// Guarded by tests/regression/test_shape.py.
class DesignRecord : public sensitivity::DesignFunction {
 public:
  /// @param function to outlive this. @param before asked before each value that is not on record, when the
  /// function has nothing at hand that a run that goes on from here would lack; may throw. Collective.
  DesignRecord(sensitivity::DesignFunction& function, std::function<void()> before);

  double value(const std::vector<double>& design, double tolerance) override;
  std::vector<double> gradient(const std::vector<double>& design, double tolerance) override;

  /// A design that was made of answers, and is on record likewise. @param make collective.
  std::vector<double> derived(const std::vector<double>& design,
                              const std::function<std::vector<double>()>& make);

  /// Values that were asked for, those on record included.
  int values() const { return values_; }
  /// Designs among these that were refused.
  int refused() const { return refused_; }
  /// Whether answers still come from the record of an earlier run.
  bool isRecalling() const { return next_ < recalled_; }
  /// Answers of an earlier run that were of no use: the optimiser asked something else.
  std::size_t forgotten() const { return forgotten_; }

  /// For checkpoints. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive);
  /// Messages of designs that were refused, a line each.
  std::string refusals() const;
  void setRefusals(const std::string& lines);

 private:
  enum class What { Value, Gradient, Refused, Derived };
  struct Answer {
    What what;
    double tolerance;
    std::vector<double> design, numbers; // the value, or the gradient
    std::string refusal;
  };
  const Answer* recalled(What what, const std::vector<double>& design, double tolerance);

  sensitivity::DesignFunction& function_;
  std::function<void()> before_;
  std::vector<Answer> answers_;
  std::size_t next_ = 0, recalled_ = 0, forgotten_ = 0;
  int values_ = 0, refused_ = 0;
};

} // namespace Harmos::shape
