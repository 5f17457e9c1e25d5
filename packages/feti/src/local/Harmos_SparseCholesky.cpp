// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SparseCholesky.hpp"

#include "Harmos_Index.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

namespace Harmos::feti {
namespace {

using Blas = Teuchos::BLAS<int, double>;

// Both triangles, and the diagonal, of ones.
LocalMatrix patternOf(int n, const std::vector<int>& rows, const std::vector<int>& columns) {
  std::vector<MatrixEntry> entries;
  for (int i = 0; i < n; ++i)
    entries.push_back({i, i, 1.0});
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] != columns[k]) {
      entries.push_back({rows[k], columns[k], 1.0});
      entries.push_back({columns[k], rows[k], 1.0});
    }
  return makeLocalMatrix(n, std::move(entries));
}

// The lower triangle in the order of elimination, column by column.
template<class Real>
struct Permuted {
  struct Entry {
    int row;
    Real value;
  };
  std::vector<std::size_t> first;
  std::vector<Entry> entries;
  Real largest = 0.0; // on the diagonal

  Permuted(const FrontTree& tree, const std::vector<int>& rows, const std::vector<int>& columns,
           const std::vector<Real>& values)
      : first(at(tree.size()) + 1, 0), entries(values.size()) {
    const auto placesOf = [&](std::size_t k) {
      return std::minmax(tree.place[at(rows[k])], tree.place[at(columns[k])]);
    };
    for (std::size_t k = 0; k < values.size(); ++k)
      ++first[at(placesOf(k).first) + 1];
    for (std::size_t j = 1; j < first.size(); ++j)
      first[j] += first[j - 1];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto [column, row] = placesOf(k);
      entries[next[at(column)]++] = {row, values[k]};
      if (row == column)
        largest = std::max(largest, values[k]);
    }
  }
};

// The lower triangle of a front, of the height of all its rows, and its elimination.
template<class Real>
class Front {
 public:
  Front(int columns, int below, Real zero)
      : columns_(at(columns)), height_(at(columns + below)), zero_(zero), a_(height_ * height_, Real(0.0)) {}

  Real& operator()(std::size_t i, std::size_t j) { return a_[j * height_ + i]; }
  const std::vector<Real>& values() const { return a_; }

  // Divides by the pivots, and takes the columns from what is below. Of rows left out the column is zero,
  // under a one. @param pivots receives them, zero for rows that are left out.
  void eliminate(std::vector<Real>& pivots) {
    pivots.assign(columns_, Real(0.0));
    if constexpr (std::is_same_v<Real, double>) {
      const std::vector<double> before = a_;
      if (isRegular(pivots))
        return;
      a_ = before;
    }
    for (std::size_t j = 0; j < columns_; ++j)
      eliminateColumn(j, pivots[j]);
  }

  // What is left for the parent: the square of the rows below, of which the lower triangle counts.
  std::vector<Real> left() const {
    const std::size_t r = height_ - columns_;
    std::vector<Real> square(r * r);
    for (std::size_t j = 0; j < r; ++j) {
      const auto column = a_.begin() + static_cast<std::ptrdiff_t>((columns_ + j) * height_ + columns_);
      std::copy(column, column + static_cast<std::ptrdiff_t>(r),
                square.begin() + static_cast<std::ptrdiff_t>(j * r));
    }
    return square;
  }

 private:
  // By LAPACK; whether no pivot is a rounding error.
  bool isRegular(std::vector<Real>& pivots) {
    const auto k = static_cast<int>(columns_), height = static_cast<int>(height_), r = height - k;
    int info = 0;
    Teuchos::LAPACK<int, double>().POTRF('L', k, a_.data(), height, &info);
    if (info != 0)
      return false;
    for (std::size_t j = 0; j < columns_; ++j) {
      pivots[j] = (*this)(j, j) * (*this)(j, j);
      if (!(pivots[j] > zero_))
        return false;
    }
    if (r > 0) {
      double* below = a_.data() + columns_;
      Blas().TRSM(Teuchos::RIGHT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS, Teuchos::NON_UNIT_DIAG, r, k, 1.0,
                  a_.data(), height, below, height);
      Blas().SYRK(Teuchos::LOWER_TRI, Teuchos::NO_TRANS, r, k, -1.0, below, height, 1.0,
                  a_.data() + columns_ * height_ + columns_, height);
    }
    return true;
  }

  void eliminateColumn(std::size_t j, Real& pivot) {
    Real* column = a_.data() + j * height_;
    pivot = column[j];
    if (!(pivot > zero_)) {
      pivot = 0.0;
      std::fill(column + j, column + height_, Real(0.0));
      column[j] = 1.0;
      return;
    }
    const Real root = std::sqrt(pivot);
    column[j] = root;
    for (std::size_t i = j + 1; i < height_; ++i)
      column[i] /= root;
    for (std::size_t c = j + 1; c < height_; ++c) {
      Real* other = a_.data() + c * height_;
      const Real factor = column[c];
      for (std::size_t i = c; factor != 0.0 && i < height_; ++i)
        other[i] -= factor * column[i];
    }
  }

  std::size_t columns_, height_;
  Real zero_;
  std::vector<Real> a_;
};

// Fronts, one after the other, from the matrix and from what their children left.
template<class Real>
class Assembly {
 public:
  Assembly(const FrontTree& tree, const Permuted<Real>& matrix)
      : tree_(tree), matrix_(matrix), local_(at(tree.size())) {}

  Front<Real> next(std::size_t f, Real zero) {
    const FrontTree::Front& front = tree_.fronts[f];
    const auto k = at(front.columns), r = at(front.below);
    Front<Real> dense(front.columns, front.below, zero);
    for (std::size_t j = 0; j < k; ++j)
      local_[at(front.first) + j] = static_cast<int>(j);
    for (std::size_t i = 0; i < r; ++i)
      local_[at(tree_.rows[front.rows + i])] = static_cast<int>(k + i);
    for (std::size_t j = 0; j < k; ++j)
      for (std::size_t e = matrix_.first[at(front.first) + j]; e < matrix_.first[at(front.first) + j + 1];
           ++e)
        dense(at(local_[at(matrix_.entries[e].row)]), j) += matrix_.entries[e].value;
    for (; !waiting_.empty() && tree_.fronts[waiting_.back().front].parent == static_cast<int>(f);
         waiting_.pop_back()) {
      const FrontTree::Front& child = tree_.fronts[waiting_.back().front];
      const std::vector<Real>& values = waiting_.back().values;
      const int* rows = tree_.rows.data() + child.rows;
      const auto size = at(child.below);
      for (std::size_t j = 0; j < size; ++j)
        for (std::size_t i = j; i < size; ++i)
          dense(at(local_[at(rows[i])]), at(local_[at(rows[j])])) += values[j * size + i];
    }
    return dense;
  }

  // Takes what a front leaves for its parent, until that is assembled.
  void keep(std::size_t f, const Front<Real>& dense) {
    if (tree_.fronts[f].parent >= 0)
      waiting_.push_back({f, dense.left()});
  }

 private:
  struct Update {
    std::size_t front;
    std::vector<Real> values; // the square of the rows below; its lower triangle counts
  };
  const FrontTree& tree_;
  const Permuted<Real>& matrix_;
  std::vector<Update> waiting_;
  std::vector<int> local_; // of places, in the front at hand
};

} // namespace

template<class Real>
SparseCholesky::SparseCholesky(int n, const std::vector<int>& rows, const std::vector<int>& columns,
                               const std::vector<Real>& values, double relativeThreshold,
                               const SparseCholesky* like)
    : tree_(like != nullptr
                ? like->tree_
                : std::make_shared<const FrontTree>(patternOf(n, rows, columns), std::vector<int>())),
      isKept_(at(n), 0) {
  const FrontTree& tree = *tree_;
  const Permuted<Real> matrix(tree, rows, columns, values);
  const Real zero = std::max(n * std::numeric_limits<double>::epsilon(), relativeThreshold) * matrix.largest;
  Assembly<Real> assembly(tree, matrix);
  std::vector<Real> pivots;
  for (std::size_t f = 0; f < tree.fronts.size(); ++f) {
    const FrontTree::Front& front = tree.fronts[f];
    Front<Real> dense = assembly.next(f, zero);
    dense.eliminate(pivots);
    begin_.push_back(values_.size());
    const auto columnsEnd = static_cast<std::ptrdiff_t>(pivots.size() * at(front.columns + front.below));
    std::transform(dense.values().begin(), dense.values().begin() + columnsEnd, std::back_inserter(values_),
                   [](Real value) { return static_cast<double>(value); });
    for (std::size_t j = 0; j < pivots.size(); ++j) {
      const int place = front.first + static_cast<int>(j);
      if (pivots[j] > 0.0) {
        isKept_[at(place)] = 1;
        kept_.push_back(place);
        smallestRatio_ = std::min(smallestRatio_, static_cast<double>(pivots[j] / matrix.largest));
      } else {
        dependent_.push_back(tree.order[at(place)]);
      }
    }
    assembly.keep(f, dense);
  }
}

template SparseCholesky::SparseCholesky(int, const std::vector<int>&, const std::vector<int>&,
                                        const std::vector<double>&, double, const SparseCholesky*);
template SparseCholesky::SparseCholesky(int, const std::vector<int>&, const std::vector<int>&,
                                        const std::vector<long double>&, double, const SparseCholesky*);

double SparseCholesky::entries() const {
  double sum = 0.0;
  if (tree_ != nullptr)
    for (const FrontTree::Front& front : tree_->fronts)
      sum += 0.5 * front.columns * (front.columns + 1.0) + static_cast<double>(front.columns) * front.below;
  return sum;
}

// Zero at rows left out: what L has in these rows is of no account then.
std::vector<double> SparseCholesky::byPlaces(const std::vector<double>& v) const {
  std::vector<double> x(isKept_.size(), 0.0);
  for (int place : kept_)
    x[at(place)] = v[at(tree_->order[at(place)])];
  return x;
}

std::vector<double> SparseCholesky::byRows(const std::vector<double>& x) const {
  std::vector<double> v(x.size(), 0.0);
  for (int place : kept_)
    v[at(tree_->order[at(place)])] = x[at(place)];
  return v;
}

std::vector<double> SparseCholesky::keptOf(const std::vector<double>& x) const {
  std::vector<double> w;
  w.reserve(kept_.size());
  for (int place : kept_)
    w.push_back(x[at(place)]);
  return w;
}

std::vector<double> SparseCholesky::scattered(const std::vector<double>& w) const {
  std::vector<double> x(isKept_.size(), 0.0);
  for (std::size_t r = 0; r < kept_.size(); ++r)
    x[at(kept_[r])] = w[r];
  return x;
}

namespace {

// Columns of L in a front, with the entries of a vector at them and at the rows below.
struct Step {
  const double* l;
  int columns, below;
  double* own;     // entries of the vector at the columns
  const int* rows; // places of the rows below
  double* atRows;  // room for their entries
  std::vector<double>& x;

  int height() const { return columns + below; }
  void gather() const {
    for (int i = 0; i < below; ++i)
      atRows[i] = x[at(rows[i])];
  }
  void scatter(double factor) const {
    for (int i = 0; i < below; ++i)
      x[at(rows[i])] += factor * atRows[i];
  }
  // atRows ← L₂₁·own.
  void multiplyBelow() const {
    if (below > 0)
      Blas().GEMV(Teuchos::NO_TRANS, below, columns, 1.0, l + columns, height(), own, 1, 0.0, atRows, 1);
  }
  // own += factor·L₂₁ᵀ·atRows.
  void addTransposed(double factor) const {
    if (below > 0)
      Blas().GEMV(Teuchos::TRANS, below, columns, factor, l + columns, height(), atRows, 1, 1.0, own, 1);
  }
  void solveOwn(Teuchos::ETransp mode) const {
    Blas().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, mode, Teuchos::NON_UNIT_DIAG, columns, 1, 1.0, l,
                height(), own, columns);
  }
  void multiplyOwn(Teuchos::ETransp mode) const {
    Blas().TRMM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, mode, Teuchos::NON_UNIT_DIAG, columns, 1, 1.0, l,
                height(), own, columns);
  }
};

} // namespace

// Children before their parents, or the other way round.
template<class Work>
void SparseCholesky::throughFronts(bool upwards, std::vector<double>& x, const Work& work) const {
  if (x.empty())
    return;
  std::vector<double> atRows(at(tree_->largestFront));
  const std::size_t count = tree_->fronts.size();
  for (std::size_t step = 0; step < count; ++step) {
    const std::size_t f = upwards ? step : count - 1 - step;
    const FrontTree::Front& front = tree_->fronts[f];
    work(Step{values_.data() + begin_[f], front.columns, front.below, x.data() + front.first,
              tree_->rows.data() + front.rows, atRows.data(), x});
  }
}

std::vector<double> SparseCholesky::solveL(const std::vector<double>& e) const {
  std::vector<double> x = byPlaces(e);
  throughFronts(true, x, [](const Step& step) {
    step.solveOwn(Teuchos::NO_TRANS);
    step.multiplyBelow();
    step.scatter(-1.0);
  });
  return keptOf(x);
}

std::vector<double> SparseCholesky::solveLt(const std::vector<double>& w) const {
  std::vector<double> x = scattered(w);
  throughFronts(false, x, [](const Step& step) {
    step.gather();
    step.addTransposed(-1.0);
    step.solveOwn(Teuchos::TRANS);
  });
  return byRows(x);
}

std::vector<double> SparseCholesky::multiplyL(const std::vector<double>& w) const {
  std::vector<double> x = scattered(w);
  // Parents first: what is added to rows above belongs to those that are done.
  throughFronts(false, x, [](const Step& step) {
    step.multiplyBelow();
    step.scatter(1.0);
    step.multiplyOwn(Teuchos::NO_TRANS);
  });
  return byRows(x);
}

std::vector<double> SparseCholesky::multiplyLt(const std::vector<double>& v) const {
  std::vector<double> x = byPlaces(v);
  // Children first, as they need their parents' entries as they were.
  throughFronts(true, x, [](const Step& step) {
    step.multiplyOwn(Teuchos::TRANS);
    step.gather();
    step.addTransposed(1.0);
  });
  return keptOf(x);
}

} // namespace Harmos::feti
