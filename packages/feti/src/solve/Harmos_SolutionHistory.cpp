// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SolutionHistory.hpp"

#include "Harmos_Exchange.hpp"

#include <Teuchos_LAPACK.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace Harmos::feti {
namespace {

double dot(const MultiVector& x, const MultiVector& y) {
  std::vector<double> result(1);
  x.dot(y, Teuchos::arrayViewFromVector(result));
  return result[0];
}

Teuchos::RCP<const MultiVector> copyOf(const MultiVector& x) {
  return Teuchos::rcp(new MultiVector(x, Teuchos::Copy));
}

// Whether both are zero at the same places.
bool haveSameZeros(const MultiVector& x, const MultiVector& y) {
  const auto a = x.getLocalViewHost(Tpetra::Access::ReadOnly),
             b = y.getLocalViewHost(Tpetra::Access::ReadOnly);
  long long different = 0;
  for (std::size_t k = 0; k < a.extent(0); ++k)
    different += (a(k, 0) == 0.0) != (b(k, 0) == 0.0) ? 1 : 0;
  return globalSum(*x.getMap()->getComm(), different) == 0;
}

void exchangeVector(qp::StateArchive<MultiVector>& archive, const DualProblem& problem,
                    const std::string& name, Teuchos::RCP<const MultiVector>& vector) {
  const auto copy = Teuchos::rcp(new MultiVector(problem.d().getMap(), 1));
  if (!archive.isReading())
    Tpetra::deep_copy(*copy, *vector);
  archive.vector(name, *copy);
  vector = copy;
}

} // namespace

void exchange(qp::StateArchive<MultiVector>& archive, const DualProblem& problem, const std::string& name,
              WarmStart& start) {
  bool isThere = !start.multiplier.is_null();
  archive.number(name + " is there", isThere);
  if (!isThere)
    return;
  exchangeVector(archive, problem, name + ", multiplier", start.multiplier);
  if (problem.equalityRows().is_null())
    return;
  MultiVector mu(problem.equalityRows()->getRangeMap(), 1);
  if (!archive.isReading())
    std::copy(start.mu.begin(), start.mu.end(), mu.getLocalViewHost(Tpetra::Access::OverwriteAll).data());
  archive.rowVector(name + ", mu", mu);
  const auto view = mu.getLocalViewHost(Tpetra::Access::ReadOnly);
  start.mu.assign(view.data(), view.data() + view.extent(0));
}

void SolutionHistory::add(const DualProblem& problem, const Teuchos::RCP<const MultiVector>& multiplier,
                          const std::vector<double>& mu) {
  if (!entries_.empty() && !haveSameZeros(*entries_.back().multiplier, *multiplier))
    entries_.erase(entries_.begin(), std::prev(entries_.end()));
  entries_.push_back({copyOf(problem.d()), copyOf(*problem.shift()), multiplier, mu});
  if (entries_.size() > most)
    entries_.pop_front();
}

void SolutionHistory::exchange(qp::StateArchive<MultiVector>& archive, const DualProblem& problem,
                               const std::string& prefix) {
  std::size_t count = entries_.size();
  archive.number(prefix + "solutions", count);
  if (archive.isReading())
    entries_.assign(count, {});
  for (std::size_t k = 0; k < count; ++k) {
    Entry& entry = entries_[k];
    const std::string name = prefix + "solution " + std::to_string(k);
    exchangeVector(archive, problem, name + ", d", entry.d);
    exchangeVector(archive, problem, name + ", shift", entry.shift);
    WarmStart solution = {entry.multiplier, entry.mu};
    feti::exchange(archive, problem, name, solution);
    entry.multiplier = solution.multiplier;
    entry.mu = solution.mu;
  }
}

std::optional<WarmStart> SolutionHistory::start(const DualProblem& problem, double tolerance) const {
  if (entries_.empty())
    return std::nullopt;
  const auto n = static_cast<int>(entries_.size());
  const auto size = entries_.size();
  // d and λ̃ have units of their own.
  const double d2 = dot(problem.d(), problem.d()), shift2 = dot(*problem.shift(), *problem.shift());
  const double weight = shift2 > 0.0 ? d2 / shift2 : 0.0;
  const auto product = [&](const MultiVector& d, const MultiVector& shift, const Entry& entry) {
    return dot(d, *entry.d) + weight * dot(shift, *entry.shift);
  };
  std::vector<double> gram(size * size), coefficients(size);
  double trace = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j)
      gram[j * size + i] = gram[i * size + j] = product(*entries_[i].d, *entries_[i].shift, entries_[j]);
    coefficients[i] = product(problem.d(), *problem.shift(), entries_[i]);
    trace += gram[i * size + i];
  }
  for (std::size_t i = 0; i < size; ++i)
    gram[i * size + i] += tolerance * tolerance * trace;
  int info = 0;
  Teuchos::LAPACK<int, double>().POSV('L', n, 1, gram.data(), n, coefficients.data(), n, &info);
  if (info != 0) // data of zeros: the last solution as it is
    coefficients.assign(size, 0.0), coefficients.back() = 1.0;
  const auto multiplier = Teuchos::rcp(new MultiVector(entries_.back().multiplier->getMap(), 1));
  std::vector<double> mu(entries_.back().mu.size(), 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    multiplier->update(coefficients[i], *entries_[i].multiplier, 1.0);
    for (std::size_t k = 0; k < mu.size(); ++k)
      mu[k] += coefficients[i] * entries_[i].mu[k];
  }
  return WarmStart{multiplier, mu};
}

} // namespace Harmos::feti
