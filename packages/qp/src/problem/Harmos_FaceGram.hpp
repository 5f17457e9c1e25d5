// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveFace.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_PivotedCholesky.hpp"

#include <Teuchos_RCP.hpp>

#include <utility>
#include <vector>

namespace Harmos::qp {

/// C_FC_Fᵀ of the equality rows on one face, factored; C_F has the columns of active entries set to zero.
///
/// @tparam MV vectors of the rows, whole on every rank or in shares.
template<class MV>
class FaceGram {
 public:
  virtual ~FaceGram() = default;

  /// r ← a solution of C_FC_Fᵀy = r, where there is one. @note Collective, if the rows are in shares.
  virtual void solve(MV& r) const = 0;

  /// y ← a solution of C_FC_Fᵀy = Cx, from x itself; `sums` of the ranks are added up over them with the same
  /// messages. False, with nothing done: that would spare none. @note Collective.
  virtual bool solveFor(const MV& /*x*/, MV& /*y*/, std::vector<double>& /*sums*/) const { return false; }
};

/// Makes them for orthonormal rows whose structure is known to the application: where nothing is known, a
/// solver multiplies by C and Cᵀ once for each row and each face.
///
/// Guarded by tests/unit/feti/coarse/test_coarse_space.cpp.
template<class MV>
class FaceGramMaker {
 public:
  virtual ~FaceGramMaker() = default;

  /// With all entries free, where CCᵀ = I; for its solveFor(). Null: nothing is known.
  virtual Teuchos::RCP<const FaceGram<MV>> whole() const { return Teuchos::null; }

  /// @param free 1 at free entries, 0 elsewhere. @note Collective.
  virtual Teuchos::RCP<const FaceGram<MV>> build(const MV& free) const = 0;

  /// The same where pairs slip along their rims: beside what the weights `free` say of their entries, t of
  /// each is free with a weight of q/(q + κ), or one where q = 0. Null: not known. @note Collective.
  virtual Teuchos::RCP<const FaceGram<MV>>
  buildWithSlips(const MV& /*free*/, const std::vector<Slip>& /*slipping*/, double /*q*/) const {
    return Teuchos::null;
  }
};

/// The general one: a dense matrix, of rows that every rank has.
template<class Scalar, class MV>
class DenseFaceGram : public FaceGram<MV> {
 public:
  explicit DenseFaceGram(PivotedCholesky factor) : factor_(std::move(factor)) {}
  void solve(MV& r) const override {
    BoundTraits<Scalar, MV>::scatter(factor_.solve(BoundTraits<Scalar, MV>::gather(r)), r);
  }

 private:
  PivotedCholesky factor_;
};

} // namespace Harmos::qp
