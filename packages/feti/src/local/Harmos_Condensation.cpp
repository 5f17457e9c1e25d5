// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Condensation.hpp"

#include "Harmos_Index.hpp"
#include "Harmos_Mumps.hpp"

#include <algorithm>

namespace Harmos::feti {
namespace {

// Keeps L of A_ii alone: L_bi would be as large as S. What is needed of it, twice a run, is made with A_bi.
class MultifrontalCondensation : public Condensation {
 public:
  MultifrontalCondensation(const std::vector<int>& boundary, std::shared_ptr<FactorizationContext> context)
      : boundary_(boundary), context_(std::move(context)) {}

  std::vector<double> condense(const LocalMatrix& matrix) override {
    if (factor_ != nullptr)
      requireGraph(patternHash_, matrix);
    patternHash_ = patternHash(matrix);
    coupling_ = couplingOf(matrix, boundary_);
    if (factor_ == nullptr) {
      bool isNew = false;
      const auto tree = context_->tree(matrix, boundary_, FrontTree::Rest::Stays, isNew);
      counts_.analyses = isNew ? 1 : 0;
      factor_ =
          std::make_unique<MultifrontalCholesky>(matrix, tree, Precision::Double, context_->workspace());
    } else {
      factor_->refactor(matrix, context_->workspace());
    }
    ++counts_.factorizations;
    rows_ = at(matrix.rows());
    return factor_->takeSchurComplement();
  }

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

  double bytes() const override {
    return (factor_ == nullptr ? 0.0 : factor_->bytes()) + 12.0 * static_cast<double>(coupling_.entries());
  }
  FactorizationCounts counts() const override { return counts_; }

 private:
  std::vector<int> boundary_;
  std::shared_ptr<FactorizationContext> context_;
  std::size_t patternHash_ = 0, rows_ = 0;
  std::unique_ptr<MultifrontalCholesky> factor_;
  LocalMatrix coupling_; ///< A_bi
  FactorizationCounts counts_;
};

class MumpsCondensation : public Condensation {
 public:
  MumpsCondensation(double blockLowRank, const std::vector<int>& boundary,
                    std::shared_ptr<FactorizationContext> context)
      : blockLowRank_(blockLowRank), boundary_(boundary), context_(std::move(context)) {}

  std::vector<double> condense(const LocalMatrix& matrix) override {
    Triplets triplets = lowerTriangle(matrix, 1);
    if (mumps_ != nullptr) {
      requireGraph(patternHash_, matrix);
      mumps_->refactorize(std::move(triplets.rows), std::move(triplets.columns), std::move(triplets.values));
      return mumps_->schurComplement();
    }
    patternHash_ = patternHash(matrix);
    MumpsOptions options;
    options.blockLowRank = blockLowRank_;
    std::vector<int>& position = context_->position(matrix, boundary_);
    if (!position.empty())
      options.ordering = MumpsOptions::Ordering::Given;
    mumps_ = std::make_unique<Mumps>(MPI_COMM_SELF, options);
    mumps_->analyse(matrix.rows(), std::move(triplets.rows), std::move(triplets.columns), boundary_,
                    position);
    if (position.empty())
      position = mumps_->ordering();
    mumps_->factorize(std::move(triplets.values));
    return mumps_->schurComplement();
  }

  void reduce(double* f, double* reduced, int count) const override { mumps_->condense(f, reduced, count); }
  void expand(double* f, double* boundary, int count) const override { mumps_->expand(f, boundary, count); }

  double bytes() const override { return mumps_ == nullptr ? 0.0 : 8.0 * mumps_->statistics().factorEntries; }
  FactorizationCounts counts() const override {
    return mumps_ == nullptr
               ? FactorizationCounts{}
               : FactorizationCounts{mumps_->statistics().analyses, mumps_->statistics().factorizations};
  }

 private:
  double blockLowRank_;
  std::vector<int> boundary_;
  std::shared_ptr<FactorizationContext> context_;
  std::size_t patternHash_ = 0;
  std::unique_ptr<Mumps> mumps_;
};

} // namespace

std::unique_ptr<Condensation> makeCondensation(const SparseSolverChoice& solver,
                                               const std::vector<int>& boundary,
                                               std::shared_ptr<FactorizationContext> context) {
  if (solver.name == "MUMPS" || solver.blockLowRank > 0.0)
    return std::make_unique<MumpsCondensation>(solver.blockLowRank, boundary, std::move(context));
  return std::make_unique<MultifrontalCondensation>(boundary, std::move(context));
}

} // namespace Harmos::feti
