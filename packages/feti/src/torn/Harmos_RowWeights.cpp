// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RowWeights.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::feti {
namespace Details {

// The diagonal of K at interface dofs, relative to the smallest: multipliers keep their sizes where bodies
// are soft, which is what F and the stopping rules go by without weights too. What is softer than the
// stiffest by more than nine orders of magnitude counts as if it were not: what many stiff subdomains do
// together against it would be lost in rounding errors of the coarse problem.
Weights stiffnessWeights(const SubdomainSystem& system) {
  constexpr double widest = 1e9;
  std::vector<std::vector<double>> weights;
  double largest = 0.0, smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double>& diagonal = system.diagonal(i);
    std::vector<double>& mine = weights.emplace_back();
    for (int local : *system.subdomain(i).interface) {
      mine.push_back(diagonal[static_cast<std::size_t>(local)]);
      largest = std::max(largest, mine.back());
      if (mine.back() > 0.0)
        smallest = std::min(smallest, mine.back());
    }
  }
  largest = globalMax(*system.comm(), largest);
  smallest = std::max(globalMin(*system.comm(), smallest), largest / widest);
  for (std::vector<double>& mine : weights)
    for (double& weight : mine)
      weight = weight > 0.0 ? std::max(weight / smallest, 1.0) : 1.0; // a mechanism: the inverses will tell
  return {std::move(weights), smallest};
}

double meanSoftness(const SubdomainSystem& system) {
  double sums[2] = {0.0, 0.0};
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double> diagonal = system.subdomain(i).stiffness->diagonal();
    for (int local : *system.subdomain(i).interface) {
      sums[0] += diagonal[static_cast<std::size_t>(local)];
      sums[1] += 1.0;
    }
  }
  const double stiffness = globalSum(*system.comm(), sums[0]), dofs = globalSum(*system.comm(), sums[1]);
  return std::max(dofs, 1.0) / std::max(stiffness, std::numeric_limits<double>::min());
}

} // namespace Details

double stiffnessContrast(const SubdomainSystem& system) {
  // What corners and sizes of cells do within a subdomain of one material.
  constexpr double ofMeshes = 10.0;
  double least = std::numeric_limits<double>::infinity(), most = 0.0, within = 1.0;
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<int>& interface = *system.subdomain(i).interface;
    if (interface.empty())
      continue;
    const std::vector<double> diagonal = system.subdomain(i).stiffness->diagonal();
    double sum = 0.0, softest = std::numeric_limits<double>::infinity(), stiffest = 0.0;
    for (int local : interface) {
      const double entry = diagonal[static_cast<std::size_t>(local)];
      sum += entry;
      softest = std::min(softest, entry);
      stiffest = std::max(stiffest, entry);
    }
    if (softest > 0.0)
      within = std::max(within, stiffest / softest / ofMeshes);
    least = std::min(least, sum / static_cast<double>(interface.size()));
    most = std::max(most, sum / static_cast<double>(interface.size()));
  }
  const Teuchos::Comm<int>& comm = *system.comm();
  most = globalMax(comm, most);
  least = globalMin(comm, least);
  within = globalMax(comm, within);
  return most > 0.0 ? std::max(most / least, within) : 1.0;
}

double complianceContrast(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows) {
  double largest = 0.0;
  for (const ConstraintRow& row : rows)
    largest = std::max(largest, row.compliance);
  return 1.0 + globalMax(*system.comm(), largest) / Details::meanSoftness(system);
}

} // namespace Harmos::feti
