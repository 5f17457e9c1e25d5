// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_NormEstimate_def.hpp"
#include "Harmos_VectorOps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
EqualityRows<Scalar, MV, OP>::EqualityRows(const Problem<Scalar, MV, OP>& problem, int mostRows)
    : problem_(problem) {
  if (!isPresent())
    return;
  prepare(mostRows);
  valuesNorm_ = norm<Scalar>(*values_);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::prepare(int mostRows) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Problem<Scalar, MV, OP>& problem = problem_;
  userRows_ = MVT::Clone(*problem.equalityValues(), 1);
  image_ = MVT::Clone(*problem.solution(), 1);
  values_ = MVT::CloneCopy(*problem.equalityValues());
  norm2_ = 1.0;
  orthonormal_ = problem.equalityStructure() != EqualityStructure::General;
  if (orthonormal_) {
    checkOrthonormality();
    if (!problem.faceGram().is_null())
      whole_ = problem.faceGram()->whole();
    return;
  }
  const auto rows = static_cast<int>(MVT::GetGlobalLength(*values_));
  if (rows > mostRows) {
    const std::function<void(const MV&, MV&)> product = [&](const MV& x, MV& y) {
      apply(x, *userRows_);
      MVT::MvInit(y, 0.0);
      addTransposed(1.0, *userRows_, y);
    };
    int products = 0;
    const Teuchos::RCP<MV> start = MVT::Clone(*image_, 1);
    BoundOps<Scalar, MV>::setRandom(*start);
    norm2_ = 1.05 * estimateNorm<Scalar, MV>(product, *start, 20, products);
    return;
  }
  gram_ = gramOf(nullptr);
  for (double entry : gram_)
    finite_ = finite_ && std::isfinite(entry);
  if (!finite_)
    return;
  // Rows of norm 1, so that a short row is not taken for a dependent one.
  const auto size = static_cast<std::size_t>(rows);
  rowScale_.assign(size, 1.0);
  for (std::size_t i = 0; i < size; ++i)
    if (gram_[i * size + i] > 0.0)
      rowScale_[i] = 1.0 / std::sqrt(gram_[i * size + i]);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      gram_[j * size + i] *= rowScale_[i] * rowScale_[j];
  // Its entries are exact to ε: distances between rows below √(100 ε) cannot be told from dependence.
  factors_.emplace_back(gram_, rows, 1e2 * std::numeric_limits<double>::epsilon());
  if (factors_.front().rank() < rows)
    makeBasis();
  else
    factors_.emplace_back(gramOf(nullptr), rows, 0.5);
  orthonormal_ = true;
  BoundTraits<Scalar, MV>::scatter(transform(BoundTraits<Scalar, MV>::gather(*problem.equalityValues())),
                                   *values_);
}

// Of the rows themselves, each divided by its norm.
template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::makeBasis() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  const auto rows = static_cast<int>(rowScale_.size());
  const Teuchos::RCP<MV> vectors = MVT::Clone(*image_, rows), unit = makeVector();
  std::vector<double> e(rowScale_.size(), 0.0);
  for (int k = 0; k < rows; ++k) {
    const auto i = static_cast<std::size_t>(k);
    e[i] = rowScale_[i];
    BT::scatter(e, *unit);
    e[i] = 0.0;
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *unit, *image_, Belos::TRANS);
    MVT::SetBlock(*image_, Teuchos::Range1D(k, k), *vectors);
  }
  basis_ = std::make_shared<const RowBasis<Scalar, MV>>(*vectors);
  factors_ = {basis_->factor()};
}

// CCᵀ, or C̄M_FC̄ᵀ as far as T is there, a column a product.
template<class Scalar, class MV, class OP>
std::vector<double> EqualityRows<Scalar, MV, OP>::gramOf(const std::function<void(MV&)>& weigh) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  const auto rows = static_cast<std::size_t>(MVT::GetGlobalLength(*values_));
  std::vector<double> gram;
  gram.reserve(rows * rows);
  const Teuchos::RCP<MV> unit = makeVector(), column = makeVector(), image = MVT::Clone(*image_, 1);
  std::vector<double> e(rows, 0.0);
  for (std::size_t k = 0; k < rows; ++k) {
    e[k] = 1.0;
    BT::scatter(e, *unit);
    e[k] = 0.0;
    MVT::MvInit(*image, 0.0);
    addTransposed(1.0, *unit, *image);
    if (weigh)
      weigh(*image);
    apply(*image, *column);
    const std::vector<double> entries = BT::gather(*column);
    gram.insert(gram.end(), entries.begin(), entries.end());
  }
  return gram;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<const FaceGram<MV>> EqualityRows<Scalar, MV, OP>::faceGram(const ActiveFace& active,
                                                                        double q) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const bool slips =
      problem_.hasDiscs() &&
      BoundTraits<Scalar, MV>::maximum(*problem_.solution(), active.slipping.empty() ? 0.0 : 1.0) > 0.0;
  if (factors_.empty() && !problem_.faceGram().is_null()) {
    const Teuchos::RCP<MV> free = MVT::Clone(*image_, 1);
    MVT::MvInit(*free, 1.0);
    if (q > 0.0)
      FaceOps<Scalar, MV>::share(active, q, *free);
    if (!slips) {
      FaceOps<Scalar, MV>::mask(*free, active);
      return problem_.faceGram()->build(*free);
    }
    ActiveFace held = active;
    std::replace(held.begin(), held.end(), ActiveFace::slips, ActiveFace::onRim);
    held.slipping.clear();
    FaceOps<Scalar, MV>::mask(*free, held);
    const Teuchos::RCP<const FaceGram<MV>> gram =
        problem_.faceGram()->buildWithSlips(*free, active.slipping, q);
    if (!gram.is_null())
      return gram;
  }
  const auto weigh = [&](MV& v) {
    FaceOps<Scalar, MV>::mask(v, active);
    if (q > 0.0) {
      const Teuchos::RCP<MV> whole = MVT::CloneCopy(v);
      FaceOps<Scalar, MV>::addAtSlips(
          active, [q](double curvature) { return -curvature / (q + curvature); }, *whole, v);
      FaceOps<Scalar, MV>::share(active, q, v);
    }
  };
  return denseGram(gramOf(weigh));
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<const FaceGram<MV>>
EqualityRows<Scalar, MV, OP>::weightedGram(const MV& weights, const std::vector<Slip>& rims) const {
  if (factors_.empty() && !problem_.faceGram().is_null()) {
    const Teuchos::RCP<const FaceGram<MV>> gram =
        problem_.hasDiscs() ? problem_.faceGram()->buildWithSlips(weights, rims, 1.0)
                            : problem_.faceGram()->build(weights);
    if (!gram.is_null())
      return gram;
  }
  ActiveFace tangents;
  tangents.slipping = rims;
  for (Slip& slip : tangents.slipping)
    slip.curvature = 1.0 / (1.0 + slip.curvature);
  return denseGram(gramOf([&](MV& v) {
    const Teuchos::RCP<MV> whole = Belos::MultiVecTraits<Scalar, MV>::CloneCopy(v);
    BoundOps<Scalar, MV>::multiply(weights, v);
    FaceOps<Scalar, MV>::addCurvature(tangents, 1.0, *whole, false, v);
  }));
}

// The rows are orthonormal before they are restricted: pivots are relative to 1.
template<class Scalar, class MV, class OP>
Teuchos::RCP<const FaceGram<MV>> EqualityRows<Scalar, MV, OP>::denseGram(std::vector<double> gram) const {
  const auto rows = static_cast<int>(Belos::MultiVecTraits<Scalar, MV>::GetGlobalLength(*values_));
  return Teuchos::rcp(new DenseFaceGram<Scalar, MV>(
      PivotedCholesky(std::move(gram), rows, 1e2 * std::numeric_limits<double>::epsilon())));
}

template<class Scalar, class MV, class OP>
std::vector<double> EqualityRows<Scalar, MV, OP>::transform(const std::vector<double>& r) const {
  std::vector<double> w = r;
  for (std::size_t i = 0; i < w.size(); ++i)
    w[i] *= rowScale_[i];
  return orthonormalised(w);
}

template<class Scalar, class MV, class OP>
std::vector<double> EqualityRows<Scalar, MV, OP>::orthonormalised(std::vector<double> w) const {
  const std::size_t rows = w.size();
  for (const PivotedCholesky& factor : factors_) {
    w = factor.solveL(w);
    w.resize(rows, 0.0);
  }
  return w;
}

template<class Scalar, class MV, class OP>
std::vector<double> EqualityRows<Scalar, MV, OP>::transformTransposed(const std::vector<double>& w) const {
  std::vector<double> r = w;
  for (auto factor = factors_.rbegin(); factor != factors_.rend(); ++factor) {
    r.resize(static_cast<std::size_t>(factor->rank()));
    r = factor->solveLt(r);
  }
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] *= rowScale_[i];
  return r;
}

// The coefficients of a dependent row, of norm 1, in the rows that it depends on.
template<class Scalar, class MV, class OP>
std::vector<double> EqualityRows<Scalar, MV, OP>::inOthers(std::size_t dependentRow) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  const Teuchos::RCP<MV> unit = makeVector(), part = makeVector(), row = MVT::Clone(*image_, 1);
  std::vector<double> e(rowScale_.size(), 0.0);
  e[dependentRow] = rowScale_[dependentRow];
  BT::scatter(e, *unit);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *unit, *row, Belos::TRANS);
  apply(*row, *part);
  return transformTransposed(BT::gather(*part));
}

template<class Scalar, class MV, class OP>
bool EqualityRows<Scalar, MV, OP>::isConsistent(MV& y, Certificate& certificate) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  if (factors_.empty())
    return true;
  // A dependent row is a combination of the pivot rows, C_i = Σ a_j C_j: with y = e_i − a, Cᵀy = 0 and
  // yᵀ(Cx − c) = −yᵀc for every x. The worst such row, of rows scaled to norm 1, is the proof.
  const std::vector<double> c = BT::gather(*problem_.equalityValues());
  const std::size_t rows = c.size();
  std::vector<double> worst;
  double gap = 0.0;
  const std::vector<int>& pivots = factors_.front().pivots();
  for (auto k = static_cast<std::size_t>(factors_.front().rank()); k < rows; ++k) {
    const auto i = static_cast<std::size_t>(pivots[k]);
    std::vector<double> combination = inOthers(i);
    for (double& value : combination)
      value *= -1.0;
    combination[i] += rowScale_[i];
    double sum = 0.0, absolute = 0.0;
    for (std::size_t j = 0; j < rows; ++j) {
      sum -= combination[j] * c[j];
      absolute += std::abs(combination[j] * c[j]);
    }
    if (std::abs(sum) > std::sqrt(1e2 * std::numeric_limits<double>::epsilon()) * absolute &&
        std::abs(sum) > gap) {
      gap = std::abs(sum);
      worst = combination;
      for (double& value : worst)
        value = sum > 0.0 ? value : -value;
    }
  }
  if (worst.empty())
    return true;
  BT::scatter(worst, y);
  const double length = norm<Scalar>(y);
  MVT::MvScale(y, 1.0 / length);
  const Teuchos::RCP<MV> w = MVT::Clone(*image_, 1);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), y, *w, Belos::TRANS);
  certificate.gap = gap / length;
  certificate.defect = norm<Scalar>(*w);
  return false;
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::checkOrthonormality() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const Teuchos::RCP<MV> unit = makeVector(), back = makeVector();
  setRandom(*unit);
  const double length = norm<Scalar>(*unit);
  MVT::MvInit(*image_, 0.0);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *unit, *image_, Belos::TRANS);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *image_, *back);
  MVT::MvAddMv(1.0, *back, -1.0, *unit, *back);
  const double defect = norm<Scalar>(*back);
  if (std::isfinite(defect) && defect > 1e-6 * length)
    throw InputError("the equality rows are declared orthonormal but are not: ‖CCᵀy − y‖ = " +
                     scientific(defect / length) +
                     " ‖y‖; orthonormalise them or use EqualityStructure::General");
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::setRandom(MV& w) const {
  BoundOps<Scalar, MV>::setRandom(w);
  if (problem_.equalityStructure() == EqualityStructure::General)
    return;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), w, *image_, Belos::TRANS);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *image_, w);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::apply(const MV& x, MV& w) const {
  using BT = BoundTraits<Scalar, MV>;
  if (basis_)
    return basis_->apply(x, w);
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), x, w);
  if (!factors_.empty())
    BT::scatter(transform(BT::gather(w)), w);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::solveFor(const FaceGram<MV>* gram, const MV& x, MV& y,
                                            std::vector<double>& sums) const {
  const FaceGram<MV>* const direct = gram != nullptr ? gram : whole_.get();
  if (direct != nullptr && direct->solveFor(x, y, sums))
    return;
  apply(x, y);
  if (gram != nullptr)
    gram->solve(y);
  if (!sums.empty())
    BoundTraits<Scalar, MV>::sum(x, sums.data(), static_cast<int>(sums.size()));
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::addTransposed(double factor, const MV& w, MV& x) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (basis_)
    return basis_->addTransposed(factor, w, x);
  if (factors_.empty()) {
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), w, *image_, Belos::TRANS);
  } else {
    toUser(w, *userRows_);
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), *userRows_, *image_, Belos::TRANS);
  }
  MVT::MvAddMv(1.0, x, factor, *image_, x);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::residual(const MV& x, MV& r) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using BT = BoundTraits<Scalar, MV>;
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), x, r);
  MVT::MvAddMv(1.0, r, -1.0, *problem_.equalityValues(), r);
  residualNorm_ = norm<Scalar>(r);
  distance_ = residualNorm_ / std::sqrt(norm2_);
  if (factors_.empty())
    return;
  const std::vector<double> entries = BT::gather(r);
  if (basis_) {
    basis_->apply(x, r);
    MVT::MvAddMv(1.0, r, -1.0, *values_, r);
  } else {
    BT::scatter(transform(entries), r);
  }
  distance_ = norm<Scalar>(r);
  for (std::size_t i = 0; i < entries.size(); ++i)
    distance_ = std::max(distance_, std::abs(entries[i]) * rowScale_[i]);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::nearestToZero(MV& x) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  MVT::MvInit(x, 0.0);
  addTransposed(1.0, *values_, x);
  if (orthonormal_)
    return;
  const Teuchos::RCP<MV> image = makeVector();
  apply(x, *image);
  const double length = norm<Scalar>(*image);
  if (length > 0.0)
    MVT::MvScale(x, dot<Scalar>(*image, *values_) / (length * length));
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::toUser(const MV& internal, MV& mu) const {
  using BT = BoundTraits<Scalar, MV>;
  if (factors_.empty())
    Belos::MultiVecTraits<Scalar, MV>::Assign(internal, mu);
  else
    BT::scatter(transformTransposed(BT::gather(internal)), mu);
}

template<class Scalar, class MV, class OP>
void EqualityRows<Scalar, MV, OP>::toInternal(const MV& mu, MV& internal) const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (factors_.empty()) {
    MVT::Assign(mu, internal);
    return;
  }
  // C̄C̄ᵀ = I: μ̄ = C̄Cᵀμ.
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.equalityRows(), mu, *image_, Belos::TRANS);
  apply(*image_, internal);
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<MV> EqualityRows<Scalar, MV, OP>::makeVector() const {
  return Belos::MultiVecTraits<Scalar, MV>::Clone(*problem_.equalityValues(), 1);
}

} // namespace Harmos::qp
