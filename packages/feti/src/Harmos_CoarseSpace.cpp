// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseSpace.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <map>

namespace Harmos::feti {
namespace {

struct CoarseEntry {
  long long row;
  double value;
  int column;
};

} // namespace

CoarseSpace::CoarseSpace(const SubdomainSystem& system, const Constraints& constraints)
    : comm_(system.comm()), kernelDimension_(system.kernelDimension()) {
  // Each subdomain makes its rows of G̃; the entries go to the ranks that own the dual rows.
  std::vector<std::vector<CoarseEntry>> sends(static_cast<std::size_t>(comm_->getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Kernel& kernel = system.kernel(i);
    const std::vector<Constraints::Entry>& entries = constraints.entries(i);
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].row == entries[begin].row)
        ++end;
      for (int k = 0; k < kernel.columns; ++k) {
        double value = 0.0;
        for (std::size_t e = begin; e < end; ++e)
          value += entries[e].value * kernel.column(k)[entries[e].dof];
        if (value != 0.0)
          sends[static_cast<std::size_t>(constraints.overlapOwner(entries[begin].row))].push_back(
              {static_cast<long long>(constraints.overlapMap()->getGlobalElement(entries[begin].row)), value,
               system.kernelOffset(i) + k});
      }
      begin = end;
    }
  }
  rows_.resize(localSize(*constraints.rowMap()));
  for (const std::vector<CoarseEntry>& part : exchangeItems(*comm_, sends))
    for (const CoarseEntry& entry : part)
      rows_[static_cast<std::size_t>(
                constraints.rowMap()->getLocalElement(static_cast<GlobalOrdinal>(entry.row)))]
          .emplace_back(entry.column, entry.value);
  for (auto& row : rows_)
    std::sort(row.begin(), row.end());

  const int n = kernelDimension_;
  std::vector<double> gram(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0.0);
  for (const auto& row : rows_)
    for (const auto& [i, left] : row)
      for (const auto& [j, right] : row)
        gram[static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + static_cast<std::size_t>(i)] +=
            left * right;
  globalSum(*comm_, gram);
  factor_ = PivotedCholesky(std::move(gram), n);
  coarseMap_ = Teuchos::rcp(
      new Map(static_cast<Tpetra::global_size_t>(dimension()), 0, comm_, Tpetra::LocallyReplicated));
}

std::vector<int> CoarseSpace::dependentColumns() const {
  return {factor_.pivots().begin() + factor_.rank(), factor_.pivots().end()};
}

std::vector<double> CoarseSpace::applyUnscaled(const MultiVector& lambda, std::size_t column) const {
  std::vector<double> w(static_cast<std::size_t>(kernelDimension_), 0.0);
  const auto view = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    for (const auto& [k, value] : rows_[r])
      w[static_cast<std::size_t>(k)] += value * view(r, column);
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
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    double sum = 0.0;
    for (const auto& [k, value] : rows_[r])
      sum += value * s[static_cast<std::size_t>(k)];
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
  MultiVector projected(X, Teuchos::Copy);
  coarse_.project(projected);
  MultiVector image(Y.getMap(), X.getNumVectors());
  inner_.apply(projected, image);
  coarse_.project(image);
  if (beta == 0.0)
    Y.scale(alpha, image);
  else
    Y.update(alpha, image, beta);
}

} // namespace Harmos::feti
