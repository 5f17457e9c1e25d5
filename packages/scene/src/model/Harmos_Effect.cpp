// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Effect.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <mutex>

namespace Harmos::scene {
namespace {

struct Counts {
  std::mutex guard;
  std::map<std::string, Effect::Count> ofKind;
};

Counts& counts() {
  static Counts all;
  return all;
}

} // namespace

Effect::Effect(std::string kind, std::string name) : kind_(std::move(kind)), name_(std::move(name)) {
  const std::lock_guard<std::mutex> lock(counts().guard);
  Count& mine = counts().ofKind[kind_];
  ++mine.living;
  ++mine.made;
}

Effect::~Effect() {
  const std::lock_guard<std::mutex> lock(counts().guard);
  --counts().ofKind[kind_].living;
}

Effect::Count Effect::count(const std::string& kind) {
  const std::lock_guard<std::mutex> lock(counts().guard);
  const auto found = counts().ofKind.find(kind);
  return found == counts().ofKind.end() ? Count() : found->second;
}

std::string Effect::label() const {
  std::string kind = kind_;
  if (!kind.empty())
    kind[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(kind[0])));
  if (!name_.empty())
    return kind + " \"" + name_ + "\"";
  const bool isVowel = !kind.empty() && std::string("aeiou").find(kind[0]) != std::string::npos;
  return (isVowel ? "an " : "a ") + kind;
}

void Effect::addTo(std::vector<double>& sum, const std::vector<double>& more) {
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] += more[k];
}

} // namespace Harmos::scene
