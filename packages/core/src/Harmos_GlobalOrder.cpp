// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GlobalOrder.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <tuple>

namespace Harmos {
namespace {

struct Weighted {
  OrderKey key;
  long long weight;
};

// Where the shares of the ranks begin: all but the first.
std::vector<OrderKey> splitters(const Teuchos::Comm<int>& comm, const std::vector<OrderKey>& keys) {
  constexpr long long samplesOfShare = 8;
  const long long ranks = comm.getSize(), own = static_cast<long long>(keys.size());
  const long long all = globalSum(comm, own);
  const long long count = all > 0 ? (samplesOfShare * ranks * own + all - 1) / all : 0;
  std::vector<OrderKey> samples;
  for (long long k = 0; k < count; ++k)
    samples.push_back(keys[static_cast<std::size_t>(k * own / count)]);
  samples = gatherAll(comm, samples);
  std::sort(samples.begin(), samples.end());
  std::vector<OrderKey> result;
  for (long long r = 1; r < ranks && !samples.empty(); ++r)
    result.push_back(samples[static_cast<std::size_t>(r * static_cast<long long>(samples.size()) / ranks)]);
  return result;
}

} // namespace

std::vector<long long> sumsBefore(const Teuchos::Comm<int>& comm, const std::vector<OrderKey>& keys,
                                  const std::vector<long long>& weights) {
  const std::vector<OrderKey> cuts = splitters(comm, keys);
  std::vector<std::vector<Weighted>> parts(static_cast<std::size_t>(comm.getSize()));
  agree(comm, [&] {
    HARMOS_REQUIRE(keys.size() == weights.size() && std::is_sorted(keys.begin(), keys.end()),
                   "keys are rising, and have a weight each");
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto share = std::upper_bound(cuts.begin(), cuts.end(), keys[k]) - cuts.begin();
      parts[static_cast<std::size_t>(share)].push_back({keys[k], weights[k]});
    }
  });
  parts = exchangeItems(comm, parts);
  std::vector<std::vector<long long>> sums(parts.size());
  long long total = 0;
  agree(comm, [&] {
    std::vector<std::tuple<OrderKey, std::size_t, std::size_t>> order;
    for (std::size_t r = 0; r < parts.size(); ++r) {
      sums[r].resize(parts[r].size());
      for (std::size_t k = 0; k < parts[r].size(); ++k)
        order.emplace_back(parts[r][k].key, r, k);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [key, r, k] : order) {
      sums[r][k] = total;
      total += parts[r][k].weight;
    }
  });
  const long long before = exclusiveScan(comm, total);
  for (std::vector<long long>& part : sums)
    for (long long& sum : part)
      sum += before;
  std::vector<long long> result; // shares follow each other, and so do keys
  for (const std::vector<long long>& part : exchangeItems(comm, sums))
    result.insert(result.end(), part.begin(), part.end());
  return result;
}

} // namespace Harmos
