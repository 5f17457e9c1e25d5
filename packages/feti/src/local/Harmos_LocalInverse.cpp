// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalInverse.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_FixingDofs.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::feti {
namespace {

// Vectors that are solved for at once: MUMPS then works with matrix-matrix products, and the copies stay
// small.
constexpr int mostColumns = 32;

// Calls work(first, number) for parts of count columns.
template<class Work>
void inParts(int count, Work&& work) {
  for (int first = 0; first < count; first += mostColumns)
    work(first, std::min(mostColumns, count - first));
}

// K⁻¹ or S as an operator on the boundary, given how to work on all dofs at once.
template<class OnAllDofs>
void throughAllDofs(int n, const std::vector<int>& boundary, const double* t, double* u, int count,
                    OnAllDofs&& work) {
  const std::size_t size = static_cast<std::size_t>(n), b = boundary.size();
  std::vector<double> x;
  inParts(count, [&](int first, int number) {
    x.assign(size * static_cast<std::size_t>(number), 0.0);
    for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c)
      for (std::size_t k = 0; k < b; ++k)
        x[c * size + static_cast<std::size_t>(boundary[k])] =
            t[(static_cast<std::size_t>(first) + c) * b + k];
    work(x.data(), number);
    for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c)
      for (std::size_t k = 0; k < b; ++k)
        u[(static_cast<std::size_t>(first) + c) * b + k] =
            x[c * size + static_cast<std::size_t>(boundary[k])];
  });
}

// S t = K_bb t − K_bi K_ii⁻¹ K_ib t with a factorisation of K_ii.
class SchurBySolves : public BoundaryOperator {
 public:
  SchurBySolves(const LocalMatrix& matrix, std::vector<int> boundary, const SparseSolverChoice& solver,
                Precision precision, std::shared_ptr<FactorizationContext> context)
      : boundary_(std::move(boundary)), rows_(static_cast<std::size_t>(matrix.rows())) {
    split(matrix);
    LocalFactorizationSettings settings;
    settings.solver = solver;
    settings.precision = precision;
    settings.isRefined = false;
    settings.boundary = boundary_;
    settings.ends = coupling_.columns;
    interior_ = makeLocalFactorization(matrix, settings, std::move(context));
  }

  void refactor(const LocalMatrix& matrix) {
    split(matrix);
    interior_->refactor(matrix);
  }

  FactorizationCounts counts() const { return interior_->counts(); }

  int size() const override { return static_cast<int>(boundary_.size()); }

  void apply(const double* t, double* u, int count) const override {
    block_->apply(t, u, count);
    const std::size_t b = boundary_.size();
    inParts(count, [&](int first, int number) {
      interiorLoad_.assign(rows_ * static_cast<std::size_t>(number), 0.0);
      for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c)
        for (std::size_t r = 0; r < b; ++r)
          for (std::size_t k = coupling_.offsets[r]; k < coupling_.offsets[r + 1]; ++k)
            interiorLoad_[c * rows_ + static_cast<std::size_t>(coupling_.columns[k])] +=
                coupling_.values[k] * t[(static_cast<std::size_t>(first) + c) * b + r];
      interior_->solveAtEnds(interiorLoad_.data(), number);
      for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c)
        for (std::size_t r = 0; r < b; ++r) {
          double sum = 0.0;
          for (std::size_t k = coupling_.offsets[r]; k < coupling_.offsets[r + 1]; ++k)
            sum += coupling_.values[k] *
                   interiorLoad_[c * rows_ + static_cast<std::size_t>(coupling_.columns[k])];
          u[(static_cast<std::size_t>(first) + c) * b + r] -= sum;
        }
    });
  }

  double bytes() const override {
    return interior_->bytes() + block_->bytes() + 12.0 * static_cast<double>(coupling_.entries());
  }
  double bytesRead(int count) const override {
    return interior_->bytesRead(count) +
           count * (block_->bytesRead(1) + 24.0 * static_cast<double>(coupling_.entries()));
  }
  double flops() const override {
    return interior_->flops() + block_->flops() + 4.0 * static_cast<double>(coupling_.entries());
  }

 private:
  // K_bb and K_bi.
  void split(const LocalMatrix& matrix) {
    block_ = std::make_unique<SparseOperator>(matrix, boundary_);
    coupling_ = couplingOf(matrix, boundary_);
  }

  std::vector<int> boundary_;
  std::size_t rows_;
  std::unique_ptr<SparseOperator> block_;
  LocalMatrix coupling_;
  std::unique_ptr<LocalFactorization> interior_;
  mutable std::vector<double> interiorLoad_;
};

class ImplicitInverse : public LocalInverse {
 public:
  ImplicitInverse(const LocalMatrix& matrix, const Kernel& kernel, std::vector<int> boundary,
                  const LocalInverseSettings& settings, std::shared_ptr<FactorizationContext> context,
                  const Kernel& fixedBy)
      : matrix_(&matrix),
        fixing_(kernel.columns > 0 ? fixingDofs(matrix, fixedBy, settings.fixingPlaces) : std::vector<int>()),
        solver_(settings.solver),
        context_(std::move(context)),
        boundary_(*this, std::move(boundary)) {
    hold(kernel);
    LocalFactorizationSettings factor;
    factor.solver = solver_;
    factor.precision = settings.precision;
    factor.ends = boundary_.boundary();
    factor_ = makeLocalFactorization(definite(), factor, context_);
  }

  void apply(double* x, int count) const override {
    const auto n = static_cast<std::size_t>(matrix_->rows());
    if (isRounded_) {
      std::vector<double> load(n), residual(n);
      for (int c = 0; c < count; ++c, x += n) {
        std::copy(x, x + n, load.begin());
        factor_->solve(x, 1);
        multiply(x, residual.data());
        for (std::size_t k = 0; k < n; ++k)
          residual[k] = load[k] - residual[k];
        factor_->solve(residual.data(), 1);
        for (std::size_t k = 0; k < n; ++k)
          x[k] += residual[k];
      }
      return;
    }
    inParts(count,
            [&](int first, int number) { factor_->solve(x + static_cast<std::size_t>(first) * n, number); });
  }

  const BoundaryOperator& boundaryOperator() const override { return boundary_; }

  std::shared_ptr<const BoundaryOperator> schurComplement() const override {
    if (!schur_)
      schur_ = std::make_shared<SchurBySolves>(
          *matrix_, boundary_.boundary(), solver_,
          isSchurRounded_ && solver_.isMultifrontal() ? Precision::Single : Precision::Double, context_);
    return schur_;
  }

  void roundSchurComplement() override { isSchurRounded_ = true; }

  void roundProducts(double most) override {
    if (isRounded_ || most == 0.0)
      return;
    // A load with much of the slow modes, which are what rounding errors change most.
    const auto n = static_cast<std::size_t>(matrix_->rows());
    std::vector<double> x(n, 0.0), image(n);
    const std::vector<int>& ends = boundary_.boundary();
    for (std::size_t k = 0; k < ends.size(); ++k)
      x[static_cast<std::size_t>(ends[k])] =
          (2 * k < ends.size() ? 1.0 : -1.0) + 0.5 * std::cos(2.3 * static_cast<double>(k));
    std::vector<double> rounded = x;
    factor_->solve(x.data(), 1);
    if (!factor_->round())
      return;
    factor_->solve(rounded.data(), 1);
    const auto energy = [&](const std::vector<double>& v) {
      matrix_->multiply(v.data(), image.data());
      return std::inner_product(v.begin(), v.end(), image.begin(), 0.0);
    };
    for (std::size_t k = 0; k < n; ++k)
      rounded[k] -= x[k];
    isRounded_ = energy(rounded) <= most * most * energy(x);
    factor_->keep(isRounded_ ? Precision::Single : Precision::Double);
  }
  bool hasRoundedProducts() const override { return isRounded_; }
  void restoreProducts() override {
    if (!isRounded_)
      return;
    factor_->refactor(definite());
    isRounded_ = false;
  }

  double bytes() const override { return factor_->bytes() + (schur_ ? schur_->bytes() : 0.0); }

  void refactor(const LocalMatrix& matrix, const Kernel& kernel) override {
    HARMOS_REQUIRE((kernel.columns == 0) == fixing_.empty(), "the kernel has appeared or vanished");
    matrix_ = &matrix;
    hold(kernel);
    isRounded_ = false;
    factor_->refactor(definite());
    if (schur_ && isSchurRounded_) { // perhaps not any more; the context knows the analysis
      spent_ += schur_->counts();
      schur_.reset();
      isSchurRounded_ = false;
    } else if (schur_) {
      schur_->refactor(matrix);
    }
  }

  FactorizationCounts counts() const override {
    FactorizationCounts sum = spent_;
    sum += factor_->counts();
    if (schur_)
      sum += schur_->counts();
    return sum;
  }

 private:
  // K, or K + VVᵀ.
  LocalMatrix definite() const {
    return fixing_.empty() ? *matrix_ : withRegularization(*matrix_, holding_, fixing_);
  }
  void hold(const Kernel& kernel) {
    if (!fixing_.empty())
      holding_ = regularizationAt(*matrix_, kernel, fixing_);
  }

  // y ← (K + VVᵀ)x.
  void multiply(const double* x, double* y) const {
    matrix_->multiply(x, y);
    for (int k = 0; k < holding_.columns; ++k) {
      double sum = 0.0;
      for (std::size_t a = 0; a < fixing_.size(); ++a)
        sum += holding_.column(k)[a] * x[fixing_[a]];
      for (std::size_t a = 0; a < fixing_.size(); ++a)
        y[fixing_[a]] += holding_.column(k)[a] * sum;
    }
  }

  class Restriction : public BoundaryOperator {
   public:
    Restriction(const ImplicitInverse& inverse, std::vector<int> boundary)
        : inverse_(inverse), boundary_(std::move(boundary)) {}
    int size() const override { return static_cast<int>(boundary_.size()); }
    void apply(const double* t, double* u, int count) const override {
      throughAllDofs(inverse_.matrix_->rows(), boundary_, t, u, count,
                     [&](double* x, int number) { inverse_.factor_->solveAtEnds(x, number); });
    }
    double bytes() const override { return inverse_.factor_->bytes(); }
    double bytesRead(int count) const override { return inverse_.factor_->bytesRead(count); }
    double flops() const override { return inverse_.factor_->flops(); }
    const std::vector<int>& boundary() const { return boundary_; }

   private:
    const ImplicitInverse& inverse_;
    std::vector<int> boundary_;
  };

  const LocalMatrix* matrix_;
  std::vector<int> fixing_; ///< dofs that hold the kernel; none without one
  SparseSolverChoice solver_;
  std::shared_ptr<FactorizationContext> context_;
  Restriction boundary_;
  Kernel holding_;         ///< V on them
  bool isRounded_ = false; ///< L
  bool isSchurRounded_ = false;
  FactorizationCounts spent_; ///< on an S that is no more
  std::unique_ptr<LocalFactorization> factor_;
  mutable std::shared_ptr<SchurBySolves> schur_; ///< made when it is asked for
};

// Inverse of a dense symmetric positive definite matrix, whole.
void invert(std::vector<double>& a, int n) {
  int info = 0;
  Teuchos::LAPACK<int, double> lapack;
  lapack.POTRF('L', n, a.data(), n, &info);
  if (info > 0)
    throw NumericalError(
        "the Schur complement is not positive definite on the complement of the kernel (order " +
        std::to_string(info) + " of " + std::to_string(n) + ")");
  HARMOS_REQUIRE(info == 0, "dpotrf refused its arguments");
  lapack.POTRI('L', n, a.data(), n, &info);
  HARMOS_REQUIRE(info == 0, "dpotri failed");
  const auto size = static_cast<std::size_t>(n);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = j + 1; i < size; ++i)
      a[i * size + j] = a[j * size + i];
}

class CondensedInverse : public LocalInverse {
 public:
  CondensedInverse(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& boundary,
                   int columns, const LocalInverseSettings& settings,
                   std::shared_ptr<FactorizationContext> context)
      : n_(matrix.rows()),
        b_(static_cast<int>(boundary.size())),
        boundary_(boundary),
        columns_(columns),
        settings_(settings),
        context_(std::move(context)) {
    make(matrix, kernel);
  }

  void refactor(const LocalMatrix& matrix, const Kernel& kernel) override { make(matrix, kernel); }

  FactorizationCounts counts() const override {
    return interior_ ? interior_->counts() : FactorizationCounts();
  }

  void apply(double* x, int count) const override {
    std::vector<double> reduced, boundary;
    inParts(count, [&](int first, int number) {
      double* part = x + static_cast<std::size_t>(first) * static_cast<std::size_t>(n_);
      reduced.resize(static_cast<std::size_t>(b_) * static_cast<std::size_t>(number));
      boundary.resize(reduced.size());
      if (interior_ == nullptr) { // all dofs are on the boundary
        inverse_->apply(part, boundary.data(), number);
        std::copy(boundary.begin(), boundary.end(), part);
        return;
      }
      interior_->reduce(part, reduced.data(), number);
      inverse_->apply(reduced.data(), boundary.data(), number);
      interior_->expand(part, boundary.data(), number);
    });
  }

  const BoundaryOperator& boundaryOperator() const override { return *inverse_; }

  std::shared_ptr<const BoundaryOperator> schurComplement() const override {
    if (schur_ != nullptr)
      return schur_;
    if (late_ == nullptr && interior_ == nullptr)
      late_ = std::make_shared<SparseOperator>(*matrix_, boundary_);
    else if (late_ == nullptr)
      late_ =
          std::make_shared<SchurBySolves>(*matrix_, boundary_, settings_.solver, Precision::Double, context_);
    return late_;
  }

  void roundSchurComplement() override {
    if (schur_ != nullptr)
      schur_->roundIfPacked();
  }

  double bytes() const override {
    const double factors = interior_ == nullptr ? 0.0 : interior_->bytes();
    return factors + inverse_->bytes() + (schur_ ? schur_->bytes() : 0.0);
  }

 private:
  // S, and S⁺ from it.
  void make(const LocalMatrix& matrix, const Kernel& kernel) {
    matrix_ = &matrix;
    late_.reset();
    std::vector<double> s = b_ < n_ ? condensed(matrix) : whole(matrix);
    if (settings_.keepSchur)
      schur_ = std::make_shared<DenseOperator>(s, b_, settings_.precision, columns_);
    if (kernel.columns > 0) {
      // As many boundary dofs as rigid motions: nothing is left of S but rounding errors of K, which must not
      // be what holds the kernel.
      const double least = std::sqrt(std::numeric_limits<double>::epsilon());
      const std::vector<double> whole = matrix.diagonal();
      std::vector<double> diagonal;
      for (int k = 0; k < b_; ++k)
        diagonal.push_back(
            std::max(s[static_cast<std::size_t>(k) * static_cast<std::size_t>(b_ + 1)],
                     least * whole[static_cast<std::size_t>(boundary_[static_cast<std::size_t>(k)])]));
      const Kernel v = regularization(restricted(kernel, boundary_), diagonal);
      for (int k = 0; k < v.columns; ++k)
        for (int j = 0; j < b_; ++j)
          for (int i = 0; i < b_; ++i)
            s[static_cast<std::size_t>(j) * static_cast<std::size_t>(b_) + static_cast<std::size_t>(i)] +=
                v.column(k)[i] * v.column(k)[j];
    }
    invert(s, b_);
    DenseOperator made(std::move(s), b_, settings_.precision, columns_);
    if (inverse_ == nullptr)
      inverse_ = std::make_unique<DenseOperator>(std::move(made));
    else // whoever has it goes on with it
      *inverse_ = std::move(made);
  }

  std::vector<double> condensed(const LocalMatrix& matrix) {
    if (interior_ != nullptr) {
      interior_->refactor(matrix);
    } else {
      LocalFactorizationSettings factor; // in double: what is rounded is S⁺
      if (settings_.solver.hasSchurComplements() || settings_.solver.blockLowRank > 0.0)
        factor.solver = settings_.solver; // else Harmos' own: adaptive vectors need S whatever the solver
      factor.use = LocalFactorizationSettings::Boundary::Condensed;
      factor.boundary = boundary_;
      interior_ = makeLocalFactorization(matrix, factor, context_);
    }
    return interior_->takeSchurComplement();
  }

  std::vector<double> whole(const LocalMatrix& matrix) const {
    std::vector<double> result(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), 0.0);
    for (std::size_t i = 0; i + 1 < matrix.offsets.size(); ++i)
      for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
        result[static_cast<std::size_t>(matrix.columns[k]) * static_cast<std::size_t>(n_) + i] =
            matrix.values[k];
    return result;
  }

  int n_;
  int b_;
  std::vector<int> boundary_;
  int columns_;
  LocalInverseSettings settings_;
  std::unique_ptr<LocalFactorization> interior_; ///< of i; null if there is none
  std::unique_ptr<DenseOperator> inverse_;
  std::shared_ptr<DenseOperator> schur_;
  const LocalMatrix* matrix_ = nullptr;
  std::shared_ptr<FactorizationContext> context_;
  mutable std::shared_ptr<const BoundaryOperator> late_; ///< S where it was not kept, and is asked for
};

} // namespace

std::unique_ptr<LocalInverse> makeImplicitInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                  const std::vector<int>& boundary,
                                                  const LocalInverseSettings& settings,
                                                  std::shared_ptr<FactorizationContext> context,
                                                  const Kernel* fixedBy) {
  return std::make_unique<ImplicitInverse>(matrix, kernel, boundary, settings, std::move(context),
                                           fixedBy != nullptr ? *fixedBy : kernel);
}

std::unique_ptr<LocalInverse> makeCondensedInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                   const std::vector<int>& boundary, int columns,
                                                   const LocalInverseSettings& settings,
                                                   std::shared_ptr<FactorizationContext> context) {
  return std::make_unique<CondensedInverse>(matrix, kernel, boundary, columns, settings, std::move(context));
}

std::vector<int> boundaryWithSupport(const LocalMatrix& matrix, const Kernel& kernel,
                                     const std::vector<int>& boundary, int fixingPlaces) {
  // Columns of R have length one: rows of b that hold R well have singular values of √(n_b/n). A tenth of it
  // squares to the loss of two digits in S⁺.
  if (kernel.columns == 0)
    return boundary.empty() ? std::vector<int>{0} : boundary;
  if (!boundary.empty() && smallestSingularValue(restricted(kernel, boundary)) >
                               0.1 * std::sqrt(static_cast<double>(boundary.size()) / matrix.rows()))
    return boundary;
  std::vector<int> result = fixingDofs(matrix, kernel, fixingPlaces);
  result.insert(result.end(), boundary.begin(), boundary.end());
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

} // namespace Harmos::feti
