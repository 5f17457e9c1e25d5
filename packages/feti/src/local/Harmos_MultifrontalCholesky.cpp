// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MultifrontalCholesky.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_WideRegisters.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>

#include <algorithm>

namespace Harmos::feti {
namespace {

namespace Portable {
#include "Harmos_MultifrontalCholesky_panels.inc"
} // namespace Portable

#ifdef HARMOS_HAS_WIDE_REGISTERS
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace Wide {
#include "Harmos_MultifrontalCholesky_panels.inc"
} // namespace Wide
#pragma GCC pop_options
#else
namespace Wide = Portable;
#endif

// Columns of the panel that begins at column j of a front.
int panelColumns(const FrontTree::Front& front, int j) {
  return std::min(FrontTree::panelColumns, front.columns - j);
}

// The matrices of fronts, one after the other.
class Elimination {
 public:
  Elimination(const LocalMatrix& matrix, const FrontTree& tree, FrontWorkspace& workspace, double* schur)
      : matrix_(matrix),
        tree_(tree),
        stack_(workspace.stack(tree.stackEntries)),
        dense_(workspace.front(at(tree.largestFront) * at(tree.largestFront))),
        schur_(schur),
        local_(at(tree.size())) {
    // Rows that stay: their own entries first, then what fronts leave for them.
    const int m = tree.eliminated(), stay = tree.remaining;
    for (int k = m; k < tree.size(); ++k)
      forEachEntry(k, k, [&](int i, double value) { schur_[at(k - m) * at(stay) + at(i - m)] += value; });
  }

  // Eliminates the columns of a front, the next one. @return its columns, of the height of all its rows.
  const double* eliminate(std::size_t f) {
    const FrontTree::Front& front = tree_.fronts[f];
    assemble(f, front);
    const int k = front.columns, r = front.below, height = k + r;
    int info = 0;
    Teuchos::LAPACK<int, double>().POTRF('L', k, dense_, height, &info);
    if (info != 0)
      throw NumericalError("the matrix is not positive definite: no positive pivot at row " +
                           std::to_string(tree_.order[at(front.first + std::max(info, 1) - 1)]) + " of " +
                           std::to_string(matrix_.rows()));
    if (r > 0) {
      const Teuchos::BLAS<int, double> blas;
      blas.TRSM(Teuchos::RIGHT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS, Teuchos::NON_UNIT_DIAG, r, k, 1.0,
                dense_, height, dense_ + k, height);
      double* corner = dense_ + at(k) * at(height) + at(k);
      blas.SYRK(Teuchos::LOWER_TRI, Teuchos::NO_TRANS, r, k, -1.0, dense_ + k, height, 1.0, corner, height);
      if (front.parent >= 0)
        push(f, corner, height);
      else
        addToSchur(front, corner, height);
    }
    return dense_;
  }

 private:
  // Entries of the row at a place of places from `least` on: visit(place, value).
  template<class Visit>
  void forEachEntry(int place, int least, Visit&& visit) const {
    const std::size_t row = at(tree_.order[at(place)]);
    for (std::size_t e = matrix_.offsets[row]; e < matrix_.offsets[row + 1]; ++e)
      if (const int i = tree_.place[at(matrix_.columns[e])]; i >= least)
        visit(i, matrix_.values[e]);
  }

  // The lower triangle: entries of the matrix, and what the children left.
  void assemble(std::size_t f, const FrontTree::Front& front) {
    const int k = front.columns, height = k + front.below;
    const int* rows = tree_.rows.data() + front.rows;
    for (int j = 0; j < height; ++j)
      std::fill(dense_ + at(j) * at(height) + at(j), dense_ + at(j + 1) * at(height), 0.0);
    for (int j = 0; j < k; ++j)
      local_[at(front.first + j)] = j;
    for (int i = 0; i < front.below; ++i)
      local_[at(rows[i])] = k + i;
    for (int j = 0; j < k; ++j)
      forEachEntry(front.first + j, front.first + j,
                   [&](int i, double value) { dense_[at(j) * at(height) + at(local_[at(i)])] += value; });
    for (; !waiting_.empty() && tree_.fronts[waiting_.back().front].parent == static_cast<int>(f);
         waiting_.pop_back()) {
      const FrontTree::Front& child = tree_.fronts[waiting_.back().front];
      const int* below = tree_.rows.data() + child.rows;
      places_.resize(at(child.below));
      for (std::size_t i = 0; i < places_.size(); ++i)
        places_[i] = local_[at(below[i])];
      add(stack_ + waiting_.back().begin, child.below, child.below, dense_, height);
      top_ = waiting_.back().begin;
    }
  }

  // to(places, places) += the lower triangle of `update`, of order r. Rows that follow each other in both are
  // added at once: boundary rows mostly do.
  void add(const double* update, int r, int stride, double* to, int height) {
    runs_.resize(places_.size());
    for (std::size_t i = places_.size(); i-- > 0;)
      runs_[i] = i + 1 < places_.size() && places_[i + 1] == places_[i] + 1 ? runs_[i + 1] : i + 1;
    for (std::size_t j = 0; j < at(r); ++j) {
      double* column = to + at(places_[j]) * at(height);
      const double* from = update + j * at(stride);
      for (std::size_t i = j; i < at(r);) {
        const std::size_t end = runs_[i], length = end - i;
        double* t = column + places_[i];
        const double* s = from + i;
        for (std::size_t q = 0; q < length; ++q)
          t[q] += s[q];
        i = end;
      }
    }
  }

  void push(std::size_t f, const double* corner, int height) {
    const std::size_t r = at(tree_.fronts[f].below);
    for (std::size_t j = 0; j < r; ++j)
      std::copy(corner + j * at(height) + j, corner + j * at(height) + r, stack_ + top_ + j * r + j);
    waiting_.push_back({f, top_});
    top_ += r * r;
  }

  void addToSchur(const FrontTree::Front& front, const double* corner, int height) {
    const int* rows = tree_.rows.data() + front.rows;
    places_.assign(rows, rows + front.below);
    for (int& place : places_)
      place -= tree_.eliminated();
    add(corner, front.below, height, schur_, tree_.remaining);
  }

  struct Waiting {
    std::size_t front, begin; ///< whose, and where on the stack
  };
  const LocalMatrix& matrix_;
  const FrontTree& tree_;
  double* stack_;
  double* dense_;
  double* schur_;
  std::size_t top_ = 0;
  std::vector<Waiting> waiting_;
  std::vector<int> local_, places_;
  std::vector<std::size_t> runs_;
};

} // namespace

double* FrontWorkspace::enough(std::unique_ptr<double[]>& memory, std::size_t& size, std::size_t entries) {
  if (entries > size) {
    memory.reset(); // before the new one is asked for
    memory.reset(new double[entries]);
    size = entries;
  }
  return memory.get();
}

MultifrontalCholesky::MultifrontalCholesky(const LocalMatrix& matrix, std::shared_ptr<const FrontTree> tree,
                                           Precision precision, FrontWorkspace& workspace)
    : tree_(std::move(tree)), precision_(precision) {
  refactor(matrix, workspace);
}

void MultifrontalCholesky::round() {
  if (double_ == nullptr)
    return;
  single_.reset(new float[tree_->factorEntries]);
  for (std::size_t k = 0; k < tree_->factorEntries; ++k)
    single_[k] = static_cast<float>(double_[k]);
}

void MultifrontalCholesky::keep(Precision precision) {
  if (precision == Precision::Single)
    double_.reset();
  else
    single_.reset();
}

void MultifrontalCholesky::refactor(const LocalMatrix& matrix, FrontWorkspace& workspace) {
  const FrontTree& tree = *tree_;
  HARMOS_REQUIRE(at(matrix.rows()) == tree.place.size(), "the matrix is not the one that was analysed");
  if (precision_ == Precision::Double)
    single_.reset();
  if (precision_ == Precision::Double && double_ == nullptr)
    double_.reset(new double[tree.factorEntries]);
  if (precision_ == Precision::Single && single_ == nullptr)
    single_.reset(new float[tree.factorEntries]);
  const std::size_t stay = at(tree.remaining);
  schur_.assign(stay * stay, 0.0);
  Elimination elimination(matrix, tree, workspace, schur_.data());
  for (std::size_t f = 0; f < tree.fronts.size(); ++f) {
    const FrontTree::Front& front = tree.fronts[f];
    const double* dense = elimination.eliminate(f);
    if (precision_ == Precision::Double)
      store(front, dense, front.columns + front.below, double_.get());
    else
      store(front, dense, front.columns + front.below, single_.get());
  }
  for (std::size_t j = 0; j < stay; ++j)
    for (std::size_t i = j + 1; i < stay; ++i)
      schur_[i * stay + j] = schur_[j * stay + i];
}

template<class T>
void MultifrontalCholesky::store(const FrontTree::Front& front, const double* dense, int height, T* factor) {
  T* to = factor + front.entries;
  for (int j = 0; j < front.columns; j += FrontTree::panelColumns)
    for (int c = j; c < j + panelColumns(front, j); ++c) {
      const double* from = dense + at(c) * at(height) + at(j);
      to = std::transform(from, from + (front.height() - j), to,
                          [](double value) { return static_cast<T>(value); });
    }
}

std::vector<double> MultifrontalCholesky::takeSchurComplement() {
  return std::move(schur_);
}

namespace {

// One panel for vectors of leading dimension ld: the kernels for one vector, matrix-matrix products for more.
template<class T>
void forwardPanel(const T* panel, int height, int width, double* w, int, int) {
  if (hasWideRegisters())
    Wide::forwardPanel(panel, height, width, w);
  else
    Portable::forwardPanel(panel, height, width, w);
}

template<class T>
void backwardPanel(const T* panel, int height, int width, double* w, int, int) {
  if (hasWideRegisters())
    Wide::backwardPanel(panel, height, width, w);
  else
    Portable::backwardPanel(panel, height, width, w);
}

void forwardPanels(const double* panel, int height, int width, double* w, int ld, int count) {
  const Teuchos::BLAS<int, double> blas;
  blas.TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS, Teuchos::NON_UNIT_DIAG, width, count,
            1.0, panel, height, w, ld);
  if (height > width)
    blas.GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, height - width, count, width, -1.0, panel + width, height,
              w, ld, 1.0, w + width, ld);
}

void backwardPanels(const double* panel, int height, int width, double* w, int ld, int count) {
  const Teuchos::BLAS<int, double> blas;
  if (height > width)
    blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, width, count, height - width, -1.0, panel + width, height,
              w + width, ld, 1.0, w, ld);
  blas.TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS, Teuchos::NON_UNIT_DIAG, width, count, 1.0,
            panel, height, w, ld);
}

} // namespace

// X ← L⁻¹X, of eliminated places, column after column. @param work on a panel.
template<class T, class Work>
void MultifrontalCholesky::forward(const T* factor, const std::vector<char>* reached, double* x, int count,
                                   Work&& work) const {
  double* w = work_.data();
  const std::size_t m = at(tree_->eliminated());
  for (std::size_t f = 0; f < tree_->fronts.size(); ++f) {
    if (reached != nullptr && !(*reached)[f])
      continue;
    const FrontTree::Front& front = tree_->fronts[f];
    const int* rows = tree_->rows.data() + front.rows;
    const std::size_t h = at(front.height()), k = at(front.columns);
    for (std::size_t c = 0; c < at(count); ++c) {
      const double* from = x + c * m + front.first;
      std::copy(from, from + k, w + c * h);
      std::fill(w + c * h + k, w + (c + 1) * h, 0.0);
    }
    const T* panel = factor + front.entries;
    for (int j = 0; j < front.columns; j += FrontTree::panelColumns) {
      const int height = front.height() - j, width = panelColumns(front, j);
      work(panel, height, width, w + j, front.height(), count);
      panel += at(height) * at(width);
    }
    for (std::size_t c = 0; c < at(count); ++c) {
      double* to = x + c * m;
      std::copy(w + c * h, w + c * h + k, to + front.first);
      for (std::size_t i = 0; i < at(front.inner); ++i)
        to[rows[i]] += w[c * h + k + i];
    }
  }
}

// X ← L⁻ᵀX, likewise.
template<class T, class Work>
void MultifrontalCholesky::backward(const T* factor, const std::vector<char>* reached, double* x, int count,
                                    Work&& work) const {
  double* w = work_.data();
  const std::size_t m = at(tree_->eliminated());
  for (std::size_t f = tree_->fronts.size(); f-- > 0;) {
    if (reached != nullptr && !(*reached)[f])
      continue;
    const FrontTree::Front& front = tree_->fronts[f];
    const int* rows = tree_->rows.data() + front.rows;
    const std::size_t h = at(front.height()), k = at(front.columns);
    for (std::size_t c = 0; c < at(count); ++c) {
      const double* from = x + c * m;
      std::copy(from + front.first, from + front.first + front.columns, w + c * h);
      for (std::size_t i = 0; i < at(front.inner); ++i)
        w[c * h + k + i] = from[rows[i]];
    }
    // Panels stand one after the other; the last one ends where the next front begins.
    const T* panel =
        factor + (f + 1 < tree_->fronts.size() ? tree_->fronts[f + 1].entries : tree_->factorEntries);
    for (int j = (front.columns - 1) / FrontTree::panelColumns * FrontTree::panelColumns; j >= 0;
         j -= FrontTree::panelColumns) {
      const int height = front.height() - j, width = panelColumns(front, j);
      panel -= at(height) * at(width);
      work(panel, height, width, w + j, front.height(), count);
    }
    for (std::size_t c = 0; c < at(count); ++c)
      std::copy(w + c * h, w + c * h + k, x + c * m + front.first);
  }
}

void MultifrontalCholesky::solve(double* x, int count) const {
  solve(x, count, nullptr);
}

void MultifrontalCholesky::solveReached(double* x, int count, const std::vector<char>& reached) const {
  solve(x, count, &reached);
}

void MultifrontalCholesky::solve(double* x, int count, const std::vector<char>* reached) const {
  // Of fewer vectors than four the kernels for one are as fast; 32 keep a front's rows in a cache.
  constexpr int together = 4, most = 32;
  const std::size_t m = at(tree_->eliminated()), n = tree_->place.size();
  const int* order = tree_->order.data();
  while (count > 0) {
    const int now = single_ == nullptr && count >= together ? std::min(count, most) : 1;
    permuted_.resize(m * at(now));
    work_.resize(at(tree_->largestFront) * at(now));
    for (std::size_t c = 0; c < at(now); ++c)
      for (std::size_t k = 0; k < m; ++k)
        permuted_[c * m + k] = x[c * n + at(order[k])];
    if (now > 1) {
      forward(double_.get(), reached, permuted_.data(), now, forwardPanels);
      backward(double_.get(), reached, permuted_.data(), now, backwardPanels);
    } else if (single_ == nullptr) {
      forward(double_.get(), reached, permuted_.data(), 1, forwardPanel<double>);
      backward(double_.get(), reached, permuted_.data(), 1, backwardPanel<double>);
    } else {
      forward(single_.get(), reached, permuted_.data(), 1, forwardPanel<float>);
      backward(single_.get(), reached, permuted_.data(), 1, backwardPanel<float>);
    }
    for (std::size_t c = 0; c < at(now); ++c)
      for (std::size_t k = 0; k < m; ++k)
        x[c * n + at(order[k])] = permuted_[c * m + k];
    x += at(now) * n;
    count -= now;
  }
}

double MultifrontalCholesky::bytes() const {
  const double word = single_ == nullptr ? 8.0 : 4.0;
  return word * static_cast<double>(tree_->factorEntries) + 8.0 * static_cast<double>(schur_.size());
}

} // namespace Harmos::feti
