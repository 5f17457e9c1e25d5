// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FaceOps.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_VectorOps.hpp"

#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>

#include <cmath>
#include <functional>

namespace Harmos::qp {

/// z = (M⁻¹φ)_F for whatever form of preconditioner a problem has; counts what it does.
///
/// Exact: made for the face by the problem's FacePreconditioner, again when the face has changed.
/// Approximate: the problem's one operator for all entries, restricted to the free ones.
template<class Scalar, class MV, class OP>
class InFacePreconditioner {
 public:
  InFacePreconditioner(const Problem<Scalar, MV, OP>& problem, Counters& counters)
      : problem_(problem), counters_(counters) {}

  bool isPresent() const { return problem_.hasPreconditioner(); }

  /// To be called when the face has changed.
  void invalidate() { forFace_ = Teuchos::null; }

  /// @param phi zero on active entries, and so is the result. @note Collective.
  void apply(const MV& phi, const ActiveFace& active, MV& z) {
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    ++counters_.preconditionerApplications;
    if (problem_.facePreconditioner().is_null()) {
      Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.preconditioner(), phi, z);
    } else {
      if (forFace_.is_null()) {
        if (mask_.is_null())
          mask_ = MVT::Clone(phi, 1);
        // Without bounds there is no active set, and all entries are free.
        MVT::MvInit(*mask_, 1.0);
        FaceOps<Scalar, MV>::mask(*mask_, active);
        forFace_ = problem_.facePreconditioner()->build(*mask_);
        ++counters_.preconditionerSetups;
      }
      Belos::OperatorTraits<Scalar, MV, OP>::Apply(*forFace_, phi, z);
    }
    FaceOps<Scalar, MV>::mask(z, active);
  }

  /// Where pairs slip, and at springs, A gets their curvatures κ, and its inverse is about
  ///
  ///     z = TM⁻¹Tφ + (I − T)Tq⁻¹φ,   T = q/(q + κ),
  ///
  /// q for the diagonal of A: exact where A is diagonal, and for what one pair does to others. M = q where a
  /// problem has no preconditioner. @note Collective.
  void applySoftened(const MV& phi, const ActiveFace& active, double q, MV& z) {
    using MVT = Belos::MultiVecTraits<Scalar, MV>;
    using Faces = FaceOps<Scalar, MV>;
    const auto change = [q](double curvature) { return -curvature / (q + curvature); };
    const Teuchos::RCP<MV> softened = MVT::CloneCopy(phi);
    Faces::addAtSlips(active, change, phi, *softened);
    FaceOps<Scalar, MV>::soften(active, q, *softened);
    if (isPresent())
      apply(*softened, active, z);
    else
      MVT::MvAddMv(1.0 / q, *softened, 0.0, *softened, z);
    MVT::Assign(z, *softened);
    Faces::addAtSlips(active, change, *softened, z);
    FaceOps<Scalar, MV>::soften(active, q, z);
    FaceOps<Scalar, MV>::addStiff(active, q, phi, z);
    Faces::addAtSlips(
        active, [q](double curvature) { return curvature / std::pow(q + curvature, 2); }, phi, z);
  }

 private:
  const Problem<Scalar, MV, OP>& problem_;
  Counters& counters_;
  Teuchos::RCP<const OP> forFace_;
  Teuchos::RCP<MV> mask_;
};

} // namespace Harmos::qp
