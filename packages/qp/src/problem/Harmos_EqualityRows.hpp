// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_QpProblem.hpp"
#include "Harmos_QpTypes.hpp"
#include "Harmos_RowBasis.hpp"

#include <Teuchos_RCP.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace Harmos::qp {

/// The equality rows as the solvers use them: C̄ = TC, c̄ = Tc with orthonormal rows, C̄C̄ᵀ = I.
///
/// Rows that are known to be orthonormal are taken as they are (T = I). Others are orthonormalised with the
/// dense CCᵀ, found by a product with C and Cᵀ for each row: LLᵀ = CCᵀ by Cholesky with complete pivoting,
/// done twice so that C̄C̄ᵀ = I to rounding also for ill-conditioned rows (Giraud, Langou, Rozložník: the loss
/// of orthogonality in the Gram-Schmidt orthogonalization process, 2005). CCᵀ tells rows that differ by less
/// than √(100 ε) not from dependent ones: where it leaves rows out, a RowBasis of the rows themselves
/// decides, and leaves out what depends on others to rounding. Penalties and projectors then do not depend on
/// how a user scales or repeats rows. Beyond `mostRows` rows it would cost too much; such rows are used as
/// they stand (isOrthonormal() tells).
///
/// Residuals are reported in the user's rows: residualNorm() is ‖Cx − c‖.
///
/// Guarded by tests/unit/qp/test_hard_problems.cpp.
template<class Scalar, class MV, class OP>
class EqualityRows {
 public:
  /// @throws InputError if rows said to be orthonormal are not (seen on one vector).
  /// @note Collective. The problem is to outlive this.
  EqualityRows(const Problem<Scalar, MV, OP>& problem, int mostRows);

  /// False if an entry of CCᵀ is no number.
  bool isFinite() const { return finite_; }
  bool isPresent() const { return problem_.hasEqualities(); }
  bool isOrthonormal() const { return orthonormal_; }
  /// Whether A maps ker C̄ into itself as well as the range of C̄ᵀ.
  bool isInvariant() const { return problem_.equalityStructure() == EqualityStructure::OrthonormalInvariant; }
  /// ‖C̄‖², estimated if the rows are used as they stand.
  double norm2() const { return norm2_; }

  /// Whether Cx = c has a solution at all, bounds aside; false with the proof.
  /// @param y receives the vector of the proof, in the range of C.
  bool isConsistent(MV& y, Certificate& certificate) const;

  /// w = C̄x. @note Collective.
  void apply(const MV& x, MV& w) const;
  /// x ← x + factor·C̄ᵀw.
  void addTransposed(double factor, const MV& w, MV& x) const;
  /// y ← (C̄_FC̄_Fᵀ)⁻C̄x; `sums` of the ranks are added up over them, at no messages of their own where the rows
  /// know how: see FaceGram::solveFor(). @param gram null: all entries are free, and rows orthonormal.
  /// @note Collective.
  void solveFor(const FaceGram<MV>* gram, const MV& x, MV& y, std::vector<double>& sums) const;
  /// r = C̄x − c̄; keeps ‖Cx − c‖ for residualNorm(). @note Collective.
  void residual(const MV& x, MV& r);
  double residualNorm() const { return residualNorm_; }
  /// ‖C̄x − c̄‖ of the last residual(), or |C_ix − c_i|/‖C_i‖ where a row, taken for dependent, is further off;
  /// in units of ‖C‖ for rows used as they stand.
  double distance() const { return distance_; }
  /// x ← the point with C̄x = c̄ next to zero, C̄ᵀc̄; of rows used as they stand, the one next to them along Cᵀc.
  void nearestToZero(MV& x) const;
  const MV& values() const { return *values_; }
  /// ‖c̄‖.
  double valuesNorm() const { return valuesNorm_; }

  /// μ̄ with C̄ᵀμ̄ = Cᵀμ, and μ with Cᵀμ = C̄ᵀμ̄.
  void toInternal(const MV& mu, MV& internal) const;
  void toUser(const MV& internal, MV& mu) const;

  Teuchos::RCP<MV> makeVector() const;
  /// A vector of the range of C̄, in which all others are; see EqualityStructure. @note Collective.
  void setRandom(MV& w) const;

  /// C̄M_FC̄ᵀ factored, M_F the mask of the free entries; needs orthonormal rows. @note Collective.
  /// @param q see FaceGramMaker::buildWithSlips(); springs have their share then, see SpringOps.
  Teuchos::RCP<const FaceGram<MV>> faceGram(const ActiveFace& active, double q = 0.0) const;
  /// C̄DC̄ᵀ for any D, at a product with C̄ and C̄ᵀ a row. @param weigh v ← Dv.
  Teuchos::RCP<const FaceGram<MV>> gramWith(const std::function<void(MV&)>& weigh) const {
    return denseGram(gramOf(weigh));
  }
  /// The same for weights in [0, 1] in the place of the mask, and of tangents 1/(1 + κ) more.
  /// @note Collective.
  Teuchos::RCP<const FaceGram<MV>> weightedGram(const MV& weights, const std::vector<Slip>& rims = {}) const;

 private:
  void prepare(int mostRows);
  void checkOrthonormality();
  void makeBasis();
  std::vector<double> inOthers(std::size_t dependentRow) const;
  std::vector<double> gramOf(const std::function<void(MV&)>& weigh) const;
  Teuchos::RCP<const FaceGram<MV>> denseGram(std::vector<double> gram) const;
  std::vector<double> orthonormalised(std::vector<double> scaled) const;
  std::vector<double> transform(const std::vector<double>& r) const;
  std::vector<double> transformTransposed(const std::vector<double>& w) const;

  const Problem<Scalar, MV, OP>& problem_;
  Teuchos::RCP<MV> values_, userRows_, image_;
  Teuchos::RCP<const FaceGram<MV>> whole_; // or null
  // T = L₂⁻¹L₁⁻¹ diag(1/‖C_i‖) where rows were orthonormalised, of the pivot rows; zero elsewhere.
  std::vector<PivotedCholesky> factors_;
  std::vector<double> rowScale_;                      // 1/‖C_i‖
  std::vector<double> gram_;                          // of the scaled rows
  std::shared_ptr<const RowBasis<Scalar, MV>> basis_; // where CCᵀ does not tell; null: it does
  bool orthonormal_ = false;
  double norm2_ = 0.0;
  double valuesNorm_ = 0.0;
  double residualNorm_ = 0.0;
  double distance_ = 0.0;
  bool finite_ = true;
};

} // namespace Harmos::qp
