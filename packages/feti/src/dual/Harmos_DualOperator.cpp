// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualOperator.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>

namespace Harmos::feti {
namespace {

std::vector<SubdomainSum::Group> makeGroups(const Constraints& constraints, const LocalInverses& inverses) {
  std::vector<SubdomainSum::Group> groups;
  for (std::size_t c = 0; c < inverses.classes().size(); ++c) {
    const CongruenceClass& item = inverses.classes()[c];
    SubdomainSum::Group group;
    group.op = inverses.boundaryOperator(c);
    group.members = static_cast<int>(item.members.size());
    group.entries = boundaryEntries(constraints.entries(), item);
    groups.push_back(std::move(group));
  }
  return groups;
}

} // namespace

std::vector<SubdomainSum::Entry> boundaryEntries(const std::vector<std::vector<Constraints::Entry>>& entries,
                                                 const CongruenceClass& ofClass) {
  std::vector<SubdomainSum::Entry> result;
  const std::vector<int>& boundary = ofClass.boundary;
  const int size = static_cast<int>(boundary.size());
  for (std::size_t m = 0; m < ofClass.members.size(); ++m)
    for (const Constraints::Entry& entry : entries[static_cast<std::size_t>(ofClass.members[m])]) {
      const auto place = std::lower_bound(boundary.begin(), boundary.end(), entry.dof);
      result.push_back(
          {entry.row, static_cast<int>(m) * size + static_cast<int>(place - boundary.begin()), entry.value});
    }
  return result;
}

DualOperator::DualOperator(const Constraints& constraints, const LocalInverses& inverses)
    : SubdomainSum(constraints.importer(), makeGroups(constraints, inverses), inverses.sharedJoined()),
      constraints_(constraints),
      joined_(inverses.sharedJoined()) {}

void DualOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                         Scalar beta) const {
  SubdomainSum::apply(X, Y, mode, alpha, beta);
  if (joined_)
    joined_->clusters().removeJoined(Y);
  if (!constraints_.hasCompliance())
    return;
  const auto x = X.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto y = Y.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < y.extent(0); ++r)
    if (const double compliance = constraints_.compliance(static_cast<int>(r)); compliance > 0.0)
      for (std::size_t k = 0; k < y.extent(1); ++k)
        y(r, k) += alpha * compliance * x(r, k);
}

} // namespace Harmos::feti
