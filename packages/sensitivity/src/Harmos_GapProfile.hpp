// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignModel.hpp"
#include "Harmos_SplineBasis.hpp"

#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace Harmos::sensitivity {

/// Gaps that are functions of a design,
///
///     c_r = c⁰_r + Σ_k α_k φ_k(x_r)
///
/// at the points of some contacts and obstacles: the profile of a surface that is nearly flat, or a shim. No
/// matrix and no coefficient of a row changes: a design costs no factorisation. dΦ/dα_k = Σ_r η_r φ_k(x_r).
///
/// Guarded by tests/unit/sensitivity/test_gap_gradients.cpp.
class GapProfile : public DesignModel {
 public:
  /// A number for each contact point, in the order of their rows.
  /// @param rows those that it has. @param surfaces of the geometry.
  /// @throws InputError on all ranks where the surfaces have no contact points. @note Collective.
  GapProfile(feti::FetiSolver& solver, std::vector<ConstraintRow> rows, RowGeometry geometry,
             std::set<int> surfaces);
  /// Splines. @throws InputError on all ranks for a function that has no contact point. @note Collective.
  GapProfile(feti::FetiSolver& solver, std::vector<ConstraintRow> rows, RowGeometry geometry,
             std::set<int> surfaces, const TensorSplineBasis& basis);

  std::size_t size() const override { return weights_.size(); }
  const std::vector<double>& weights() const override { return weights_; }
  void apply(const std::vector<double>& design) override;
  const std::vector<ConstraintRow>& rows() const override { return rows_; }
  const RowGeometry& geometry() const override { return geometry_; }
  std::vector<double> gradient(const Functional& functional, const Response& response,
                               const Functional::Adjoint& adjoint) override;
  double volume(const std::vector<double>& design) override;
  std::vector<double> volumeGradient(const std::vector<double>&) override { return weights_; }
  bool needsDisplacement() const override { return false; }
  bool hasLinearVolume() const override { return true; }

  /// Σ_k α_k φ_k at the rows of this rank, zero at others than those of the surfaces. Local.
  std::vector<double> profile(const std::vector<double>& design) const;
  /// Σ_r values_r φ_k(x_r) over all ranks. @note Collective.
  std::vector<double> transposed(const std::vector<double>& values) const;
  /// A design, one number a contact point, in which points that are open bear again: each is brought to
  /// touch, and beyond that by as much as gives the one that bears most half the mean pressure; within the
  /// bounds of the space. While a point is open the answer does not depend on its gap, so that optimisers
  /// stop at such designs, however much better they were with the point closed. Nothing where none is open,
  /// or the design is one of splines.
  /// @param response of the design. @throws as Sensitivities::rate(). @note Collective, one linear solution.
  std::optional<std::vector<double>> reclosed(const std::vector<double>& design, const Response& response,
                                              const DesignSpace& space) const;
  /// c⁰ of the rows of this rank.
  const std::vector<double>& gaps() const { return gaps_; }

 private:
  void finish();

  feti::FetiSolver& solver_;
  std::vector<ConstraintRow> rows_;
  RowGeometry geometry_;
  bool isByNodes_ = false;
  std::vector<double> gaps_, weights_;
  std::vector<std::vector<std::pair<std::size_t, double>>> functions_; // of each row: number, value
};

/// The box around the contact points of some surfaces, on all ranks: what splines extend over. @note
/// Collective.
std::pair<fem::Point, fem::Point> extentOfPoints(const Teuchos::Comm<int>& comm, const RowGeometry& geometry,
                                                 const std::set<int>& surfaces);

} // namespace Harmos::sensitivity
