// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ReplicatedCoarse.hpp"

#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Operator.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace Harmos::feti {
namespace {

// G as a Tpetra operator from dual vectors to the replicated coarse map, and its transpose.
class CoarseOperator : public Operator {
 public:
  CoarseOperator(const ReplicatedCoarse& coarse, Teuchos::RCP<const Map> dualMap)
      : coarse_(coarse), dualMap_(std::move(dualMap)) {}
  Teuchos::RCP<const Map> getDomainMap() const override { return dualMap_; }
  Teuchos::RCP<const Map> getRangeMap() const override { return coarse_.coarseMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  const ReplicatedCoarse& coarse_;
  Teuchos::RCP<const Map> dualMap_;
};

void CoarseOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                           Scalar beta) const {
  if (beta == 0.0)
    Y.putScalar(0.0);
  else
    Y.scale(beta);
  for (std::size_t c = 0; c < X.getNumVectors(); ++c) {
    if (mode == Teuchos::NO_TRANS) {
      const std::vector<double> w = coarse_.applyG(X, c);
      const auto view = Y.getLocalViewHost(Tpetra::Access::ReadWrite);
      for (std::size_t k = 0; k < w.size(); ++k)
        view(k, c) += alpha * w[k];
    } else {
      const auto view = X.getLocalViewHost(Tpetra::Access::ReadOnly);
      std::vector<double> w(static_cast<std::size_t>(coarse_.dimension()));
      for (std::size_t k = 0; k < w.size(); ++k)
        w[k] = view(k, c);
      coarse_.addGt(alpha, w, Y, c);
    }
  }
}

// What rank 0 has, on all ranks.
void broadcast(const Teuchos::Comm<int>& comm, std::vector<double>& values) {
  if (!values.empty())
    Teuchos::broadcast<int, double>(comm, 0, static_cast<int>(values.size()), values.data());
}

// The sum over the ranks of numbers of up to these sizes, each rounded once at the end: pieces of 26 bits add
// up without rounding errors.
void sumExactly(const Teuchos::Comm<int>& comm, std::vector<long double>& values,
                const std::vector<double>& sizes) {
  const std::size_t n = values.size();
  std::vector<double> pieces(3 * n);
  for (std::size_t k = 0; k < n; ++k) {
    int exponent = 0;
    std::frexp(sizes[k], &exponent);
    long double rest = values[k];
    for (std::size_t p = 0; p < 2; ++p) {
      const long double unit = std::ldexp(1.0L, exponent - 26 * (static_cast<int>(p) + 1));
      const long double piece = std::nearbyint(rest / unit) * unit;
      pieces[p * n + k] = static_cast<double>(piece);
      rest -= piece;
    }
    pieces[2 * n + k] = static_cast<double>(rest);
  }
  globalSum(comm, pieces);
  broadcast(comm, pieces);
  for (std::size_t k = 0; k < n; ++k)
    values[k] = static_cast<long double>(pieces[k]) + pieces[n + k] + pieces[2 * n + k];
}

void assign(const std::vector<double>& values, MultiVector& y) {
  const auto view = y.getLocalViewHost(Tpetra::Access::OverwriteAll);
  std::copy(values.begin(), values.end(), view.data());
}

// What PDAS needs of G on faces, by the structure of the coarse space.
class ReplicatedFaces : public qp::FaceGramMaker<MultiVector> {
 public:
  explicit ReplicatedFaces(const ReplicatedCoarse& coarse) : coarse_(coarse) {}

  Teuchos::RCP<const qp::FaceGram<MultiVector>> whole() const override {
    return Teuchos::rcp(new Whole(coarse_));
  }
  Teuchos::RCP<const qp::FaceGram<MultiVector>> build(const MultiVector& free) const override {
    return Teuchos::rcp(new Face(coarse_, coarse_.faceFactor(free)));
  }
  Teuchos::RCP<const qp::FaceGram<MultiVector>>
  buildWithSlips(const MultiVector& free, const std::vector<qp::Slip>& slipping, double q) const override {
    return Teuchos::rcp(new Face(coarse_, coarse_.faceFactor(free, slipping, q)));
  }

 private:
  class Face : public qp::FaceGram<MultiVector> {
   public:
    Face(const ReplicatedCoarse& coarse, CoarseFactor factor) : coarse_(coarse), factor_(std::move(factor)) {}
    void solve(MultiVector& r) const override {
      const auto view = r.getLocalViewHost(Tpetra::Access::ReadWrite);
      const std::vector<double> y = coarse_.solveOnFace(factor_, {view.data(), view.data() + view.extent(0)});
      std::copy(y.begin(), y.end(), view.data());
    }
    bool solveFor(const MultiVector& x, MultiVector& y, std::vector<double>& sums) const override {
      assign(coarse_.solveOnFace(factor_, x, sums), y);
      return true;
    }

   private:
    const ReplicatedCoarse& coarse_;
    CoarseFactor factor_;
  };

  class Whole : public qp::FaceGram<MultiVector> {
   public:
    explicit Whole(const ReplicatedCoarse& coarse) : coarse_(coarse) {}
    void solve(MultiVector&) const override {}
    bool solveFor(const MultiVector& x, MultiVector& y, std::vector<double>& sums) const override {
      assign(coarse_.applyG(x, sums), y);
      return true;
    }

   private:
    const ReplicatedCoarse& coarse_;
  };

  const ReplicatedCoarse& coarse_;
};

} // namespace

ReplicatedCoarse::ReplicatedCoarse(const RigidMotions& motions, const Constraints& constraints, int mostDense)
    : CoarseSpace(motions, constraints), dualMap_(constraints.rowMap()), mostDense_(mostDense) {
  makePattern();
  if (constraints.hasWeights())
    makeScale();
  // The entries of G̃G̃ᵀ are known to some ε of its diagonal. A pivot of a hundred times n of these gives a row
  // of G that is noise to a hundredth, and no row: what it stands for is not held. Sums in extended precision
  // know better.
  const double threshold =
      scale_.empty() ? 1e2 * kernelDimension() * std::numeric_limits<double>::epsilon() : 0.0;
  factor_ = factorOf(nullptr, threshold);
  coarseMap_ = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(dimension()), 0, dualMap_->getComm(),
                                    Tpetra::LocallyReplicated));
}

std::vector<char> ReplicatedCoarse::dependentMotions() const {
  std::vector<char> whole(static_cast<std::size_t>(kernelDimension()), 0), own;
  for (int column : factor_.dependent())
    whole[static_cast<std::size_t>(column)] = 1;
  for (int column : ownColumns())
    own.push_back(whole[static_cast<std::size_t>(column)]);
  return own;
}

std::vector<double> ReplicatedCoarse::wholeOf(const std::vector<double>& own) const {
  std::vector<double> whole(static_cast<std::size_t>(kernelDimension()), 0.0);
  for (std::size_t k = 0; k < own.size(); ++k)
    whole[static_cast<std::size_t>(ownColumns()[k])] = own[k];
  globalSum(comm(), whole);
  return whole;
}

std::vector<double> ReplicatedCoarse::ownOf(const std::vector<double>& whole) const {
  std::vector<double> own;
  for (int column : ownColumns())
    own.push_back(whole[static_cast<std::size_t>(column)]);
  return own;
}

std::vector<double> ReplicatedCoarse::solve(const std::vector<double>& e) const {
  return ownOf(solveLt(solveL(wholeOf(e))));
}

Teuchos::RCP<const Operator> ReplicatedCoarse::equalityRows() const {
  if (dimension() == 0)
    return Teuchos::null;
  return Teuchos::rcp(new CoarseOperator(*this, dualMap_));
}

Teuchos::RCP<const qp::FaceGramMaker<MultiVector>> ReplicatedCoarse::faceGram() const {
  return Teuchos::rcp(new ReplicatedFaces(*this));
}

// Places of G̃G̃ᵀ that any rank fills.
void ReplicatedCoarse::makePattern() {
  struct Place {
    int row, column;
  };
  std::vector<Place> sent;
  for (const auto& [row, column] : rows().places())
    sent.push_back({row, column});
  std::vector<std::pair<int, int>> places;
  for (const Place& place : gatherAll(comm(), sent))
    places.emplace_back(place.row, place.column);
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  for (const auto& [row, column] : places) {
    gramRows_.push_back(row);
    gramColumns_.push_back(column);
  }
  for (const auto& place : rows().places())
    gramPlaces_.push_back(
        static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), place) - places.begin()));
}

// √ of the diagonal of G̃G̃ᵀ.
void ReplicatedCoarse::makeScale() {
  scale_.assign(static_cast<std::size_t>(kernelDimension()), 0.0);
  for (std::size_t k = 0; k < rows().values().size(); ++k)
    scale_[static_cast<std::size_t>(rows().columns()[k])] += rows().values()[k] * rows().values()[k];
  globalSum(comm(), scale_);
  broadcast(comm(), scale_);
  for (double& value : scale_)
    value = value > 0.0 ? std::sqrt(value) : 1.0;
}

// G̃M_FG̃ᵀ at the places of the pattern; the same to the last bit on all ranks, whose decisions must agree.
template<class Real>
std::vector<Real> ReplicatedCoarse::gram(const double* mask, const std::vector<qp::Slip>& slipping,
                                         double q) const {
  std::vector<Real> values(gramRows_.size(), 0.0);
  const std::vector<Real> mine = rows().gram<Real>(mask, slipping, q);
  for (std::size_t k = 0; k < mine.size(); ++k)
    values[gramPlaces_[k]] = mine[k];
  if constexpr (std::is_same_v<Real, double>) {
    globalSum(comm(), values);
    broadcast(comm(), values);
  } else {
    std::vector<double> sizes;
    for (std::size_t k = 0; k < values.size(); ++k)
      sizes.push_back(scale_[static_cast<std::size_t>(gramRows_[k])] *
                      scale_[static_cast<std::size_t>(gramColumns_[k])]);
    sumExactly(comm(), values, sizes);
  }
  return values;
}

// Where weights differ by orders of magnitude, what many stiff subdomains do together against soft ones is
// small beside what each does by itself, and would be lost in rounding errors of double precision.
CoarseFactor ReplicatedCoarse::factorOf(const double* mask, double threshold,
                                        const std::vector<qp::Slip>& slipping, double q) const {
  const auto factored = [&](auto values) {
    // Rows that were left out of G are left out on faces.
    for (int column : factor_.dependent())
      for (std::size_t k = 0; k < values.size(); ++k)
        if (gramRows_[k] == column || gramColumns_[k] == column)
          values[k] = 0.0;
    return CoarseFactor(kernelDimension(), gramRows_, gramColumns_, values, threshold, mostDense_, scale_,
                        factor_.rank() > 0 ? &factor_ : nullptr);
  };
  return scale_.empty() ? factored(gram<double>(mask, slipping, q))
                        : factored(gram<long double>(mask, slipping, q));
}

CoarseFactor ReplicatedCoarse::faceFactor(const MultiVector& mask) const {
  return faceFactor(mask, {}, 0.0);
}

CoarseFactor ReplicatedCoarse::faceFactor(const MultiVector& mask, const std::vector<qp::Slip>& slipping,
                                          double q) const {
  // What a face takes away may leave pivots that are nothing but rounding errors.
  constexpr double threshold = 1e2 * std::numeric_limits<double>::epsilon();
  const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
  return factorOf(view.data(), threshold, slipping, q);
}

std::vector<double> ReplicatedCoarse::solveOnFace(const CoarseFactor& face,
                                                  const std::vector<double>& r) const {
  return factor_.multiplyLt(face.solveLt(face.solveL(factor_.multiplyL(r))));
}

std::vector<double> ReplicatedCoarse::minimumNormSolution(const MultiVector& mask,
                                                          const std::vector<double>& own) const {
  const std::vector<double> r = wholeOf(own);
  std::vector<double> values;
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
    values = gram<double>(view.data(), {}, 0.0);
  }
  const double threshold = 1e2 * kernelDimension() * std::numeric_limits<double>::epsilon();
  const CoarseFactor factor(kernelDimension(), gramRows_, gramColumns_, values, threshold, mostDense_, scale_,
                            &factor_);
  const auto solve = [&](const std::vector<double>& b) { return factor.solveLt(factor.solveL(b)); };
  std::vector<double> x = solve(r);
  // Each row left out gives a null vector z: z_d = 1 there, −A⁻A_d at the kept rows. With Z of these columns
  // the least norm is that of x − Z(ZᵀZ)⁻¹Zᵀx, ZᵀZ = I + a Gram matrix: well conditioned. Motions of single
  // bodies touch few entries, and there may be thousands of them: Z is kept sparse.
  const std::vector<int>& dependent = factor.dependent();
  if (dependent.empty())
    return ownOf(x);
  std::vector<std::vector<std::pair<int, double>>> ofColumn(x.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    ofColumn[static_cast<std::size_t>(gramColumns_[k])].emplace_back(gramRows_[k], values[k]);
    if (gramRows_[k] != gramColumns_[k])
      ofColumn[static_cast<std::size_t>(gramRows_[k])].emplace_back(gramColumns_[k], values[k]);
  }
  std::vector<std::vector<std::pair<int, double>>> nullVectors, atRow(x.size());
  std::vector<int> rows, columns;
  std::vector<double> products, touched(dependent.size(), 0.0), moments(dependent.size(), 0.0);
  for (std::size_t v = 0; v < dependent.size(); ++v) {
    std::vector<double> column(x.size(), 0.0);
    for (const auto& [row, value] : ofColumn[static_cast<std::size_t>(dependent[v])])
      column[static_cast<std::size_t>(row)] = value;
    const std::vector<double> solved = solve(column);
    std::vector<std::pair<int, double>> z;
    for (std::size_t k = 0; k < solved.size(); ++k) {
      const double entry = static_cast<int>(k) == dependent[v] ? 1.0 : -solved[k];
      // Beside the one; what falls below is lost in rounding anyway.
      if (std::abs(entry) > std::numeric_limits<double>::epsilon())
        z.emplace_back(static_cast<int>(k), entry);
    }
    std::vector<std::size_t> met;
    for (const auto& [k, entry] : z) {
      moments[v] += entry * x[static_cast<std::size_t>(k)];
      atRow[static_cast<std::size_t>(k)].emplace_back(static_cast<int>(v), entry);
      for (const auto& [other, value] : atRow[static_cast<std::size_t>(k)]) {
        if (touched[static_cast<std::size_t>(other)] == 0.0)
          met.push_back(static_cast<std::size_t>(other));
        touched[static_cast<std::size_t>(other)] += entry * value;
      }
    }
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    for (std::size_t other : met) {
      rows.push_back(static_cast<int>(v));
      columns.push_back(static_cast<int>(other));
      products.push_back(touched[other]);
      touched[other] = 0.0;
    }
    nullVectors.push_back(std::move(z));
  }
  const CoarseFactor gramOfNull(static_cast<int>(dependent.size()), rows, columns, products, threshold,
                                mostDense_);
  const std::vector<double> y = gramOfNull.solveLt(gramOfNull.solveL(moments));
  for (std::size_t v = 0; v < nullVectors.size(); ++v)
    for (const auto& [k, entry] : nullVectors[v])
      x[static_cast<std::size_t>(k)] -= y[v] * entry;
  return ownOf(x);
}

std::vector<double> ReplicatedCoarse::solveOnFace(const CoarseFactor& face, const MultiVector& lambda,
                                                  std::vector<double>& sums) const {
  return factor_.multiplyLt(face.solveLt(face.solveL(applyUnscaled(lambda, 0, sums))));
}

std::vector<double> ReplicatedCoarse::applyUnscaled(const MultiVector& lambda, std::size_t column) const {
  std::vector<double> none;
  return applyUnscaled(lambda, column, none);
}

std::vector<double> ReplicatedCoarse::applyUnscaled(const MultiVector& lambda, std::size_t column,
                                                    std::vector<double>& sums) const {
  std::vector<double> w(static_cast<std::size_t>(kernelDimension()), 0.0);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r + 1 < rows().offsets().size(); ++r)
    for (std::size_t k = rows().offsets()[r]; k < rows().offsets()[r + 1]; ++k)
      w[static_cast<std::size_t>(rows().columns()[k])] += rows().values()[k] * view(r, column);
  const auto size = static_cast<std::ptrdiff_t>(w.size());
  w.insert(w.end(), sums.begin(), sums.end());
  globalSum(comm(), w);
  std::copy(w.begin() + size, w.end(), sums.begin());
  w.resize(static_cast<std::size_t>(size));
  return w;
}

std::vector<double> ReplicatedCoarse::applyG(const MultiVector& lambda, std::size_t column) const {
  return solveL(applyUnscaled(lambda, column));
}

std::vector<double> ReplicatedCoarse::applyG(const MultiVector& lambda, std::vector<double>& sums) const {
  return solveL(applyUnscaled(lambda, 0, sums));
}

void ReplicatedCoarse::addGt(double factor, const std::vector<double>& w, MultiVector& lambda,
                             std::size_t column) const {
  const std::vector<double> s = solveLt(w);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r + 1 < rows().offsets().size(); ++r) {
    double sum = 0.0;
    for (std::size_t k = rows().offsets()[r]; k < rows().offsets()[r + 1]; ++k)
      sum += rows().values()[k] * s[static_cast<std::size_t>(rows().columns()[k])];
    view(r, column) += factor * sum;
  }
}

void ReplicatedCoarse::project(MultiVector& v) const {
  if (dimension() == 0)
    return;
  for (std::size_t c = 0; c < v.getNumVectors(); ++c)
    addGt(-1.0, applyG(v, c), v, c);
}

} // namespace Harmos::feti
