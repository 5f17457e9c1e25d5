// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_LocalFactorization.hpp"

#include <algorithm>

namespace Harmos::feti {
namespace {

// Of a condensed matrix L of A_ii alone is kept: L_bi would be as large as S. What is needed of it, twice a
// run, is made with A_bi.
class MultifrontalFactorization : public LocalFactorization {
 public:
  MultifrontalFactorization(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                            std::shared_ptr<FactorizationContext> context)
      : context_(std::move(context)),
        patternHash_(patternHash(matrix)),
        boundary_(settings.boundary),
        isCondensed_(settings.use == LocalFactorizationSettings::Boundary::Condensed) {
    if (settings.precision == Precision::Single && settings.isRefined)
      matrix_ = matrix;
    bool isNew = false;
    tree_ = context_->tree(matrix, boundary_, isCondensed_ ? FrontTree::Rest::Stays : FrontTree::Rest::Absent,
                           isNew);
    counts_ = {isNew ? 1 : 0, 1};
    reached_ = tree_->reachedFrom(settings.ends);
    HARMOS_REQUIRE(!isRefined() || boundary_.empty(), "solutions of a part are not refined");
    factor_ =
        std::make_unique<MultifrontalCholesky>(matrix, tree_, settings.precision, context_->workspace());
    word_ = made_ = settings.precision == Precision::Single ? 4.0 : 8.0;
    take(matrix);
  }

  void solve(double* x, int count) const override {
    if (!isRefined())
      return factor_->solve(x, count);
    const auto n = static_cast<std::size_t>(matrix_.rows());
    residual_.resize(n);
    load_.resize(n);
    for (int c = 0; c < count; ++c, x += n) {
      std::copy(x, x + n, load_.begin());
      factor_->solve(x, 1);
      matrix_.multiply(x, residual_.data());
      for (std::size_t k = 0; k < n; ++k)
        residual_[k] = load_[k] - residual_[k];
      factor_->solve(residual_.data(), 1);
      for (std::size_t k = 0; k < n; ++k)
        x[k] += residual_[k];
    }
  }

  void solveAtEnds(double* x, int count) const override {
    if (isRefined())
      solve(x, count); // the residual needs all of x
    else
      factor_->solveReached(x, count, reached_);
  }

  std::vector<double> takeSchurComplement() override { return factor_->takeSchurComplement(); }

  void reduce(double* f, double* reduced, int count) const override {
    factor_->solve(f, count); // rows of b stay
    for (int c = 0; c < count; ++c, f += rows_, reduced += boundary_.size())
      for (std::size_t b = 0; b < boundary_.size(); ++b) {
        double sum = f[boundary_[b]];
        for (std::size_t k = coupling_.offsets[b]; k < coupling_.offsets[b + 1]; ++k)
          sum -= coupling_.values[k] * f[coupling_.columns[k]];
        reduced[b] = sum;
      }
  }

  // A_ii⁻¹f_i is there: what is to be taken away is A_ii⁻¹ A_ib x_b.
  void expand(double* f, double* boundary, int count) const override {
    std::vector<double> corrections(rows_ * at(count), 0.0);
    double* correction = corrections.data();
    for (std::size_t c = 0; c < at(count); ++c, correction += rows_)
      for (std::size_t b = 0; b < boundary_.size(); ++b)
        for (std::size_t k = coupling_.offsets[b]; k < coupling_.offsets[b + 1]; ++k)
          correction[at(coupling_.columns[k])] += coupling_.values[k] * boundary[c * boundary_.size() + b];
    factor_->solve(corrections.data(), count);
    correction = corrections.data();
    for (int c = 0; c < count; ++c, f += rows_, correction += rows_, boundary += boundary_.size()) {
      for (std::size_t i = 0; i < rows_; ++i)
        f[i] -= correction[i];
      for (std::size_t b = 0; b < boundary_.size(); ++b)
        f[boundary_[b]] = boundary[b];
    }
  }

  bool round() override {
    if (isRefined())
      return false;
    factor_->round();
    return true;
  }
  void keep(Precision precision) override {
    factor_->keep(precision);
    word_ = precision == Precision::Single ? 4.0 : 8.0;
  }

  void refactor(const LocalMatrix& matrix) override {
    Details::requireGraph(patternHash_, matrix);
    factor_->refactor(matrix, context_->workspace());
    word_ = made_;
    ++counts_.factorizations;
    take(matrix);
  }

  double bytes() const override {
    return factor_->bytes() + 12.0 * static_cast<double>(matrix_.entries() + coupling_.entries());
  }
  double bytesRead(int count) const override {
    const double once = 2.0 * word_ * tree_->entriesOf(reached_);
    return count * (isRefined() ? 2.0 * once + 12.0 * static_cast<double>(matrix_.entries()) : once);
  }
  double flops() const override { return 4.0 * tree_->entriesOf(reached_); }
  FactorizationCounts counts() const override { return counts_; }

 private:
  bool isRefined() const { return matrix_.rows() > 0; }
  // What solutions need of the matrix itself.
  void take(const LocalMatrix& matrix) {
    rows_ = at(matrix.rows());
    if (isRefined())
      matrix_ = matrix;
    if (isCondensed_)
      coupling_ = couplingOf(matrix, boundary_);
  }

  std::shared_ptr<FactorizationContext> context_;
  std::size_t patternHash_;
  std::vector<int> boundary_;
  bool isCondensed_;
  std::shared_ptr<const FrontTree> tree_;
  std::vector<char> reached_;
  std::unique_ptr<MultifrontalCholesky> factor_;
  FactorizationCounts counts_;
  double word_ = 8.0, made_ = 8.0; ///< bytes of a number of L: now, and when it is made
  std::size_t rows_ = 0;
  LocalMatrix matrix_;   ///< for residuals
  LocalMatrix coupling_; ///< A_bi
  mutable std::vector<double> load_, residual_;
};

} // namespace

std::unique_ptr<LocalFactorization>
Details::makeMultifrontalFactorization(const LocalMatrix& matrix, const LocalFactorizationSettings& settings,
                                       std::shared_ptr<FactorizationContext> context) {
  return std::make_unique<MultifrontalFactorization>(matrix, settings, std::move(context));
}

} // namespace Harmos::feti
