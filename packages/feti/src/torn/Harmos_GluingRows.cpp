// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GluingRows.hpp"

#include "Harmos_PivotedCholesky.hpp"

namespace Harmos::feti::Details {

std::vector<std::vector<MultiplierTerm>> multipliersOfUnions(const DofCopies& dofs,
                                                             const std::map<long long, long long>& firstRow,
                                                             const std::vector<std::vector<Lean>>& leans) {
  std::map<long long, std::vector<Lean>> leaning;
  for (const std::vector<Lean>& part : leans)
    for (const Lean& lean : part)
      leaning[lean.name].push_back(lean);
  std::vector<std::vector<MultiplierTerm>> sends(leans.size());
  for (const auto& [name, list] : dofs.unions()) {
    const std::vector<Copy>& copies = dofs.here().at(name);
    std::map<long long, std::size_t> place;
    for (const Copy& copy : copies)
      place.emplace(copy.dof, 0);
    std::size_t n = 0;
    for (auto& item : place)
      item.second = n++;
    std::vector<double> laplacian(n * n, 0.0);
    for (const Union& row : list) {
      const std::size_t a = place.at(row.dofs[0]), b = place.at(row.dofs[1]);
      laplacian[a * n + a] += 1.0;
      laplacian[b * n + b] += 1.0;
      laplacian[b * n + a] -= 1.0;
      laplacian[a * n + b] -= 1.0;
    }
    const PivotedCholesky factor(std::move(laplacian), static_cast<int>(n));
    const auto bear = [&, &taken = list](long long row, const std::vector<double>& force) {
      const std::vector<double> y = factor.solve(force);
      for (const Union& item : taken)
        sends[static_cast<std::size_t>(item.rank)].push_back(
            {item.place, row, (y[place.at(item.dofs[0])] - y[place.at(item.dofs[1])]) / item.coefficient});
    };
    const GluingRows rows(copies);
    for (std::size_t k = 0; k < rows.count(); ++k) {
      std::vector<double> force(n, 0.0);
      for (std::size_t i = 0; i <= k + 1; ++i)
        force[place.at(copies[i].dof)] += rows.value(k, i);
      bear(firstRow.at(name) + static_cast<long long>(k), force);
    }
    for (const Lean& lean : leaning[name]) {
      std::vector<double> force(n, 0.0);
      double whole = 0.0;
      for (const Copy& copy : copies)
        whole += copy.weight;
      for (const Copy& copy : copies)
        force[place.at(copy.dof)] += lean.factor * copy.weight / whole;
      force[place.at(lean.dof)] -= lean.factor;
      bear(lean.row, force);
    }
  }
  return sends;
}

} // namespace Harmos::feti::Details
