// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalInverse.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_Mumps.hpp"

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
  SchurBySolves(const LocalMatrix& matrix, std::vector<int> boundary)
      : matrix_(&matrix), boundary_(std::move(boundary)) {
    interiorSolve_ = std::make_unique<SparseSolve>(interior(), "MUMPS", Precision::Double, 0.0);
  }

  void refactor(const LocalMatrix& matrix) {
    matrix_ = &matrix;
    interiorSolve_->refactor(interior());
  }

  FactorizationCounts counts() const { return interiorSolve_->counts(); }

  int size() const override { return static_cast<int>(boundary_.size()); }

  void apply(const double* t, double* u, int count) const override {
    const auto n = static_cast<std::size_t>(matrix_->rows());
    std::vector<double> image;
    throughAllDofs(matrix_->rows(), boundary_, t, u, count, [&](double* x, int number) {
      image.resize(n * static_cast<std::size_t>(number));
      for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c) {
        matrix_->multiply(x + c * n, image.data() + c * n); // (K_bb t, K_ib t)
        for (int dof : boundary_)
          image[c * n + static_cast<std::size_t>(dof)] = 0.0;
      }
      interiorSolve_->solve(image.data(), number);
      // K (t, −K_ii⁻¹K_ib t) is S t on b.
      for (std::size_t k = 0; k < image.size(); ++k)
        x[k] -= image[k];
      for (std::size_t c = 0; c < static_cast<std::size_t>(number); ++c) {
        matrix_->multiply(x + c * n, image.data() + c * n);
        std::copy(image.data() + c * n, image.data() + (c + 1) * n, x + c * n);
      }
    });
  }

  double bytes() const override { return interiorSolve_->bytes(); }
  double bytesRead(int count) const override {
    return 2.0 * bytes() * std::ceil(count / double(mostColumns));
  }
  double flops() const override { return interiorSolve_->flops(); }

 private:
  // K_ii, with the diagonal at boundary dofs.
  LocalMatrix interior() const {
    LocalMatrix result = *matrix_;
    std::vector<bool> isBoundary(static_cast<std::size_t>(result.rows()), false);
    for (int dof : boundary_)
      isBoundary[static_cast<std::size_t>(dof)] = true;
    for (std::size_t i = 0; i < isBoundary.size(); ++i)
      for (std::size_t k = result.offsets[i]; k < result.offsets[i + 1]; ++k) {
        const auto j = static_cast<std::size_t>(result.columns[k]);
        if (i != j && (isBoundary[i] || isBoundary[j]))
          result.values[k] = 0.0;
      }
    return result;
  }

  const LocalMatrix* matrix_;
  std::vector<int> boundary_;
  std::unique_ptr<SparseSolve> interiorSolve_;
};

class ImplicitInverse : public LocalInverse {
 public:
  ImplicitInverse(const LocalMatrix& matrix, const Kernel& kernel, std::vector<int> boundary,
                  const LocalInverseSettings& settings)
      : matrix_(&matrix),
        fixing_(kernel.columns > 0 ? fixingDofs(matrix, kernel, settings.fixingPlaces) : std::vector<int>()),
        solve_(definite(kernel), settings.implicitSolver, settings.precision, settings.blockLowRank),
        boundary_(*this, std::move(boundary)) {}

  void apply(double* x, int count) const override {
    const auto n = static_cast<std::size_t>(matrix_->rows());
    inParts(count,
            [&](int first, int number) { solve_.solve(x + static_cast<std::size_t>(first) * n, number); });
  }

  const BoundaryOperator& boundaryOperator() const override { return boundary_; }

  std::shared_ptr<const BoundaryOperator> schurComplement() const override {
    if (!schur_)
      schur_ = std::make_shared<SchurBySolves>(*matrix_, boundary_.boundary());
    return schur_;
  }

  double bytes() const override { return solve_.bytes(); }

  void refactor(const LocalMatrix& matrix, const Kernel& kernel) override {
    HARMOS_REQUIRE((kernel.columns == 0) == fixing_.empty(), "the kernel has appeared or vanished");
    matrix_ = &matrix;
    solve_.refactor(definite(kernel));
    if (schur_)
      schur_->refactor(matrix);
  }

  FactorizationCounts counts() const override {
    FactorizationCounts sum = solve_.counts();
    if (schur_)
      sum += schur_->counts();
    return sum;
  }

 private:
  // K, or K + VVᵀ.
  LocalMatrix definite(const Kernel& kernel) const {
    return fixing_.empty() ? *matrix_ : regularized(*matrix_, kernel, fixing_);
  }

  class Restriction : public BoundaryOperator {
   public:
    Restriction(const ImplicitInverse& inverse, std::vector<int> boundary)
        : inverse_(inverse), boundary_(std::move(boundary)) {}
    int size() const override { return static_cast<int>(boundary_.size()); }
    void apply(const double* t, double* u, int count) const override {
      throughAllDofs(inverse_.matrix_->rows(), boundary_, t, u, count,
                     [&](double* x, int number) { inverse_.solve_.solve(x, number); });
    }
    double bytes() const override { return inverse_.bytes(); }
    double bytesRead(int count) const override {
      return 2.0 * bytes() * std::ceil(count / static_cast<double>(mostColumns)); // forward and backward
    }
    double flops() const override { return inverse_.solve_.flops(); }
    const std::vector<int>& boundary() const { return boundary_; }

   private:
    const ImplicitInverse& inverse_;
    std::vector<int> boundary_;
  };

  const LocalMatrix* matrix_;
  std::vector<int> fixing_; ///< dofs that hold the kernel; none without one
  SparseSolve solve_;
  Restriction boundary_;
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
                   int columns, const LocalInverseSettings& settings, OrderingCache& orderings)
      : n_(matrix.rows()),
        b_(static_cast<int>(boundary.size())),
        boundary_(boundary),
        columns_(columns),
        settings_(settings) {
    make(matrix, kernel, &orderings);
  }

  void refactor(const LocalMatrix& matrix, const Kernel& kernel) override { make(matrix, kernel, nullptr); }

  FactorizationCounts counts() const override {
    return mumps_ ? FactorizationCounts{mumps_->statistics().analyses, mumps_->statistics().factorizations}
                  : FactorizationCounts{};
  }

  void apply(double* x, int count) const override {
    std::vector<double> reduced, boundary;
    inParts(count, [&](int first, int number) {
      double* part = x + static_cast<std::size_t>(first) * static_cast<std::size_t>(n_);
      reduced.resize(static_cast<std::size_t>(b_) * static_cast<std::size_t>(number));
      boundary.resize(reduced.size());
      if (mumps_ == nullptr) { // all dofs are on the boundary
        inverse_->apply(part, boundary.data(), number);
        std::copy(boundary.begin(), boundary.end(), part);
        return;
      }
      mumps_->condense(part, reduced.data(), number);
      inverse_->apply(reduced.data(), boundary.data(), number);
      mumps_->expand(part, boundary.data(), number);
    });
  }

  const BoundaryOperator& boundaryOperator() const override { return *inverse_; }

  std::shared_ptr<const BoundaryOperator> schurComplement() const override {
    HARMOS_REQUIRE(schur_ != nullptr, "the condensed inverse was made without keeping its Schur complement");
    return schur_;
  }

  double bytes() const override {
    const double factors = mumps_ == nullptr ? 0.0 : 8.0 * mumps_->statistics().factorEntries;
    return factors + inverse_->bytes() + (schur_ ? schur_->bytes() : 0.0);
  }

 private:
  // S, and S⁺ from it. @param orderings null: by the analysis that is there.
  void make(const LocalMatrix& matrix, const Kernel& kernel, OrderingCache* orderings) {
    std::vector<double> s = condense(matrix, orderings);
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
    inverse_ = std::make_unique<DenseOperator>(std::move(s), b_, settings_.precision, columns_);
  }

  // S; keeps the factorisation of K_ii, if there is an interior.
  std::vector<double> condense(const LocalMatrix& matrix, OrderingCache* orderings) {
    if (b_ == n_) {
      std::vector<double> whole(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), 0.0);
      for (std::size_t i = 0; i + 1 < matrix.offsets.size(); ++i)
        for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k)
          whole[static_cast<std::size_t>(matrix.columns[k]) * static_cast<std::size_t>(n_) + i] =
              matrix.values[k];
      return whole;
    }
    Triplets triplets = lowerTriangle(matrix, 1);
    const std::size_t hash = patternHash(matrix);
    if (orderings == nullptr) {
      if (hash != patternHash_)
        throw InputError("a matrix is to be factored by the analysis of another one, but its graph differs");
      mumps_->refactorize(std::move(triplets.rows), std::move(triplets.columns), std::move(triplets.values));
      return mumps_->schurComplement();
    }
    patternHash_ = hash;
    MumpsOptions options;
    options.blockLowRank = settings_.blockLowRank;
    std::vector<int>& position = (*orderings)[{n_, hash, boundary_}];
    if (!position.empty())
      options.ordering = MumpsOptions::Ordering::Given;
    mumps_ = std::make_unique<Mumps>(MPI_COMM_SELF, options);
    mumps_->analyse(n_, std::move(triplets.rows), std::move(triplets.columns), boundary_, position);
    if (position.empty())
      position = mumps_->ordering();
    mumps_->factorize(std::move(triplets.values));
    return mumps_->schurComplement();
  }

  int n_;
  int b_;
  std::vector<int> boundary_;
  int columns_;
  LocalInverseSettings settings_;
  std::size_t patternHash_ = 0;
  std::unique_ptr<Mumps> mumps_; ///< of K_ii, with b for Schur rows
  std::unique_ptr<DenseOperator> inverse_;
  std::shared_ptr<const DenseOperator> schur_;
};

} // namespace

std::unique_ptr<LocalInverse> makeImplicitInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                  const std::vector<int>& boundary,
                                                  const LocalInverseSettings& settings) {
  return std::make_unique<ImplicitInverse>(matrix, kernel, boundary, settings);
}

std::unique_ptr<LocalInverse> makeCondensedInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                   const std::vector<int>& boundary, int columns,
                                                   const LocalInverseSettings& settings,
                                                   OrderingCache& orderings) {
  return std::make_unique<CondensedInverse>(matrix, kernel, boundary, columns, settings, orderings);
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
