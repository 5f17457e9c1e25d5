// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace Harmos {

/// The rank at which all that is known of a key, and all who ask for it, meet. Keys in arithmetic
/// progression, as numbers of the nodes of a surface often are, go to all ranks alike (the mixer of Steele,
/// Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014).
inline std::size_t homeOf(long long key, const Teuchos::Comm<int>& comm) {
  auto bits = static_cast<std::uint64_t>(key);
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
  bits ^= bits >> 31;
  return static_cast<std::size_t>(bits % static_cast<std::uint64_t>(comm.getSize()));
}

/// What ranks know of keys, for those who ask: the value of each key asked for, in the order of the
/// questions; none where nobody knows it. Both meet at homeOf() the key: a rank needs memory for what it
/// knows and asks, and for a share of all.
/// @param known pairs of key, ≥ 0, and value; a key may be known several times. @param merge (present, next)
/// makes one value of two of a key; the answer depends on it alone if it does not matter in which order.
/// @note Collective, three exchanges.
/// Guarded by tests/unit/core/test_rendezvous.cpp.
template<class Value, class Merge>
std::vector<std::optional<Value>> lookUpMerged(const Teuchos::Comm<int>& comm,
                                               const std::vector<std::pair<long long, Value>>& known,
                                               const std::vector<long long>& asked, Merge merge) {
  struct Known {
    long long key;
    Value value;
  };
  struct Answer {
    Value value;
    bool isKnown;
  };
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<Known>> offers(ranks);
  std::vector<std::vector<long long>> questions(ranks);
  agree(comm, [&] {
    for (const auto& [key, value] : known)
      offers[homeOf(key, comm)].push_back({key, value});
    for (const long long key : asked)
      questions[homeOf(key, comm)].push_back(key);
  });
  offers = exchangeItems(comm, offers);
  questions = exchangeItems(comm, questions);
  std::vector<std::vector<Answer>> answers(ranks);
  agree(comm, [&] {
    std::unordered_map<long long, Value> values;
    for (const std::vector<Known>& part : offers)
      for (const Known& item : part) {
        const auto [place, isNew] = values.emplace(item.key, item.value);
        if (!isNew)
          merge(place->second, item.value);
      }
    for (std::size_t r = 0; r < ranks; ++r)
      for (const long long key : questions[r]) {
        const auto found = values.find(key);
        answers[r].push_back(found == values.end() ? Answer{Value{}, false} : Answer{found->second, true});
      }
  });
  answers = exchangeItems(comm, answers);
  std::vector<std::optional<Value>> result;
  std::vector<std::size_t> next(ranks, 0);
  for (const long long key : asked) {
    const std::size_t home = homeOf(key, comm);
    const Answer& answer = answers[home][next[home]++];
    result.push_back(answer.isKnown ? std::optional<Value>(answer.value) : std::nullopt);
  }
  return result;
}

/// The same, with one of the values of a key. @param replaces (next, present) whether a value takes the place
/// of another one.
template<class Value, class Replaces>
std::vector<std::optional<Value>> lookUp(const Teuchos::Comm<int>& comm,
                                         const std::vector<std::pair<long long, Value>>& known,
                                         const std::vector<long long>& asked, Replaces replaces) {
  return lookUpMerged(comm, known, asked, [&](Value& present, const Value& next) {
    if (replaces(next, present))
      present = next;
  });
}

/// The same of keys that are known once, or always with the same value.
template<class Value>
std::vector<std::optional<Value>> lookUp(const Teuchos::Comm<int>& comm,
                                         const std::vector<std::pair<long long, Value>>& known,
                                         const std::vector<long long>& asked) {
  return lookUp(comm, known, asked, [](const Value&, const Value&) { return false; });
}

} // namespace Harmos
