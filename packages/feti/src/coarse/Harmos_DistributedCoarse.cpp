// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DistributedCoarse.hpp"

#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>
#include <Tpetra_Vector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

double lengthOf(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

void subtract(std::vector<double>& from, const std::vector<double>& what) {
  for (std::size_t k = 0; k < from.size(); ++k)
    from[k] -= what[k];
}

// GᵀG, and on its range its transpose.
class InDualSpace : public Operator {
 public:
  InDualSpace(const CoarseSpace& coarse, Teuchos::RCP<const Map> map)
      : coarse_(coarse), map_(std::move(map)) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return map_; }
  Teuchos::RCP<const Map> getRangeMap() const override { return map_; }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
             Scalar beta) const override {
    if (beta == 0.0)
      Y.putScalar(0.0);
    else
      Y.scale(beta);
    if (mode != Teuchos::NO_TRANS) {
      Y.update(alpha, X, 1.0);
      return;
    }
    for (std::size_t c = 0; c < X.getNumVectors(); ++c)
      coarse_.addTransposed(alpha, coarse_.solve(coarse_.multiply(X, c)), Y, c);
  }

 private:
  const CoarseSpace& coarse_;
  Teuchos::RCP<const Map> map_;
};

class DistributedFaces : public qp::FaceGramMaker<MultiVector> {
 public:
  explicit DistributedFaces(const DistributedCoarse& coarse) : coarse_(coarse) {}

  Teuchos::RCP<const qp::FaceGram<MultiVector>> whole() const override {
    return Teuchos::rcp(new Whole(coarse_));
  }
  Teuchos::RCP<const qp::FaceGram<MultiVector>> build(const MultiVector& free) const override {
    return buildWithSlips(free, {}, 0.0);
  }
  Teuchos::RCP<const qp::FaceGram<MultiVector>>
  buildWithSlips(const MultiVector& free, const std::vector<qp::Slip>& slipping, double q) const override {
    // What a face takes away may leave pivots that are nothing but rounding errors.
    const double threshold = std::max(1e2, static_cast<double>(coarse_.kernelDimension())) * epsilon;
    return Teuchos::rcp(new Face(coarse_, coarse_.faceFactor(free, slipping, q, threshold)));
  }

 private:
  class Face : public qp::FaceGram<MultiVector> {
   public:
    Face(const DistributedCoarse& coarse, DistributedFactor factor)
        : coarse_(coarse), factor_(std::move(factor)) {}
    void solve(MultiVector& r) const override {
      const std::vector<double> s = coarse_.solveWith(factor_, coarse_.multiply(r));
      r.putScalar(0.0);
      coarse_.addTransposed(1.0, s, r);
    }
    // GᵀG in front of it would be of no use: G̃GᵀG = G̃.
    bool solveFor(const MultiVector& x, MultiVector& y, std::vector<double>& sums) const override {
      const std::vector<double> s = coarse_.solveWith(factor_, coarse_.multiply(x), sums);
      y.putScalar(0.0);
      coarse_.addTransposed(1.0, s, y);
      return true;
    }

   private:
    const DistributedCoarse& coarse_;
    DistributedFactor factor_;
  };

  class Whole : public qp::FaceGram<MultiVector> {
   public:
    explicit Whole(const DistributedCoarse& coarse) : coarse_(coarse) {}
    void solve(MultiVector&) const override {}
    bool solveFor(const MultiVector& x, MultiVector& y, std::vector<double>& sums) const override {
      const std::vector<double> s = coarse_.solve(coarse_.multiply(x), sums);
      y.putScalar(0.0);
      coarse_.addTransposed(1.0, s, y);
      return true;
    }

   private:
    const DistributedCoarse& coarse_;
  };

  const DistributedCoarse& coarse_;
};

} // namespace

DistributedCoarse::DistributedCoarse(const RigidMotions& motions, const Constraints& constraints,
                                     const CoarseOptions& options)
    : CoarseSpace(motions, constraints),
      dualMap_(constraints.rowMap()),
      shape_(shapeOf(motions)),
      isScaled_(constraints.hasWeights()),
      inverse_(options.inverse) {
  const auto own = static_cast<int>(ownColumns().size());
  if (isScaled_) {
    scale_ = diagonal();
    for (double& value : scale_)
      value = value > 0.0 ? std::sqrt(value) : 1.0;
    touchedScale_ = atTouched(scale_);
  }
  // Numbers by rank, in which neighbours are near each other.
  const auto first = static_cast<double>(exclusiveScan(comm(), own));
  std::vector<double> numbers;
  for (int k = 0; k < own; ++k)
    numbers.push_back(first + k);
  const std::vector<double> touched = atTouched(numbers);
  std::vector<std::pair<int, int>> entries;
  const auto placeOf = [&](int column) {
    const std::vector<int>& list = touchedColumns();
    return static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), column) - list.begin());
  };
  for (const auto& [row, column] : rows().places()) {
    rowAt_.push_back(placeOf(row));
    columnAt_.push_back(placeOf(column));
    entries.emplace_back(static_cast<int>(touched[rowAt_.back()]),
                         static_cast<int>(touched[columnAt_.back()]));
  }
  graph_ = std::make_unique<DistributedGraph>(
      communicator(), own, entries, options.groupRanks > 0 ? options.groupRanks : coarseGroup(shape_));
  DistributedFactor::Options how;
  how.form = formOf(false);
  // See ReplicatedCoarse; scaled matrices are well enough known to their diagonals' rounding errors.
  how.threshold = (!isScaled_ ? 1e2 : 1e1) * kernelDimension() * epsilon;
  factor_ = std::make_unique<DistributedFactor>(*graph_, gram(nullptr, {}, 0.0), how);
  if (dimension() == 0)
    return;
  inaccuracy_ = measuredInaccuracy();
  constexpr double enough = 1e-12, hopeless = 1e-6;
  isRefined_ = inaccuracy_ > enough;
  if (isRefined_) {
    const double left = measuredInaccuracy();
    if (!(left <= hopeless))
      throw NumericalError("the coarse problem is too ill-conditioned for the distributed factorisation: a "
                           "projection leaves a relative residual of " +
                           scientific(left) + "; set \"Decomposition/Coarse problem\" = \"replicated\"");
  }
  smallestPivotRatio_ = estimatedPivotRatio();
}

DistributedFactor::Form DistributedCoarse::formOf(bool isFace) const {
  using Inverse = CoarseOptions::Inverse;
  const bool isSolved = inverse_ == Inverse::Auto ? coarseSolves(shape_, graph_->groupSize(), isFace)
                                                  : inverse_ == Inverse::Solves;
  return isSolved ? DistributedFactor::Form::Solves : DistributedFactor::Form::Rows;
}

std::vector<char> DistributedCoarse::dependentMotions() const {
  std::vector<char> is;
  for (int k = 0; k < graph_->own(); ++k)
    is.push_back(factor_->isLeftOut(graph_->first() + k));
  return is;
}

std::string DistributedCoarse::description() const {
  const bool isRows = factor_->form() == DistributedFactor::Form::Rows;
  return "distributed, factored by groups of " + std::to_string(graph_->groupSize()) +
         (graph_->groupSize() == 1 ? " rank, " : " ranks, ") +
         (isRows ? "each rank with its rows of the inverse" : "solved by the groups") +
         (isRefined_ ? ", refined" : "");
}

// Of A_F, or of that divided by scales, at this rank's places.
std::vector<double> DistributedCoarse::gram(const double* mask, const std::vector<qp::Slip>& slipping,
                                            double q) const {
  if (!isScaled_)
    return rows().gram<double>(mask, slipping, q);
  const std::vector<long double> sums = rows().gram<long double>(mask, slipping, q);
  std::vector<double> values;
  for (std::size_t k = 0; k < sums.size(); ++k)
    values.push_back(static_cast<double>(
        sums[k] / (static_cast<long double>(touchedScale_[rowAt_[k]]) * touchedScale_[columnAt_[k]])));
  return values;
}

DistributedFactor DistributedCoarse::faceFactor(const MultiVector& mask,
                                                const std::vector<qp::Slip>& slipping, double q,
                                                double threshold) const {
  std::vector<double> values;
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
    values = gram(view.data(), slipping, q);
  }
  DistributedFactor::Options how;
  how.form = formOf(true);
  how.threshold = threshold;
  how.leftOut = factor_->leftOut(); // of G: on faces, too
  return {*graph_, values, how};
}

std::vector<double> DistributedCoarse::solveWith(const DistributedFactor& factor,
                                                 const std::vector<double>& e,
                                                 std::vector<double>& sums) const {
  if (!isScaled_)
    return factor.solve(e, sums);
  std::vector<double> scaled = e;
  for (std::size_t k = 0; k < e.size(); ++k)
    scaled[k] /= scale_[k];
  scaled = factor.solve(scaled, sums);
  for (std::size_t k = 0; k < e.size(); ++k)
    scaled[k] /= scale_[k];
  return scaled;
}

std::vector<double> DistributedCoarse::product(const std::vector<double>& s, const MultiVector* mask) const {
  MultiVector forces(dualMap_, 1);
  addTransposed(1.0, s, forces);
  if (mask != nullptr)
    forces.elementWiseMultiply(1.0, *mask->getVector(0), forces, 0.0);
  return multiply(forces);
}

std::vector<double> DistributedCoarse::solve(const std::vector<double>& e) const {
  std::vector<double> none;
  return solve(e, none);
}

std::vector<double> DistributedCoarse::solve(const std::vector<double>& e, std::vector<double>& sums) const {
  std::vector<double> s = solveWith(*factor_, e, sums);
  if (isRefined_) {
    std::vector<double> left = e;
    subtract(left, product(s, nullptr));
    const std::vector<double> more = solveWith(*factor_, left);
    for (std::size_t k = 0; k < s.size(); ++k)
      s[k] += more[k];
  }
  return s;
}

void DistributedCoarse::project(MultiVector& v) const {
  if (dimension() == 0)
    return;
  for (std::size_t c = 0; c < v.getNumVectors(); ++c)
    addTransposed(-1.0, solve(multiply(v, c)), v, c);
}

Teuchos::RCP<const Operator> DistributedCoarse::equalityRows() const {
  if (dimension() == 0)
    return Teuchos::null;
  return Teuchos::rcp(new InDualSpace(*this, dualMap_));
}

Teuchos::RCP<const qp::FaceGramMaker<MultiVector>> DistributedCoarse::faceGram() const {
  return Teuchos::rcp(new DistributedFaces(*this));
}

// What P leaves of a vector of the range of G̃ᵀ, which it should take away.
double DistributedCoarse::measuredInaccuracy() const {
  MultiVector v(dualMap_, 1);
  qp::BoundOps<Scalar, MultiVector>::setRandom(v);
  const std::vector<double> s = multiply(v); // of no special direction
  v.putScalar(0.0);
  addTransposed(1.0, s, v);
  const double size = lengthOf(v);
  project(v);
  return size > 0.0 ? lengthOf(v) / size : 0.0;
}

// A pivot that comes last is 1/(A⁻¹)_jj.
double DistributedCoarse::estimatedPivotRatio() const {
  double largest = 0.0, inverse = factor_->largestDiagonal();
  const std::vector<double> all = !isScaled_ ? diagonal() : std::vector<double>(scale_.size(), 1.0);
  for (double value : all)
    largest = std::max(largest, value);
  largest = globalMax(comm(), largest);
  if (factor_->form() == DistributedFactor::Form::Solves) {
    // Inverse iteration in its place.
    constexpr int steps = 4;
    std::vector<double> s(ownColumns().size(), 0.0);
    for (std::size_t k = 0; k < s.size(); ++k)
      s[k] = std::sin(1.0 + ownColumns()[k]);
    for (int step = 0; step < steps; ++step) {
      const double before = norm(s);
      s = factor_->solve(s);
      const double after = norm(s);
      inverse = before > 0.0 ? after / before : 0.0;
      for (double& value : s)
        value /= after > 0.0 ? after : 1.0;
    }
  }
  inverse = globalMax(comm(), inverse);
  return inverse > 0.0 && largest > 0.0 ? 1.0 / (inverse * largest) : 1.0;
}

std::vector<double> DistributedCoarse::minimumNormSolution(const MultiVector& mask,
                                                           const std::vector<double>& r) const {
  const double threshold = 1e2 * kernelDimension() * epsilon;
  DistributedFactor::Options how;
  how.form = DistributedFactor::Form::Solves; // there are few
  how.threshold = threshold;
  std::vector<double> values;
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
    values = gram(view.data(), {}, 0.0);
  }
  const DistributedFactor factor(*graph_, values, how);
  std::vector<double> x = solveWith(factor, r);
  if (factor.leftOut().empty())
    return x;
  // Each row left out gives a null vector, 1 there and −A⁻A_d at the kept rows. With Z of these columns the
  // least norm is that of x − Z(ZᵀZ)⁻¹Zᵀx, ZᵀZ = I + a Gram matrix: by conjugate gradients.
  std::vector<char> isOut;
  for (int k = 0; k < graph_->own(); ++k)
    isOut.push_back(factor.isLeftOut(graph_->first() + k));
  const auto onlyOut = [&](std::vector<double> v, bool out) {
    for (std::size_t k = 0; k < v.size(); ++k)
      if ((isOut[k] != 0) != out)
        v[k] = 0.0;
    return v;
  };
  const auto apply = [&](const std::vector<double>& c) { // Zc
    std::vector<double> v = solveWith(factor, onlyOut(product(c, &mask), false));
    for (std::size_t k = 0; k < v.size(); ++k)
      v[k] = c[k] - v[k];
    return v;
  };
  const auto applyTransposed = [&](const std::vector<double>& v) { // Zᵀv
    std::vector<double> result = onlyOut(v, true);
    subtract(result, onlyOut(product(solveWith(factor, onlyOut(v, false)), &mask), true));
    return result;
  };
  const auto dot = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
      sum += a[k] * b[k];
    return globalSum(comm(), sum);
  };
  std::vector<double> residual = applyTransposed(x), y(x.size(), 0.0), p = residual;
  double rr = dot(residual, residual);
  const double target = rr * 1e-28; // rounding errors of what Z is made of
  constexpr int mostSteps = 500;
  for (int step = 0; step < mostSteps && rr > target; ++step) {
    const std::vector<double> image = applyTransposed(apply(p));
    const double length = rr / dot(p, image);
    for (std::size_t k = 0; k < y.size(); ++k) {
      y[k] += length * p[k];
      residual[k] -= length * image[k];
    }
    const double next = dot(residual, residual);
    for (std::size_t k = 0; k < y.size(); ++k)
      p[k] = residual[k] + next / rr * p[k];
    rr = next;
  }
  subtract(x, apply(y));
  return x;
}

} // namespace Harmos::feti
