// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignProblem.hpp"
#include "Harmos_Sensitivities.hpp"

#include <memory>
#include <vector>

namespace Harmos::sensitivity {

/// What a design changes: gaps, or shapes of bodies.
class DesignModel {
 public:
  virtual ~DesignModel() = default;

  virtual std::size_t size() const = 0;
  /// Of each number of a design, the area that it moves: DesignSpace::weights.
  virtual const std::vector<double>& weights() const = 0;

  /// Brings the solver to a design. @throws RefusedDesign on all ranks for one that bodies cannot have, and
  /// the solver stays as it was. @note Collective.
  virtual void apply(const std::vector<double>& design) = 0;
  /// Rows of the solver, and their geometry, of the last design.
  virtual const std::vector<ConstraintRow>& rows() const = 0;
  virtual const RowGeometry& geometry() const = 0;

  /// Whether gradient() needs v of the adjoint: not where gaps alone change.
  virtual bool needsDisplacement() const { return true; }
  /// dΦ/ddesign, the same on all ranks. @param response, adjoint of the last design. @note Collective.
  virtual std::vector<double> gradient(const Functional& functional, const Response& response,
                                       const Functional::Adjoint& adjoint) = 0;

  /// What a design adds: to the gaps, or to the bodies; area in the plane, by thickness one. @throws as
  /// apply().
  /// @note Collective.
  virtual double volume(const std::vector<double>& design) = 0;
  virtual std::vector<double> volumeGradient(const std::vector<double>& design) = 0;
  /// Whether volumeGradient() is the same for all designs.
  virtual bool hasLinearVolume() const = 0;
};

/// A functional of the answer at a design: what is to be small.
///
/// Guarded by tests/unit/sensitivity/test_gap_gradients.cpp and test_shape_gradients.cpp.
class ContactCost : public DesignFunction {
 public:
  /// @param sign −1: the functional is to be large.
  ContactCost(feti::FetiSolver& solver, DesignModel& model, const Functional& functional, double sign = 1.0);

  /// Solves, to the larger of the tolerance and that of the solver's parameters; not again for the same
  /// design.
  /// @throws RefusedDesign for designs at which nothing holds the bodies or nothing bears a force;
  /// NumericalError where the solver fails. @note Collective.
  double value(const std::vector<double>& design, double tolerance) override;
  std::vector<double> gradient(const std::vector<double>& design, double tolerance) override;

  /// The answer at the last design of value().
  Response response() const { return {solver_, forces_, model_.geometry()}; }
  /// At the last design of value(). Null: that of the last gradient() was another one.
  const Sensitivities* sensitivities() const { return sensitivities_.get(); }
  const std::vector<double>& design() const { return design_; }
  const std::vector<double>& forces() const { return forces_; }
  const feti::SolveReport& report() const { return report_; }

  /// What was spent so far.
  struct Spent {
    int values = 0, gradients = 0; ///< that took a solution, and a linear one
    int products = 0, adjointProducts = 0;
    double valueSeconds = 0.0, gradientSeconds = 0.0; ///< of this rank
  };
  const Spent& spent() const { return spent_; }

 private:
  double tolerated(double tolerance) const;
  void solve(const std::vector<double>& design, double tolerance);

  feti::FetiSolver& solver_;
  DesignModel& model_;
  const Functional& functional_;
  double sign_;
  std::vector<double> design_; // empty: none is known
  double reached_ = 0.0;       // tolerance
  std::vector<double> forces_;
  std::unique_ptr<Sensitivities> sensitivities_;
  feti::SolveReport report_;
  Spent spent_;
};

/// DesignModel::volume().
class DesignVolume : public DesignFunction {
 public:
  explicit DesignVolume(DesignModel& model) : model_(model) {}
  double value(const std::vector<double>& design, double) override { return model_.volume(design); }
  std::vector<double> gradient(const std::vector<double>& design, double) override {
    return model_.volumeGradient(design);
  }

 private:
  DesignModel& model_;
};

} // namespace Harmos::sensitivity
