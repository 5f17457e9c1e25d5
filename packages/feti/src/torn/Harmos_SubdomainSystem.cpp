// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainSystem.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

namespace Harmos::feti {
namespace {

// Rounding of a row of nnz entries is at most nnz ε relative to ‖K‖_∞‖r‖_∞; assembly adds a few ε more. 1e-12
// stands for some thousand times ε.
constexpr double kernelTolerance = 1e-12;

// Assembly of congruent subdomains at different places differs by rounding errors.
constexpr double sharingTolerance = 1e-12;

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

std::vector<int> fixedDofs(const Subdomain& s) {
  std::vector<int> dofs;
  for (const FixedDof& fixed : s.fixed)
    dofs.push_back(fixed.dof);
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  return dofs;
}

double meanDiagonal(const LocalMatrix& matrix) {
  double mean = 0.0;
  for (double entry : matrix.diagonal())
    mean += entry;
  return mean / std::max(1, matrix.rows());
}

// K with the trivial equations: rows and columns of fixed dofs cleared, k on their diagonal.
LocalMatrix matrixWithTrivialEquations(const LocalMatrix& stiffness, const std::vector<int>& fixed) {
  LocalMatrix matrix = stiffness;
  const double mean = meanDiagonal(stiffness);
  std::vector<bool> isFixed(static_cast<std::size_t>(matrix.rows()), false);
  for (int dof : fixed)
    isFixed[static_cast<std::size_t>(dof)] = true;
  for (std::size_t i = 0; i < isFixed.size(); ++i)
    for (std::size_t k = matrix.offsets[i]; k < matrix.offsets[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(matrix.columns[k]);
      if (isFixed[i] || isFixed[j])
        matrix.values[k] = i == j ? mean : 0.0;
    }
  return matrix;
}

// f that belongs to it.
std::vector<double> loadWithTrivialEquations(const Subdomain& s) {
  const LocalMatrix& stiffness = *s.stiffness;
  std::vector<double> rhs = *s.load;
  std::vector<double> value(rhs.size(), 0.0);
  std::vector<bool> isFixed(rhs.size(), false);
  bool moved = false;
  for (const FixedDof& fixed : s.fixed) {
    value[static_cast<std::size_t>(fixed.dof)] = fixed.value;
    isFixed[static_cast<std::size_t>(fixed.dof)] = true;
    moved = moved || fixed.value != 0.0;
  }
  if (moved)
    for (std::size_t i = 0; i < rhs.size(); ++i)
      for (std::size_t k = stiffness.offsets[i]; !isFixed[i] && k < stiffness.offsets[i + 1]; ++k)
        rhs[i] -= stiffness.values[k] * value[static_cast<std::size_t>(stiffness.columns[k])];
  const double mean = meanDiagonal(stiffness);
  for (const FixedDof& fixed : s.fixed)
    rhs[static_cast<std::size_t>(fixed.dof)] = mean * fixed.value;
  return rhs;
}

// The first of equal keys makes the value, the others get the same object.
template<class Key, class Value>
class Shared {
 public:
  Shared() = default;
  explicit Shared(std::map<Key, std::shared_ptr<const Value>> known) : values_(std::move(known)) {}
  template<class Make>
  std::shared_ptr<const Value> get(const Key& key, Make&& make) {
    std::shared_ptr<const Value>& value = values_[key];
    if (!value)
      value = std::make_shared<const Value>(make());
    return value;
  }

 private:
  std::map<Key, std::shared_ptr<const Value>> values_;
};

} // namespace

SubdomainSystem::SubdomainSystem(Teuchos::RCP<const Teuchos::Comm<int>> comm,
                                 std::vector<Subdomain> subdomains, DirichletForm form)
    : comm_(std::move(comm)), subdomains_(std::move(subdomains)), form_(form) {
  agree(*comm_, [&] {
    checkInput();
    shareStiffness();
    build({});
    firstKernels_ = kernels_;
  });

  // Numbers 0 … N−1, each once; the order of the kernels follows them, whatever the distribution.
  long long dofs = 0;
  for (int i = 0; i < size(); ++i)
    dofs += matrix(i).rows();
  globalSubdomains_ = globalSum(*comm_, static_cast<long long>(size()));
  primalDimension_ = globalSum(*comm_, dofs);
  numberKernels();
}

// Each rank looks after a share of the numbers, so that none has a list of all.
void SubdomainSystem::numberKernels() {
  struct Item {
    long long number;
    int columns;
  };
  const auto ranks = static_cast<long long>(comm_->getSize());
  const long long share = std::max(1LL, (globalSubdomains_ + ranks - 1) / ranks);
  const auto homeOf = [&](long long number) { // of what is no number: the last
    return static_cast<std::size_t>(number < 0 ? ranks - 1 : std::min(number / share, ranks - 1));
  };
  std::vector<std::vector<Item>> sends(static_cast<std::size_t>(ranks));
  for (int i = 0; i < size(); ++i)
    sends[homeOf(subdomain(i).number)].push_back({subdomain(i).number, kernel(i).columns});
  const std::vector<std::vector<Item>> arrived = exchangeItems(*comm_, sends);
  const long long first = std::min(share * comm_->getRank(), globalSubdomains_),
                  last = std::min(share * (comm_->getRank() + 1), globalSubdomains_);
  std::vector<int> columns(static_cast<std::size_t>(last - first), -1);
  agree(*comm_, [&] {
    const auto require = [](bool is, long long number) {
      if (!is)
        throw InputError("subdomains must be numbered 0, 1, ... without gaps, each on one rank; number " +
                         std::to_string(number) + " is missing or duplicated");
    };
    for (const std::vector<Item>& items : arrived)
      for (const Item& item : items)
        if (item.number >= first && item.number < last) {
          int& place = columns[static_cast<std::size_t>(item.number - first)];
          require(place < 0, item.number);
          place = item.columns;
        }
    for (std::size_t k = 0; k < columns.size(); ++k)
      require(columns[k] >= 0, first + static_cast<long long>(k));
  });
  long long mine = 0;
  for (int count : columns)
    mine += count;
  kernelDimension_ = static_cast<int>(globalSum(*comm_, mine));
  std::vector<int> offsets;
  auto offset = static_cast<int>(exclusiveScan(*comm_, mine));
  for (int count : columns) {
    offsets.push_back(offset);
    offset += count;
  }
  std::vector<std::vector<Item>> answers(static_cast<std::size_t>(ranks));
  for (std::size_t r = 0; r < arrived.size(); ++r)
    for (const Item& item : arrived[r])
      answers[r].push_back({item.number, offsets[static_cast<std::size_t>(item.number - first)]});
  const std::vector<std::vector<Item>> back = exchangeItems(*comm_, answers);
  std::vector<std::size_t> next(back.size(), 0); // answers come in the order of the questions
  for (int i = 0; i < size(); ++i) {
    const std::size_t home = homeOf(subdomain(i).number);
    kernelOffsets_.push_back(back[home][next[home]++].columns);
  }
}

namespace {

void checkInterface(const Subdomain& s) {
  for (std::size_t k = 0; k < s.interface->size(); ++k) {
    const int dof = (*s.interface)[k];
    if (dof < 0 || dof >= s.stiffness->rows())
      throw InputError(name(s) + ": there is no interface dof " + std::to_string(dof), dataOf(s));
    if (k > 0 && dof <= (*s.interface)[k - 1])
      throw InputError(name(s) + ": interface dofs must be unique and ascending (dof " + std::to_string(dof) +
                           ")",
                       dataOf(s));
  }
}

void checkFixed(const Subdomain& s) {
  std::map<int, double> values;
  for (const FixedDof& fixed : s.fixed)
    if (const auto [place, isNew] = values.emplace(fixed.dof, fixed.value);
        !isNew && place->second != fixed.value)
      throw InputError(name(s) + ": dof " + std::to_string(fixed.dof) + " is fixed to " +
                           scientific(place->second) + " and to " + scientific(fixed.value) +
                           "; check boundary parts with different values that meet there",
                       dataOf(s));
  for (const FixedDof& fixed : s.fixed) {
    if (!std::binary_search(s.interface->begin(), s.interface->end(), fixed.dof))
      throw InputError(name(s) + ": dof " + std::to_string(fixed.dof) +
                           " has a Dirichlet condition but is no interface dof; add it to them",
                       dataOf(s));
    if (!std::isfinite(fixed.value))
      throw InputError(name(s) + ": the prescribed value of dof " + std::to_string(fixed.dof) +
                           " is not finite",
                       dataOf(s));
  }
}

void checkStiffness(const Subdomain& s) {
  requireFinite(s.stiffness->values, s, "stiffness matrix");
  const std::vector<double> diagonal = s.stiffness->diagonal();
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    double largest = 0.0;
    for (std::size_t k = s.stiffness->offsets[i]; k < s.stiffness->offsets[i + 1]; ++k)
      largest = std::max(largest, std::abs(s.stiffness->values[k]));
    if (largest == 0.0)
      throw InputError("row " + std::to_string(i) + " of the stiffness matrix of " + name(s) +
                           " is zero; check for a material with zero stiffness or a node without elements",
                       dataOf(s));
    if (!(diagonal[i] > 0.0))
      throw InputError("the stiffness matrix of " + name(s) +
                           " is not positive semidefinite: its diagonal entry " + std::to_string(i) + " is " +
                           scientific(diagonal[i]) + "; check for a material with negative stiffness",
                       dataOf(s));
  }
}

} // namespace

void SubdomainSystem::checkInput() const {
  std::set<const void*> checked; // what is shared is looked at once
  for (const Subdomain& s : subdomains_) {
    if (!s.stiffness || !s.motions || !s.load || !s.interface)
      throw InputError(name(s) + " has no stiffness matrix, kernel, load or list of interface dofs",
                       dataOf(s));
    const int n = s.stiffness->rows();
    if (s.load->size() != static_cast<std::size_t>(n) || s.motions->rows != n)
      throw InputError(name(s) + ": stiffness, load and kernel differ in length", dataOf(s));
    if (s.interface->size() != s.numbers.size())
      throw InputError(name(s) + ": each interface dof needs one global number", dataOf(s));
    if (checked.insert(s.interface.get()).second)
      checkInterface(s);
    checkFixed(s);
    if (checked.insert(s.load.get()).second)
      requireFinite(*s.load, s, "load");
    if (checked.insert(s.stiffness.get()).second)
      checkStiffness(s);
  }
}

// Candidates have the same hash of the pattern; entries decide.
void SubdomainSystem::shareStiffness() {
  std::map<std::size_t, std::vector<std::shared_ptr<const LocalMatrix>>> representatives;
  std::map<const LocalMatrix*, std::shared_ptr<const LocalMatrix>> known;
  for (Subdomain& s : subdomains_) {
    std::shared_ptr<const LocalMatrix>& representative = known[s.stiffness.get()];
    if (!representative) {
      auto& candidates = representatives[patternHash(*s.stiffness)];
      const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const auto& candidate) {
        return sameContent(*candidate, *s.stiffness, sharingTolerance);
      });
      representative = found != candidates.end() ? *found : candidates.emplace_back(s.stiffness);
    }
    s.stiffness = representative;
  }
}

void SubdomainSystem::setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads) {
  agree(*comm_, [&] {
    if (loads.size() != subdomains_.size())
      throw InputError("new loads must cover each subdomain of the rank: " +
                       std::to_string(subdomains_.size()) + ", not " + std::to_string(loads.size()));
    for (std::size_t i = 0; i < loads.size(); ++i) {
      if (!loads[i] || loads[i]->size() != subdomains_[i].load->size())
        throw InputError(name(subdomains_[i]) + ": a load needs a value for each row of the stiffness matrix",
                         dataOf(subdomains_[i]));
      requireFinite(*loads[i], subdomains_[i], "load");
    }
  });
  for (std::size_t i = 0; i < loads.size(); ++i)
    subdomains_[i].load = std::move(loads[i]);
  updateRhs();
}

void SubdomainSystem::setPrescribed(const std::vector<std::vector<double>>& values) {
  agree(*comm_, [&] {
    for (std::size_t i = 0; i < std::max(values.size(), subdomains_.size()); ++i) {
      if (i >= values.size() || i >= subdomains_.size() || values[i].size() != subdomains_[i].fixed.size())
        throw InputError(
            "new prescribed values must cover each Dirichlet condition of each subdomain of the rank");
      requireFinite(values[i], subdomains_[i], "prescribed value");
    }
  });
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = 0; k < values[i].size(); ++k)
      subdomains_[i].fixed[k].value = values[i][k];
  updateRhs();
}

void SubdomainSystem::setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                                  const std::vector<std::shared_ptr<const Kernel>>& motions) {
  const std::vector<Subdomain> before = subdomains_;
  const auto matrices = matrices_;
  const auto rhs = rhs_;
  const auto kernels = kernels_;
  const auto diagonals = diagonals_;
  // What stays the same stays the same object, by which inverses know it.
  Known known;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::vector<int> fixed = heldDofs(before[i]);
    if (!fixed.empty())
      known.matrices[{before[i].stiffness.get(), fixed}] = matrices_[i];
    known.kernels[{before[i].motions.get(), fixed}] = kernels_[i];
  }
  try {
    agree(*comm_, [&] {
      if (stiffness.size() != before.size() || (!motions.empty() && motions.size() != before.size()))
        throw InputError("new matrices must cover each subdomain of the rank: " +
                         std::to_string(before.size()) + ", not " + std::to_string(stiffness.size()));
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (!stiffness[i] || stiffness[i]->offsets != before[i].stiffness->offsets ||
            stiffness[i]->columns != before[i].stiffness->columns)
          throw InputError(name(before[i]) + ": the new stiffness matrix has another graph",
                           dataOf(before[i]));
        if (stiffness[i]->values != before[i].stiffness->values)
          subdomains_[i].stiffness = stiffness[i];
        if (!motions.empty() && motions[i] &&
            (motions[i]->rows != before[i].motions->rows || motions[i]->values != before[i].motions->values))
          subdomains_[i].motions = motions[i];
      }
      checkInput();
      shareStiffness();
      build(std::move(known));
      for (std::size_t i = 0; i < before.size(); ++i)
        if (kernels_[i]->columns != kernels[i]->columns)
          throw InputError(name(before[i]) + ": the new matrix has a kernel of dimension " +
                               std::to_string(kernels_[i]->columns) + ", the old one of " +
                               std::to_string(kernels[i]->columns),
                           dataOf(before[i]));
    });
  } catch (...) {
    subdomains_ = before;
    matrices_ = matrices;
    rhs_ = rhs;
    kernels_ = kernels;
    diagonals_ = diagonals;
    throw;
  }
}

// f of the subdomains: with the trivial equations; or without loads on prescribed values, which the rows of
// those bear whatever happens, and beside which all else may be rounding errors.
void SubdomainSystem::updateRhs() {
  using Load = std::vector<double>;
  Shared<std::pair<const Load*, std::vector<int>>, Load> borne;
  rhs_.clear();
  for (const Subdomain& s : subdomains_) {
    std::vector<int> loaded;
    for (const FixedDof& fixed : s.fixed)
      if ((*s.load)[static_cast<std::size_t>(fixed.dof)] != 0.0)
        loaded.push_back(fixed.dof);
    if (form_ == DirichletForm::Primal && !s.fixed.empty())
      rhs_.push_back(std::make_shared<const Load>(loadWithTrivialEquations(s)));
    else if (loaded.empty())
      rhs_.push_back(s.load);
    else
      rhs_.push_back(borne.get({s.load.get(), loaded}, [&] {
        Load rest = *s.load;
        for (int dof : loaded)
          rest[static_cast<std::size_t>(dof)] = 0.0;
        return rest;
      }));
    if (const Frame* own = frame(static_cast<int>(rhs_.size()) - 1)) {
      Load turned = *rhs_.back();
      own->enter(turned);
      rhs_.back() = std::make_shared<const Load>(std::move(turned));
    }
  }
}

// Of the primal form those with prescribed values, rising.
std::vector<int> SubdomainSystem::heldDofs(const Subdomain& s) const {
  return form_ == DirichletForm::Primal && !s.fixed.empty() ? fixedDofs(s) : std::vector<int>();
}

void SubdomainSystem::build(Known known) {
  matrices_.clear();
  kernels_.clear();
  diagonals_.clear();
  using Dofs = std::vector<int>;
  Shared<std::pair<const LocalMatrix*, Dofs>, LocalMatrix> matrices(std::move(known.matrices));
  Shared<std::pair<const Kernel*, Dofs>, Kernel> kernels(std::move(known.kernels));
  Shared<const LocalMatrix*, std::vector<double>> diagonals;
  std::set<std::pair<const LocalMatrix*, const Kernel*>> verified;
  for (const Subdomain& s : subdomains_) {
    if (verified.insert({s.stiffness.get(), s.motions.get()}).second) {
      const double defect = kernelDefect(*s.stiffness, *s.motions);
      if (!(defect <= kernelTolerance))
        throw NumericalError("the kernel given for " + name(s) + " is not a kernel: ‖KR‖/(‖K‖‖R‖) = " +
                                 scientific(defect) + ", at most " + scientific(kernelTolerance, 0) +
                                 " was expected; check its coordinates and for constraints other than its "
                                 "Dirichlet conditions",
                             {{"subdomain", std::to_string(s.number)}, {"defect", scientific(defect)}});
    }
    const Dofs fixed = heldDofs(s);
    kernels_.push_back(kernels.get({s.motions.get(), fixed}, [&] { return heldKernel(*s.motions, fixed); }));
    if (!fixed.empty()) {
      matrices_.push_back(matrices.get({s.stiffness.get(), fixed},
                                       [&] { return matrixWithTrivialEquations(*s.stiffness, fixed); }));
    } else {
      matrices_.push_back(s.stiffness);
    }
    diagonals_.push_back(diagonals.get(matrices_.back().get(), [&] { return matrices_.back()->diagonal(); }));
  }
  updateRhs();
}

void SubdomainSystem::setFrames(std::vector<std::optional<Frame>> frames) {
  agree(*comm_, [&] {
    if (!frames.empty() && frames.size() != subdomains_.size())
      throw InputError("frames must cover each subdomain of the rank: " + std::to_string(subdomains_.size()) +
                       ", not " + std::to_string(frames.size()));
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (frames[i] && (!heldDofs(subdomains_[i]).empty() ||
                        subdomains_[i].stiffness->rows() % frames[i]->components() != 0))
        throw InputError(
            name(subdomains_[i]) +
                ": a frame needs a matrix without prescribed values, with as many rows a node as "
                "it has components",
            dataOf(subdomains_[i]));
  });
  frames_ = std::move(frames);
  updateRhs();
}

void SubdomainSystem::leaveFrames(TornVector& u) const {
  for (int i = 0; i < size(); ++i)
    if (const Frame* own = frame(i))
      own->leave(u[static_cast<std::size_t>(i)]);
}

void SubdomainSystem::enterFrames(TornVector& u) const {
  for (int i = 0; i < size(); ++i)
    if (const Frame* own = frame(i))
      own->enter(u[static_cast<std::size_t>(i)]);
}

TornVector SubdomainSystem::zeroVector() const {
  TornVector result;
  for (int i = 0; i < size(); ++i)
    result.emplace_back(static_cast<std::size_t>(matrix(i).rows()), 0.0);
  return result;
}

} // namespace Harmos::feti
