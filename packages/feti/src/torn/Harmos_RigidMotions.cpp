// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RigidMotions.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GlobalOrder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Harmos::feti {

RigidMotions::RigidMotions(const SubdomainSystem& system)
    : system_(&system), dimension_(system.kernelDimension()), totalParts_(system.globalSubdomains()) {
  for (int i = 0; i < system.size(); ++i) {
    for (int k = 0; k < system.kernel(i).columns; ++k)
      ownColumns_.push_back(system.kernelOffset(i) + k);
    places_.push_back(ownColumns_.size());
  }
  countAmplitudes();
}

RigidMotions::RigidMotions(const SubdomainSystem& system, std::vector<Part> parts, std::vector<int> bases)
    : system_(&system), parts_(std::move(parts)), bases_(std::move(bases)) {
  const Teuchos::Comm<int>& comm = *system.comm();
  // By their first subdomains.
  std::vector<std::size_t> order(parts_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto numberOf = [&](std::size_t p) { return system.subdomain(parts_[p].members.front()).number; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return numberOf(a) < numberOf(b); });
  std::vector<OrderKey> keys;
  std::vector<long long> counts;
  for (std::size_t p : order) {
    keys.push_back({numberOf(p), 0});
    counts.push_back(parts_[p].columns);
  }
  const std::vector<long long> firsts = sumsBefore(comm, keys, counts);
  std::vector<long long> offsets(parts_.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    offsets[order[k]] = firsts[k];
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    for (int k = 0; k < parts_[p].columns; ++k)
      ownColumns_.push_back(static_cast<int>(offsets[p]) + k);
    places_.push_back(ownColumns_.size());
  }
  totalParts_ = globalSum(comm, static_cast<long long>(parts_.size()));
  dimension_ = static_cast<int>(globalSum(comm, static_cast<long long>(ownColumns_.size())));
  countAmplitudes();
}

void RigidMotions::countAmplitudes() {
  for (int i = 0; i < system_->size(); ++i)
    amplitudePlaces_.push_back(amplitudePlaces_.back() + static_cast<std::size_t>(kernel(i).columns));
}

std::vector<int> RigidMotions::members(int part) const {
  return areOfSubdomains() ? std::vector<int>{part} : parts_[static_cast<std::size_t>(part)].members;
}

std::vector<double> RigidMotions::ofPart(int part, std::size_t member, const double* s, bool absolute) const {
  if (areOfSubdomains())
    return {s, s + kernel(part).columns};
  const Part& item = parts_[static_cast<std::size_t>(part)];
  const std::vector<double>& t = item.coefficients[member];
  const auto rows = static_cast<std::size_t>(kernel(item.members[member]).columns);
  std::vector<double> result(static_cast<std::size_t>(item.columns), 0.0);
  for (std::size_t c = 0; c < result.size(); ++c)
    for (std::size_t k = 0; k < rows; ++k)
      result[c] += s[k] * (absolute ? std::abs(t[c * rows + k]) : t[c * rows + k]);
  return result;
}

std::vector<double> RigidMotions::amplitudes(const std::vector<double>& motions) const {
  if (areOfSubdomains())
    return motions;
  std::vector<double> result(amplitudePlaces_.back(), 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p)
    for (std::size_t m = 0; m < parts_[p].members.size(); ++m) {
      const int i = parts_[p].members[m];
      const auto rows = static_cast<std::size_t>(kernel(i).columns);
      double* mine = result.data() + amplitudePlaces_[static_cast<std::size_t>(i)];
      for (std::size_t c = 0; c < static_cast<std::size_t>(parts_[p].columns); ++c)
        for (std::size_t k = 0; k < rows; ++k)
          mine[k] += parts_[p].coefficients[m][c * rows + k] * motions[places_[p] + c];
    }
  return result;
}

std::vector<double> RigidMotions::motions(const std::vector<double>& amplitudes, bool absolute) const {
  HARMOS_REQUIRE(amplitudes.size() == amplitudePlaces_.back(), "amplitudes are those of all subdomains");
  if (areOfSubdomains())
    return amplitudes;
  std::vector<double> result(ownColumns_.size(), 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p)
    for (std::size_t m = 0; m < parts_[p].members.size(); ++m) {
      const auto i = static_cast<std::size_t>(parts_[p].members[m]);
      const std::vector<double> share =
          ofPart(static_cast<int>(p), m, amplitudes.data() + amplitudePlaces_[i], absolute);
      for (std::size_t c = 0; c < share.size(); ++c)
        result[places_[p] + c] += share[c];
    }
  return result;
}

} // namespace Harmos::feti
