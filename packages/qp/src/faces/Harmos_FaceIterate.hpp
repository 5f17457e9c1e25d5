// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EqualityRows.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <Teuchos_RCP.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

/// The level of rounding errors of a gradient that is carried along: ε(‖A‖‖x‖ + ‖b‖ + ‖κx‖) of the largest x
/// since it was computed anew.
struct RoundingLevel {
  double curvatureBound = 0.0; ///< the largest curvature pᵀAp/pᵀp met so far: a lower bound of ‖A‖
  double rhsNorm = 0.0;
  double iterateNorm = 0.0, springNorm = 0.0; ///< ‖x‖, ‖κx‖
  double value = 0.0;
  int staleness = 0; ///< steps since then

  /// What overflows says nothing of A, and would be believed on all faces to come.
  void raiseCurvatureBound(double curvature) {
    if (std::isfinite(curvature))
      curvatureBound = std::max(curvatureBound, curvature);
  }
  /// Of an x of this norm.
  void raise(double iterateNorm2) {
    iterateNorm = std::sqrt(iterateNorm2);
    value = std::max(value, of(springNorm));
  }
  /// Of this x, had it springs of this norm.
  double of(double springs) const {
    return std::numeric_limits<double>::epsilon() * (curvatureBound * iterateNorm + rhsNorm + springs);
  }
  template<class Archive>
  void exchange(Archive& archive) {
    archive.number("cg curvature bound", curvatureBound);
    archive.number("cg load", rhsNorm);
    archive.number("cg springs", springNorm);
    archive.number("cg iterate", iterateNorm);
    archive.number("cg rounding level", value);
    archive.number("cg staleness", staleness);
  }
};

/// How far an iterate is from the equalities, when it was looked: steps stay in the kernel of the rows, until
/// rounding errors of many of them count.
template<class Scalar, class MV, class OP>
class RowDistance {
 public:
  explicit RowDistance(EqualityRows<Scalar, MV, OP>& rows) : rows_(rows) {
    if (rows.isPresent())
      work_ = rows.makeVector();
  }

  /// @note Collective, a product with C.
  void look(const MV& x) {
    if (rows_.isPresent()) {
      rows_.residual(x, *work_);
      keep();
    }
  }
  /// Of the product that the rows have just made.
  void keep() {
    residual_ = rows_.residualNorm();
    distance_ = rows_.distance();
    hasLooked_ = true;
  }
  void invalidate() { hasLooked_ = false; }
  /// Whether no step was taken since it was looked.
  bool hasLooked() const { return hasLooked_ || !rows_.isPresent(); }
  double residual() const { return residual_; }
  double distance() const { return distance_; }

  void exchange(StateArchive<MV>& archive) {
    archive.number("cg equality residual", residual_);
    archive.number("cg equality distance", distance_);
    archive.number("cg has looked", hasLooked_);
  }

 private:
  EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> work_;
  double residual_ = 0.0, distance_ = 0.0; // ‖Cx − c‖; see EqualityRows
  bool hasLooked_ = false;
};

/// A point on a face, and what is known there. The gradient is carried along projected, too: the part that is
/// projected away stays large while the rest vanishes, and would spoil it by cancellation.
template<class Scalar, class MV, class OP>
struct FaceIterate {
  Teuchos::RCP<MV> x;
  Teuchos::RCP<MV> w;           ///< P_F(Ax − b), curvatures included
  Teuchos::RCP<MV> gradient;    ///< Ax − b, curvatures included; null where a problem has no faces
  Teuchos::RCP<MV> removed;     ///< what C̄_Fᵀ took away adds up to −μ̄; null without rows
  Teuchos::RCP<MV> rowResidual; ///< C̄x − c̄, which is a part of the residual where limits follow
  double residual2 = 0.0;       ///< ‖w‖², and of the row residual its share
  bool isSettled = true;        ///< the gradient is Ax − b, not up to the range of C̄ᵀ
  RoundingLevel level;
  RowDistance<Scalar, MV, OP> distance;
};

} // namespace Harmos::qp
