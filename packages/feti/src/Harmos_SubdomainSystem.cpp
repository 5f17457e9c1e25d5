// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainSystem.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace Harmos::feti {
namespace {

// Rounding of a row of nnz entries is at most nnz ε relative to ‖K‖_∞‖r‖_∞; assembly adds a few ε more. 1e-12
// stands for some thousand times ε.
constexpr double kernelTolerance = 1e-12;

std::string name(const Subdomain& subdomain) {
  return "subdomain " + std::to_string(subdomain.number);
}

ErrorData dataOf(const Subdomain& subdomain) {
  return {{"subdomain", std::to_string(subdomain.number)}};
}

void requireFinite(const std::vector<double>& values, const Subdomain& subdomain, const std::string& what) {
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values[k]))
      throw InputError("the " + what + " of " + name(subdomain) + " is not finite (entry " +
                           std::to_string(k) + "); check materials, coordinates and loads",
                       dataOf(subdomain));
}

// K and f with the trivial equations: rows and columns of fixed dofs cleared, k on their diagonal.
std::pair<std::shared_ptr<const LocalMatrix>, std::vector<double>> withTrivialEquations(const Subdomain& s) {
  auto matrix = std::make_shared<LocalMatrix>(*s.stiffness);
  std::vector<double> rhs = s.load;
  double mean = 0.0;
  for (double entry : matrix->diagonal())
    mean += entry;
  mean /= std::max(1, matrix->rows());
  std::vector<double> value(static_cast<std::size_t>(matrix->rows()), 0.0);
  std::vector<bool> isFixed(static_cast<std::size_t>(matrix->rows()), false);
  for (const FixedDof& fixed : s.fixed) {
    value[static_cast<std::size_t>(fixed.dof)] = fixed.value;
    isFixed[static_cast<std::size_t>(fixed.dof)] = true;
  }
  for (std::size_t i = 0; i < isFixed.size(); ++i)
    for (std::size_t k = matrix->offsets[i]; k < matrix->offsets[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(matrix->columns[k]);
      if (!isFixed[i] && !isFixed[j])
        continue;
      if (!isFixed[i])
        rhs[i] -= matrix->values[k] * value[j];
      matrix->values[k] = i == j ? mean : 0.0;
    }
  for (const FixedDof& fixed : s.fixed)
    rhs[static_cast<std::size_t>(fixed.dof)] = mean * fixed.value;
  return {matrix, rhs};
}

} // namespace

SubdomainSystem::SubdomainSystem(Teuchos::RCP<const Teuchos::Comm<int>> comm,
                                 std::vector<Subdomain> subdomains, DirichletForm form)
    : comm_(std::move(comm)), subdomains_(std::move(subdomains)), form_(form) {
  agree(*comm_, [&] {
    checkInput();
    build();
  });

  // Numbers 0 … N−1, each once; the order of the kernels follows them, whatever the distribution.
  struct Item {
    long long number;
    int columns;
  };
  std::vector<Item> mine;
  long long dofs = 0;
  for (int i = 0; i < size(); ++i) {
    mine.push_back({subdomain(i).number, kernel(i).columns});
    dofs += matrix(i).rows();
  }
  std::vector<Item> all = gatherAll(*comm_, mine);
  std::sort(all.begin(), all.end(), [](const Item& a, const Item& b) { return a.number < b.number; });
  globalSubdomains_ = static_cast<long long>(all.size());
  primalDimension_ = globalSum(*comm_, dofs);
  allOffsets_ = {0};
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].number != static_cast<long long>(k))
      throw InputError("subdomains must be numbered 0, 1, ... without gaps and each on one rank; number " +
                       std::to_string(k) + " is missing or double");
    allOffsets_.push_back(allOffsets_.back() + all[k].columns);
  }
  kernelDimension_ = allOffsets_.back();
  for (int i = 0; i < size(); ++i)
    kernelOffsets_.push_back(allOffsets_[static_cast<std::size_t>(subdomain(i).number)]);
}

void SubdomainSystem::checkInput() const {
  for (const Subdomain& s : subdomains_) {
    if (!s.stiffness || !s.motions)
      throw InputError(name(s) + " has no stiffness matrix or no kernel", dataOf(s));
    const int n = s.stiffness->rows();
    const auto length = static_cast<std::size_t>(n);
    if (s.load.size() != length || s.dofs.size() != length || s.motions->rows != n)
      throw InputError(name(s) + ": stiffness, load, dof numbers and kernel differ in length", dataOf(s));
    for (int dof : s.interface)
      if (dof < 0 || dof >= n)
        throw InputError(name(s) + ": there is no interface dof " + std::to_string(dof), dataOf(s));
    std::map<int, double> values;
    for (const FixedDof& fixed : s.fixed)
      if (const auto [place, isNew] = values.emplace(fixed.dof, fixed.value);
          !isNew && place->second != fixed.value)
        throw InputError(name(s) + ": dof " + std::to_string(fixed.dof) + " is fixed to " +
                             scientific(place->second) + " and to " + scientific(fixed.value) +
                             "; do two boundary parts with different values meet there?",
                         dataOf(s));
    for (const FixedDof& fixed : s.fixed)
      if (fixed.dof < 0 || fixed.dof >= n || !std::isfinite(fixed.value))
        throw InputError(name(s) +
                             ": a Dirichlet condition names a dof that is not there or a value that is not "
                             "finite (dof " +
                             std::to_string(fixed.dof) + ")",
                         dataOf(s));
    requireFinite(s.stiffness->values, s, "stiffness matrix");
    requireFinite(s.load, s, "load");
    for (std::size_t i = 0; i < length; ++i) {
      double largest = 0.0;
      for (std::size_t k = s.stiffness->offsets[i]; k < s.stiffness->offsets[i + 1]; ++k)
        largest = std::max(largest, std::abs(s.stiffness->values[k]));
      if (largest == 0.0)
        throw InputError("row " + std::to_string(i) + " of the stiffness matrix of " + name(s) +
                             " is zero: a material has zero stiffness, or a node belongs to no element",
                         dataOf(s));
    }
  }
}

void SubdomainSystem::build() {
  for (const Subdomain& s : subdomains_) {
    const double defect = kernelDefect(*s.stiffness, *s.motions);
    if (!(defect <= kernelTolerance))
      throw NumericalError(
          "the kernel given for " + name(s) + " is none: ‖KR‖/(‖K‖‖R‖) = " + scientific(defect) +
              ", at most " + scientific(kernelTolerance, 0) +
              " was expected; is the subdomain held by more than its Dirichlet conditions, or "
              "are its coordinates wrong?",
          {{"subdomain", std::to_string(s.number)}, {"defect", scientific(defect)}});
    if (form_ == DirichletForm::Primal && !s.fixed.empty()) {
      auto [matrix, rhs] = withTrivialEquations(s);
      matrices_.push_back(std::move(matrix));
      rhs_.push_back(std::move(rhs));
      std::vector<int> fixed;
      for (const FixedDof& f : s.fixed)
        fixed.push_back(f.dof);
      kernels_.push_back(heldKernel(*s.motions, fixed));
    } else {
      matrices_.push_back(s.stiffness);
      rhs_.push_back(s.load);
      kernels_.push_back(heldKernel(*s.motions, {}));
    }
  }
}

long long SubdomainSystem::kernelOwner(int column) const {
  const auto next = std::upper_bound(allOffsets_.begin(), allOffsets_.end(), column);
  return static_cast<long long>(next - allOffsets_.begin()) - 1;
}

TornVector SubdomainSystem::zeroVector() const {
  TornVector result;
  for (int i = 0; i < size(); ++i)
    result.emplace_back(static_cast<std::size_t>(matrix(i).rows()), 0.0);
  return result;
}

} // namespace Harmos::feti
