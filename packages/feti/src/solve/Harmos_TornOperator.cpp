// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TornOperator.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>

#include <algorithm>

namespace Harmos::feti {

TornOperator::TornOperator(Teuchos::RCP<const Teuchos::Comm<int>> comm, std::vector<Subdomain> subdomains,
                           std::vector<ConstraintRow> rows)
    : comm_(std::move(comm)), subdomains_(std::move(subdomains)), rows_(std::move(rows)) {
  std::vector<GlobalOrdinal> dofs;
  agree(*comm_, [&] {
    for (const Subdomain& s : subdomains_) {
      const std::string number = std::to_string(s.number);
      if (!s.stiffness || !s.interface || s.numbers.size() != static_cast<std::size_t>(s.stiffness->rows()) ||
          s.interface->size() != s.numbers.size())
        throw InputError("an operator on global dofs needs the global numbers of all dofs, not of the "
                         "interface alone: subdomain " +
                             number,
                         {{"subdomain", number}});
      dofs.insert(dofs.end(), s.numbers.begin(), s.numbers.end());
    }
    std::sort(dofs.begin(), dofs.end());
    dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  });
  overlapMap_ = Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), dofs.data(),
                                     static_cast<LocalOrdinal>(dofs.size()), 0, comm_));
  map_ = Tpetra::createOneToOne(overlapMap_);
  import_ = Teuchos::rcp(new Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>(map_, overlapMap_));
  std::vector<double> counts(dofs.size(), 0.0), fixed(dofs.size(), 0.0);
  for (const Subdomain& s : subdomains_) {
    std::vector<int>& places = places_.emplace_back();
    for (long long number : s.numbers) {
      const auto place = std::lower_bound(dofs.begin(), dofs.end(), static_cast<GlobalOrdinal>(number));
      places.push_back(static_cast<int>(place - dofs.begin()));
      counts[static_cast<std::size_t>(places.back())] += 1.0;
    }
    for (const FixedDof& dof : s.fixed)
      fixed[static_cast<std::size_t>(places[static_cast<std::size_t>(dof.dof)])] = 1.0;
  }
  MultiVector sums(map_, 2);
  sums.putScalar(0.0);
  addOverlap(counts, sums, 0);
  addOverlap(fixed, sums, 1);
  copies_ = toOverlap(sums, 0);
  const auto view = sums.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t k = 0; k < view.extent(0); ++k)
    isFixed_.push_back(view(k, 1) > 0.0);
}

std::vector<double> TornOperator::toOverlap(const MultiVector& x, std::size_t column) const {
  MultiVector overlap(overlapMap_, 1);
  overlap.doImport(*x.getVector(column), *import_, Tpetra::INSERT);
  const auto view = overlap.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

void TornOperator::addOverlap(const std::vector<double>& overlap, MultiVector& y, std::size_t column) const {
  MultiVector vector(overlapMap_, 1);
  {
    const auto view = vector.getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::copy(overlap.begin(), overlap.end(), view.data());
  }
  y.getVectorNonConst(column)->doExport(vector, *import_, Tpetra::ADD);
}

void TornOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                         Scalar beta) const {
  HARMOS_REQUIRE(mode == Teuchos::NO_TRANS, "a torn operator with fixed dofs is not symmetric");
  MultiVector result(map_, X.getNumVectors());
  result.putScalar(0.0);
  std::vector<double> local, image;
  for (std::size_t c = 0; c < X.getNumVectors(); ++c) {
    const std::vector<double> x = toOverlap(X, c);
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t i = 0; i < subdomains_.size(); ++i) {
      const std::vector<int>& places = places_[i];
      local.resize(places.size());
      image.resize(places.size());
      for (std::size_t k = 0; k < places.size(); ++k)
        local[k] = x[static_cast<std::size_t>(places[k])];
      subdomains_[i].stiffness->multiply(local.data(), image.data());
      for (std::size_t k = 0; k < places.size(); ++k)
        y[static_cast<std::size_t>(places[k])] += image[k];
    }
    addOverlap(y, result, c);
  }
  {
    const auto in = X.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto out = result.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t k = 0; k < isFixed_.size(); ++k)
      for (std::size_t c = 0; isFixed_[k] && c < X.getNumVectors(); ++c)
        out(k, c) = in(k, c);
  }
  Y.update(alpha, result, beta);
}

TornOperator::TornRhs TornOperator::torn(const MultiVector& b, std::size_t column) const {
  const std::vector<double> values = toOverlap(b, column);
  TornRhs result;
  for (std::size_t i = 0; i < subdomains_.size(); ++i) {
    std::vector<double> load;
    for (int place : places_[i])
      load.push_back(values[static_cast<std::size_t>(place)] / copies_[static_cast<std::size_t>(place)]);
    std::vector<double>& prescribed = result.prescribed.emplace_back();
    for (const FixedDof& dof : subdomains_[i].fixed) {
      const auto k = static_cast<std::size_t>(dof.dof);
      prescribed.push_back(values[static_cast<std::size_t>(places_[i][k])]);
      load[k] = 0.0;
    }
    result.loads.push_back(std::make_shared<const std::vector<double>>(std::move(load)));
  }
  return result;
}

void TornOperator::join(const TornVector& u, MultiVector& x, std::size_t column) const {
  std::vector<double> sums(copies_.size(), 0.0);
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t k = 0; k < u[i].size(); ++k) {
      const auto place = static_cast<std::size_t>(places_[i][k]);
      sums[place] += u[i][k] / copies_[place];
    }
  x.getVectorNonConst(column)->putScalar(0.0);
  addOverlap(sums, x, column);
}

} // namespace Harmos::feti
