// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualOperator.hpp"

#include "Harmos_Agreement.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace Harmos::feti {

DualOperator::DualOperator(const SubdomainSystem& system, const Constraints& constraints,
                           const LocalInverses& inverses)
    : system_(system), constraints_(constraints), inverses_(inverses) {}

void DualOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                         Scalar beta) const {
  const std::size_t columns = X.getNumVectors();
  MultiVector in(constraints_.overlapMap(), columns), out(constraints_.overlapMap(), columns);
  in.doImport(X, *constraints_.importer(), Tpetra::INSERT);
  {
    const auto inView = in.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto outView = out.getLocalViewHost(Tpetra::Access::OverwriteAll);
    const std::size_t rows = outView.extent(0);
    std::vector<double> t, u;
    for (std::size_t c = 0; c < columns; ++c) {
      double* result = rows > 0 ? &outView(0, c) : nullptr;
      const double* source = rows > 0 ? &inView(0, c) : nullptr;
      std::fill(result, result + rows, 0.0);
      try {
        for (int i = 0; i < system_.size(); ++i) {
          t.assign(static_cast<std::size_t>(system_.matrix(i).rows()), 0.0);
          u.resize(t.size());
          constraints_.addBt(i, source, t.data());
          inverses_[i].apply(t.data(), u.data());
          constraints_.addB(i, u.data(), result);
        }
      } catch (...) {
        failure_ = std::current_exception();
        std::fill(result, result + rows, std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  MultiVector image(Y.getMap(), columns);
  image.doExport(out, *constraints_.importer(), Tpetra::ADD);
  if (beta == 0.0)
    Y.scale(alpha, image); // Y may be uninitialised: 0·NaN is to be avoided
  else
    Y.update(alpha, image, beta);
}

void DualOperator::rethrowFailure() const {
  agreeOnFailure(*system_.comm(), failure_);
}

} // namespace Harmos::feti
