// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseSpace.hpp"

#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {

CoarseSpace::CoarseSpace(const RigidMotions& motions, const Constraints& constraints)
    : comm_(motions.system().comm()), motions_(motions), rows_(motions, constraints) {
  std::vector<GlobalOrdinal> own(ownColumns().begin(), ownColumns().end()), touched;
  touchedColumns_ = rows_.columns();
  std::sort(touchedColumns_.begin(), touchedColumns_.end());
  touchedColumns_.erase(std::unique(touchedColumns_.begin(), touchedColumns_.end()), touchedColumns_.end());
  for (int column : touchedColumns_)
    touched.push_back(static_cast<GlobalOrdinal>(column));
  for (int column : rows_.columns())
    touched_.push_back(static_cast<int>(
        std::lower_bound(touchedColumns_.begin(), touchedColumns_.end(), column) - touchedColumns_.begin()));
  const auto total = static_cast<Tpetra::global_size_t>(kernelDimension());
  const auto mapOf = [&](Tpetra::global_size_t size, const std::vector<GlobalOrdinal>& list) {
    return Teuchos::rcp(new Map(size, Teuchos::arrayViewFromVector(list), 0, comm_));
  };
  import_ = Teuchos::rcp(new Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>(
      mapOf(total, own), mapOf(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched)));
}

std::vector<double> CoarseSpace::multiply(const MultiVector& lambda, std::size_t column) const {
  MultiVector touched(import_->getTargetMap(), 1);
  {
    const auto in = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto sums = touched.getLocalViewHost(Tpetra::Access::ReadWrite);
    const std::vector<std::size_t>& offsets = rows_.offsets();
    for (std::size_t r = 0; r < rows_.size(); ++r)
      for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k)
        sums(static_cast<std::size_t>(touched_[k]), 0) += rows_.values()[k] * in(r, column);
  }
  return sumsOf(touched);
}

std::vector<double> CoarseSpace::sumsOf(const MultiVector& touched) const {
  MultiVector own(import_->getSourceMap(), 1);
  own.doExport(touched, *import_, Tpetra::ADD);
  const auto view = own.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

std::vector<double> CoarseSpace::diagonal() const {
  MultiVector touched(import_->getTargetMap(), 1);
  {
    const auto sums = touched.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t k = 0; k < touched_.size(); ++k)
      sums(static_cast<std::size_t>(touched_[k]), 0) += rows_.values()[k] * rows_.values()[k];
  }
  return sumsOf(touched);
}

std::vector<double> CoarseSpace::atTouched(const std::vector<double>& s) const {
  MultiVector touched(import_->getTargetMap(), 1), own(import_->getSourceMap(), 1);
  std::copy(s.begin(), s.end(), own.getLocalViewHost(Tpetra::Access::OverwriteAll).data());
  touched.doImport(own, *import_, Tpetra::INSERT);
  const auto view = touched.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

void CoarseSpace::addTransposed(double factor, const std::vector<double>& s, MultiVector& lambda,
                                std::size_t column) const {
  const std::vector<double> at = atTouched(s);
  const auto out = lambda.getLocalViewHost(Tpetra::Access::ReadWrite);
  const std::vector<std::size_t>& offsets = rows_.offsets();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    double sum = 0.0;
    for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k)
      sum += rows_.values()[k] * at[static_cast<std::size_t>(touched_[k])];
    out(r, column) += factor * sum;
  }
}

double CoarseSpace::norm(const std::vector<double>& s) const {
  double sum = 0.0;
  for (double entry : s)
    sum += entry * entry;
  return std::sqrt(globalSum(*comm_, sum));
}

} // namespace Harmos::feti
