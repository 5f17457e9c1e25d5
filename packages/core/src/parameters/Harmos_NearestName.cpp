// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NearestName.hpp"

#include <algorithm>
#include <cctype>

namespace Harmos {
namespace {

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

} // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  // Further away than half of its letters, a name is no longer a misspelling.
  std::size_t best = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = editDistance(lowered(name), lowered(candidate));
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  // Or its beginning: "Tol" for "Tolerance".
  if (nearest.empty() && name.size() >= 3)
    for (const std::string& candidate : candidates)
      if (lowered(candidate).compare(0, name.size(), lowered(name)) == 0)
        return candidate;
  return nearest;
}

std::string offer(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearestName(name, known);
  std::string text = nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?";
  std::string list;
  for (const std::string& other : known)
    list += (list.empty() ? "\"" : ", \"") + other + "\"";
  return text + (list.empty() ? " (available: none)" : " (available: " + list + ")");
}

} // namespace Harmos
