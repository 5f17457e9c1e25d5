// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>

namespace Harmos::contact {
namespace {

// All of a point but its terms, which follow.
struct Head {
  long long node, number, terms, pressures, beside;
  int side;
  fem::Point position, normal;
  double gap, interference, area;
};

} // namespace

std::vector<std::vector<ContactPoint>> exchangePoints(const Teuchos::Comm<int>& comm,
                                                      const std::vector<std::vector<ContactPoint>>& sends) {
  std::vector<std::vector<Head>> heads(sends.size());
  std::vector<std::vector<ContactPoint::Term>> terms(sends.size()), beside(sends.size());
  std::vector<std::vector<ContactPoint::PressureTerm>> pressures(sends.size());
  for (std::size_t r = 0; r < sends.size(); ++r)
    for (const ContactPoint& point : sends[r]) {
      heads[r].push_back({point.node, point.number, static_cast<long long>(point.terms.size()),
                          static_cast<long long>(point.pressure.size()),
                          static_cast<long long>(point.beside.size()), point.side, point.position,
                          point.normal, point.gap, point.interference, point.area});
      terms[r].insert(terms[r].end(), point.terms.begin(), point.terms.end());
      pressures[r].insert(pressures[r].end(), point.pressure.begin(), point.pressure.end());
      beside[r].insert(beside[r].end(), point.beside.begin(), point.beside.end());
    }
  heads = exchangeItems(comm, heads);
  terms = exchangeItems(comm, terms);
  pressures = exchangeItems(comm, pressures);
  beside = exchangeItems(comm, beside);
  std::vector<std::vector<ContactPoint>> received(heads.size());
  for (std::size_t r = 0; r < heads.size(); ++r) {
    auto next = terms[r].begin();
    auto nextPressure = pressures[r].begin();
    auto nextBeside = beside[r].begin();
    for (const Head& head : heads[r]) {
      ContactPoint& point = received[r].emplace_back();
      point.node = head.node;
      point.number = head.number;
      point.position = head.position;
      point.normal = head.normal;
      point.gap = head.gap;
      point.interference = head.interference;
      point.area = head.area;
      point.terms.assign(next, next + head.terms);
      next += head.terms;
      point.side = head.side;
      point.pressure.assign(nextPressure, nextPressure + head.pressures);
      nextPressure += head.pressures;
      point.beside.assign(nextBeside, nextBeside + head.beside);
      nextBeside += head.beside;
    }
  }
  return received;
}

std::vector<ContactPoint> gatherPoints(const Teuchos::Comm<int>& comm,
                                       const std::vector<ContactPoint>& points) {
  std::vector<ContactPoint> all;
  for (const std::vector<ContactPoint>& part : exchangePoints(
           comm, std::vector<std::vector<ContactPoint>>(static_cast<std::size_t>(comm.getSize()), points)))
    all.insert(all.end(), part.begin(), part.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const ContactPoint& a, const ContactPoint& b) { return a.number < b.number; });
  return all;
}

} // namespace Harmos::contact
