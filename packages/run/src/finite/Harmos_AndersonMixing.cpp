// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AndersonMixing.hpp"

#include "Harmos_Exchange.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>

namespace Harmos::run {
namespace {

// a − b.
feti::TornVector difference(const feti::TornVector& a, const feti::TornVector& b) {
  feti::TornVector result = a;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      result[i][k] -= b[i][k];
  return result;
}

} // namespace

// Of this rank.
double AndersonMixing::product(const feti::TornVector& a, const feti::TornVector& b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      sum += weights_[i][k] * a[i][k] * b[i][k];
  return sum;
}

// min ‖f_n − Σγ_j(f_n − f_j)‖: a least squares problem of a few unknowns by its normal equations, scaled to a
// diagonal of one. What is added to that keeps combinations of changes that hardly differ small.
feti::TornVector AndersonMixing::next(const feti::TornVector& answer, const feti::TornVector& change) {
  std::vector<feti::TornVector> changes, answers;
  for (const Entry& entry : entries_) {
    changes.push_back(difference(change, entry.change));
    answers.push_back(difference(answer, entry.answer));
  }
  const std::size_t m = changes.size();
  std::vector<double> sums;
  for (std::size_t a = 0; a < m; ++a) {
    for (std::size_t b = 0; b < m; ++b)
      sums.push_back(product(changes[a], changes[b]));
    sums.push_back(product(changes[a], change));
  }
  globalSum(comm_, sums);
  std::vector<double> gram(m * m), gamma(m), scale(m);
  const auto at = [&](std::size_t a, std::size_t b) { return sums[a * (m + 1) + b]; };
  constexpr double regularisation = 1e-10;
  for (std::size_t a = 0; a < m; ++a)
    scale[a] = at(a, a) > 0.0 ? 1.0 / std::sqrt(at(a, a)) : 0.0;
  for (std::size_t a = 0; a < m; ++a) {
    for (std::size_t b = 0; b < m; ++b)
      gram[a * m + b] = scale[a] * at(a, b) * scale[b] + (a == b ? regularisation : 0.0);
    gamma[a] = scale[a] * at(a, m);
  }
  int info = 0;
  if (m > 0)
    Teuchos::LAPACK<int, double>().POSV('L', static_cast<int>(m), 1, gram.data(), static_cast<int>(m),
                                        gamma.data(), static_cast<int>(m), &info);
  feti::TornVector result = answer;
  for (std::size_t j = 0; j < m && info == 0; ++j)
    for (std::size_t i = 0; i < result.size(); ++i)
      for (std::size_t k = 0; k < result[i].size(); ++k)
        result[i][k] -= gamma[j] * scale[j] * answers[j][i][k];
  entries_.push_back({answer, change});
  if (entries_.size() > memory)
    entries_.pop_front();
  return result;
}

} // namespace Harmos::run
