// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SparseFactor.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::feti {
namespace {

class MultifrontalFactor : public SparseFactor {
 public:
  MultifrontalFactor(const LocalMatrix& matrix, const SparseFactorSettings& settings,
                     std::shared_ptr<FactorizationContext> context)
      : context_(std::move(context)), patternHash_(patternHash(matrix)) {
    bool isNew = false;
    tree_ = context_->tree(matrix, settings.absent, FrontTree::Rest::Absent, isNew);
    counts_ = {isNew ? 1 : 0, 1};
    reached_ = tree_->reachedFrom(settings.ends);
    isRefined_ = settings.precision == Precision::Single && settings.isRefined;
    HARMOS_REQUIRE(!isRefined_ || settings.absent.empty(), "solutions of a part are not refined");
    factor_ =
        std::make_unique<MultifrontalCholesky>(matrix, tree_, settings.precision, context_->workspace());
    word_ = made_ = settings.precision == Precision::Single ? 4.0 : 8.0;
    if (isRefined_)
      matrix_ = matrix;
  }

  void solve(double* x, int count) const override {
    if (!isRefined_)
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
    if (isRefined_)
      solve(x, count); // the residual needs all of x
    else
      factor_->solveReached(x, count, reached_);
  }

  bool round() override {
    if (isRefined_)
      return false;
    factor_->round();
    return true;
  }
  void keep(Precision precision) override {
    factor_->keep(precision);
    word_ = precision == Precision::Single ? 4.0 : 8.0;
  }

  void refactor(const LocalMatrix& matrix) override {
    requireGraph(patternHash_, matrix);
    factor_->refactor(matrix, context_->workspace());
    word_ = made_;
    ++counts_.factorizations;
    if (isRefined_)
      matrix_ = matrix;
  }

  double bytes() const override { return factor_->bytes() + 12.0 * static_cast<double>(matrix_.entries()); }
  double bytesRead(int count) const override {
    const double once = 2.0 * word_ * tree_->entriesOf(reached_);
    return count * (isRefined_ ? 2.0 * once + 12.0 * static_cast<double>(matrix_.entries()) : once);
  }
  double flops() const override { return 4.0 * tree_->entriesOf(reached_); }
  FactorizationCounts counts() const override { return counts_; }

 private:
  std::shared_ptr<FactorizationContext> context_;
  std::size_t patternHash_;
  std::shared_ptr<const FrontTree> tree_;
  std::vector<char> reached_;
  std::unique_ptr<MultifrontalCholesky> factor_;
  FactorizationCounts counts_;
  double word_ = 8.0, made_ = 8.0; ///< bytes of a number of L: now, and when it is made
  bool isRefined_ = false;
  LocalMatrix matrix_; ///< for residuals
  mutable std::vector<double> load_, residual_;
};

// A, with unit rows where some are absent.
LocalMatrix without(const LocalMatrix& matrix, const std::vector<int>& absent) {
  LocalMatrix result = matrix;
  std::vector<bool> isAbsent(static_cast<std::size_t>(result.rows()), false);
  for (int row : absent)
    isAbsent[static_cast<std::size_t>(row)] = true;
  for (std::size_t i = 0; i < isAbsent.size(); ++i)
    for (std::size_t k = result.offsets[i]; k < result.offsets[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(result.columns[k]);
      if (i != j && (isAbsent[i] || isAbsent[j]))
        result.values[k] = 0.0;
    }
  return result;
}

// Any solver of Amesos2, MUMPS by Harmos' own adapter. It solves for many right-hand sides at once, and
// always for all of them.
class AmesosFactor : public SparseFactor {
 public:
  AmesosFactor(const LocalMatrix& matrix, const SparseFactorSettings& settings)
      : absent_(settings.absent),
        solve_(absent_.empty() ? matrix : without(matrix, absent_),
               settings.solver.name == SparseSolverChoice::multifrontal ? "MUMPS" : settings.solver.name,
               settings.precision, settings.solver.blockLowRank) {}

  void solve(double* x, int count) const override { solve_.solve(x, count); }
  void solveAtEnds(double* x, int count) const override { solve_.solve(x, count); }
  void refactor(const LocalMatrix& matrix) override {
    solve_.refactor(absent_.empty() ? matrix : without(matrix, absent_));
  }
  double bytes() const override { return solve_.bytes(); }
  double bytesRead(int) const override { return 2.0 * bytes(); } // forward and backward
  double flops() const override { return solve_.flops(); }
  FactorizationCounts counts() const override { return solve_.counts(); }

 private:
  std::vector<int> absent_;
  SparseSolve solve_;
};

} // namespace

bool SparseSolverChoice::isAvailable(const std::string& name) {
  return name == multifrontal || SparseSolve::isAvailable(name);
}

std::vector<std::string> SparseSolverChoice::available() {
  std::vector<std::string> result = {multifrontal, mumps};
  for (const char* name : {"KLU2", "Basker", "CHOLMOD", "SuperLU", "UMFPACK", "PardisoMKL", "LAPACK"})
    if (SparseSolve::isAvailable(name))
      result.push_back(name);
  return result;
}

std::shared_ptr<const FrontTree> FactorizationContext::tree(const LocalMatrix& pattern,
                                                            const std::vector<int>& rest, FrontTree::Rest use,
                                                            bool& isNew) {
  const std::size_t entries = pattern.entries(), hash = patternHash(pattern);
  std::shared_ptr<const FrontTree>& known = trees_[{entries, hash, rest, use == FrontTree::Rest::Absent}];
  isNew = known == nullptr;
  if (isNew) {
    std::shared_ptr<const FrontTree>& last = last_[{entries, hash}];
    known = std::make_shared<FrontTree>(pattern, rest, use, last.get());
    last = known;
  }
  return known;
}

std::vector<int>& FactorizationContext::position(const LocalMatrix& pattern, const std::vector<int>& rest) {
  return positions_[{pattern.entries(), patternHash(pattern), rest, false}];
}

std::unique_ptr<SparseFactor> makeSparseFactor(const LocalMatrix& matrix,
                                               const SparseFactorSettings& settings,
                                               std::shared_ptr<FactorizationContext> context) {
  if (settings.solver.isMultifrontal())
    return std::make_unique<MultifrontalFactor>(matrix, settings, std::move(context));
  return std::make_unique<AmesosFactor>(matrix, settings);
}

} // namespace Harmos::feti
