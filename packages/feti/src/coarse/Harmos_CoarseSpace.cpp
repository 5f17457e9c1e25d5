// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseSpace.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <type_traits>

namespace Harmos::feti {
namespace {

struct CoarseEntry {
  long long row;
  double value;
  int column;
};

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

} // namespace

CoarseSpace::CoarseSpace(const SubdomainSystem& system, const Constraints& constraints, int mostDense)
    : comm_(system.comm()), kernelDimension_(system.kernelDimension()), mostDense_(mostDense) {
  // Each subdomain makes its rows of G̃; the entries go to the ranks that own the dual rows. A motion along a
  // surface leaves rounding errors there, which hold nothing; where nothing else holds it, they would be the
  // largest entries of all.
  constexpr double rounding = 1e2 * std::numeric_limits<double>::epsilon();
  std::vector<std::vector<CoarseEntry>> sends(static_cast<std::size_t>(comm_->getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Kernel& kernel = system.kernel(i);
    const std::vector<Constraints::Entry>& entries = constraints.entries(i);
    std::vector<double> largest(static_cast<std::size_t>(kernel.columns), 0.0);
    for (int k = 0; k < kernel.columns; ++k)
      for (int j = 0; j < kernel.rows; ++j)
        largest[static_cast<std::size_t>(k)] =
            std::max(largest[static_cast<std::size_t>(k)], std::abs(kernel.column(k)[j]));
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].row == entries[begin].row)
        ++end;
      double size = 0.0;
      for (std::size_t e = begin; e < end; ++e)
        size += std::abs(entries[e].value);
      for (int k = 0; k < kernel.columns; ++k) {
        double value = 0.0;
        for (std::size_t e = begin; e < end; ++e)
          value += entries[e].value * kernel.column(k)[entries[e].dof];
        if (std::abs(value) > rounding * size * largest[static_cast<std::size_t>(k)])
          sends[static_cast<std::size_t>(constraints.overlapOwner(entries[begin].row))].push_back(
              {static_cast<long long>(constraints.overlapMap()->getGlobalElement(entries[begin].row)), value,
               system.kernelOffset(i) + k});
      }
      begin = end;
    }
  }
  std::vector<std::pair<int, CoarseEntry>> owned; // with local rows
  for (const std::vector<CoarseEntry>& part : exchangeItems(*comm_, sends))
    for (const CoarseEntry& entry : part)
      owned.emplace_back(constraints.rowMap()->getLocalElement(static_cast<GlobalOrdinal>(entry.row)), entry);
  std::sort(owned.begin(), owned.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.column) < std::tie(b.first, b.second.column);
  });
  for (const auto& [row, entry] : owned) {
    offsets_.resize(static_cast<std::size_t>(row) + 1, columns_.size());
    columns_.push_back(entry.column);
    values_.push_back(entry.value);
  }
  offsets_.resize(localSize(*constraints.rowMap()) + 1, columns_.size());

  padPairs(constraints);
  makePattern();
  if (constraints.hasWeights())
    makeScale();
  // The entries of G̃G̃ᵀ are known to some ε of its diagonal. A pivot of a hundred times n of these gives a row
  // of G that is noise to a hundredth, and no row: what it stands for is not held. Sums in extended precision
  // know better.
  const double threshold =
      scale_.empty() ? 1e2 * kernelDimension_ * std::numeric_limits<double>::epsilon() : 0.0;
  factor_ = factorOf(nullptr, threshold);
  coarseMap_ = Teuchos::rcp(
      new Map(static_cast<Tpetra::global_size_t>(dimension()), 0, comm_, Tpetra::LocallyReplicated));
}

// Both rows of a disc get entries at the same columns, for slips are sums of them.
void CoarseSpace::padPairs(const Constraints& constraints) {
  if (constraints.pairs().empty())
    return;
  std::vector<std::vector<int>> missing(offsets_.size() - 1);
  const auto columnsOf = [this](int row) {
    const auto r = static_cast<std::size_t>(row);
    return std::pair(columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r]),
                     columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r + 1]));
  };
  for (const auto& [first, second] : constraints.pairs())
    for (const auto& [row, other] : {std::pair(first, second), std::pair(second, first)}) {
      const auto [begin, end] = columnsOf(row);
      const auto [otherBegin, otherEnd] = columnsOf(other);
      std::set_difference(otherBegin, otherEnd, begin, end,
                          std::back_inserter(missing[static_cast<std::size_t>(row)]));
    }
  std::vector<std::size_t> offsets = {0};
  std::vector<int> columns;
  std::vector<double> values;
  std::vector<std::pair<int, double>> row;
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    row.clear();
    for (std::size_t k = offsets_[r]; k < offsets_[r + 1]; ++k)
      row.emplace_back(columns_[k], values_[k]);
    for (int column : missing[r])
      row.emplace_back(column, 0.0);
    std::sort(row.begin(), row.end());
    for (const auto& [column, value] : row) {
      columns.push_back(column);
      values.push_back(value);
    }
    offsets.push_back(columns.size());
  }
  offsets_.swap(offsets);
  columns_.swap(columns);
  values_.swap(values);
}

// Places of G̃G̃ᵀ that any rank fills. Rows of an interface touch the same motions: what they fill is looked
// up once for all of them.
void CoarseSpace::makePattern() {
  std::map<std::vector<int>, std::size_t> patterns; // and where the places of their pairs begin
  std::vector<std::pair<int, int>> mine;
  std::vector<int> touched, before;
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    touched.assign(columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r]),
                   columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r + 1]));
    if (r > 0 && touched == before) {
      firstPlace_.push_back(firstPlace_.back());
      continue;
    }
    const auto [known, isNew] = patterns.emplace(touched, mine.size());
    firstPlace_.push_back(known->second);
    if (isNew)
      for (std::size_t i = 0; i < touched.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j) // columns of a row rise
          mine.emplace_back(touched[i], touched[j]);
    before.swap(touched);
  }
  std::vector<std::pair<int, int>> places = mine;
  const auto makeUnique = [](std::vector<std::pair<int, int>>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  makeUnique(places);
  struct Place {
    int row, column;
  };
  std::vector<Place> sent;
  for (const auto& [row, column] : places)
    sent.push_back({row, column});
  places.clear();
  for (const Place& place : gatherAll(*comm_, sent))
    places.emplace_back(place.row, place.column);
  makeUnique(places);
  for (const auto& [row, column] : places) {
    gramRows_.push_back(row);
    gramColumns_.push_back(column);
  }
  for (const auto& pair : mine)
    gramPlaces_.push_back(
        static_cast<int>(std::lower_bound(places.begin(), places.end(), pair) - places.begin()));
}

// √ of the diagonal of G̃G̃ᵀ.
void CoarseSpace::makeScale() {
  scale_.assign(static_cast<std::size_t>(kernelDimension_), 0.0);
  for (std::size_t k = 0; k < values_.size(); ++k)
    scale_[static_cast<std::size_t>(columns_[k])] += values_[k] * values_[k];
  globalSum(*comm_, scale_);
  broadcast(*comm_, scale_);
  for (double& value : scale_)
    value = value > 0.0 ? std::sqrt(value) : 1.0;
}

// G̃M_FG̃ᵀ at the places of the pattern; the same to the last bit on all ranks, whose decisions must agree.
template<class Real>
std::vector<Real> CoarseSpace::gram(const double* mask, const std::vector<qp::Slip>& slipping,
                                    double q) const {
  std::vector<Real> values(gramRows_.size(), 0.0);
  std::vector<double> along;
  for (const qp::Slip& slip : slipping) {
    const double weight = q > 0.0 ? std::sqrt(q / (q + slip.curvature)) : 1.0;
    const auto first = static_cast<std::size_t>(slip.first), second = static_cast<std::size_t>(slip.second);
    along.clear();
    for (std::size_t k = 0; k < offsets_[first + 1] - offsets_[first]; ++k)
      along.push_back(weight * (-slip.normal[1] * values_[offsets_[first] + k] +
                                slip.normal[0] * values_[offsets_[second] + k]));
    std::size_t pair = firstPlace_[first];
    for (std::size_t i = 0; i < along.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j, ++pair)
        values[static_cast<std::size_t>(gramPlaces_[pair])] += static_cast<Real>(along[i]) * along[j];
  }
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    if (mask != nullptr && mask[r] == 0.0)
      continue;
    const double weight = mask == nullptr ? 1.0 : mask[r];
    std::size_t pair = firstPlace_[r];
    for (std::size_t i = offsets_[r]; i < offsets_[r + 1]; ++i)
      for (std::size_t j = offsets_[r]; j <= i; ++j, ++pair)
        values[static_cast<std::size_t>(gramPlaces_[pair])] +=
            weight * (static_cast<Real>(values_[i]) * values_[j]);
  }
  if constexpr (std::is_same_v<Real, double>) {
    globalSum(*comm_, values);
    broadcast(*comm_, values);
  } else {
    std::vector<double> sizes;
    for (std::size_t k = 0; k < values.size(); ++k)
      sizes.push_back(scale_[static_cast<std::size_t>(gramRows_[k])] *
                      scale_[static_cast<std::size_t>(gramColumns_[k])]);
    sumExactly(*comm_, values, sizes);
  }
  return values;
}

// Where weights differ by orders of magnitude, what many stiff subdomains do together against soft ones is
// small beside what each does by itself, and would be lost in rounding errors of double precision.
CoarseFactor CoarseSpace::factorOf(const double* mask, double threshold,
                                   const std::vector<qp::Slip>& slipping, double q) const {
  const auto factored = [&](auto values) {
    // Rows that were left out of G are left out on faces.
    for (int column : factor_.dependent())
      for (std::size_t k = 0; k < values.size(); ++k)
        if (gramRows_[k] == column || gramColumns_[k] == column)
          values[k] = 0.0;
    return CoarseFactor(kernelDimension_, gramRows_, gramColumns_, values, threshold, mostDense_, scale_);
  };
  return scale_.empty() ? factored(gram<double>(mask, slipping, q))
                        : factored(gram<long double>(mask, slipping, q));
}

CoarseFactor CoarseSpace::faceFactor(const MultiVector& mask) const {
  return faceFactor(mask, {}, 0.0);
}

CoarseFactor CoarseSpace::faceFactor(const MultiVector& mask, const std::vector<qp::Slip>& slipping,
                                     double q) const {
  // What a face takes away may leave pivots that are nothing but rounding errors.
  constexpr double threshold = 1e2 * std::numeric_limits<double>::epsilon();
  const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
  return factorOf(view.data(), threshold, slipping, q);
}

std::vector<double> CoarseSpace::solveOnFace(const CoarseFactor& face, const std::vector<double>& r) const {
  return factor_.multiplyLt(face.solveLt(face.solveL(factor_.multiplyL(r))));
}

std::vector<double> CoarseSpace::minimumNormSolution(const MultiVector& mask,
                                                     const std::vector<double>& r) const {
  std::vector<double> values;
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
    values = gram<double>(view.data(), {}, 0.0);
  }
  const double threshold = 1e2 * kernelDimension_ * std::numeric_limits<double>::epsilon();
  const CoarseFactor factor(kernelDimension_, gramRows_, gramColumns_, values, threshold, mostDense_, scale_);
  const auto solve = [&](const std::vector<double>& b) { return factor.solveLt(factor.solveL(b)); };
  std::vector<double> x = solve(r);
  // Each row left out gives a null vector z: z_d = 1 there, −A⁻A_d at the kept rows. With Z of these columns
  // the least norm is that of x − Z(ZᵀZ)⁻¹Zᵀx, ZᵀZ = I + a Gram matrix: well conditioned. Motions of single
  // bodies touch few entries, and there may be thousands of them: Z is kept sparse.
  const std::vector<int>& dependent = factor.dependent();
  if (dependent.empty())
    return x;
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
  return x;
}

std::vector<double> CoarseSpace::applyUnscaled(const MultiVector& lambda, std::size_t column) const {
  std::vector<double> w(static_cast<std::size_t>(kernelDimension_), 0.0);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r)
    for (std::size_t k = offsets_[r]; k < offsets_[r + 1]; ++k)
      w[static_cast<std::size_t>(columns_[k])] += values_[k] * view(r, column);
  globalSum(*comm_, w);
  return w;
}

std::vector<double> CoarseSpace::applyG(const MultiVector& lambda, std::size_t column) const {
  return solveL(applyUnscaled(lambda, column));
}

void CoarseSpace::addGt(double factor, const std::vector<double>& w, MultiVector& lambda,
                        std::size_t column) const {
  const std::vector<double> s = solveLt(w);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    double sum = 0.0;
    for (std::size_t k = offsets_[r]; k < offsets_[r + 1]; ++k)
      sum += values_[k] * s[static_cast<std::size_t>(columns_[k])];
    view(r, column) += factor * sum;
  }
}

void CoarseSpace::project(MultiVector& v) const {
  if (dimension() == 0)
    return;
  for (std::size_t c = 0; c < v.getNumVectors(); ++c)
    addGt(-1.0, applyG(v, c), v, c);
}

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

void ProjectedOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                              Scalar beta) const {
  MultiVector image(Y.getMap(), X.getNumVectors());
  if (onKernel_) {
    inner_.apply(X, image);
  } else {
    MultiVector projected(X, Teuchos::Copy);
    coarse_.project(projected);
    inner_.apply(projected, image);
  }
  coarse_.project(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

} // namespace Harmos::feti
