// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_OuterSides.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Index.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

namespace Harmos::scene {
namespace {

// A side as all subdomains know it: the numbers of its corners, sorted; those it lacks are −1.
using SideKey = std::array<long long, 4>;

SideKey keyOf(const std::unordered_map<int, long long>& numbers, const fem::Mesh& mesh,
              const fem::Side& side) {
  const std::vector<int>& nodes = fem::shapeOf(mesh.cellType).sides[at(side.side)];
  SideKey key{-1, -1, -1, -1};
  for (std::size_t k = 0; k < at(fem::shapeOf(mesh.typeOf(side)).corners); ++k)
    key[k] = numbers.at(mesh.cell(side.cell)[nodes[k]]);
  std::sort(key.begin(), key.end());
  return key;
}

// Of sides that arrive from all ranks, whether nobody else has sent them.
std::vector<std::vector<char>> areAlone(const std::vector<std::vector<SideKey>>& received) {
  std::vector<SideKey> all;
  for (const std::vector<SideKey>& part : received)
    all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end());
  std::vector<std::vector<char>> answers;
  for (const std::vector<SideKey>& part : received) {
    answers.emplace_back();
    for (const SideKey& key : part) {
      const auto [begin, end] = std::equal_range(all.begin(), all.end(), key);
      answers.back().push_back(end - begin == 1 ? 1 : 0);
    }
  }
  return answers;
}

} // namespace

std::vector<std::vector<fem::Side>> outerSides(const Teuchos::Comm<int>& comm,
                                               const std::vector<OwnedSubdomain>& owned) {
  const auto ranks = at(comm.getSize());
  // Sides of subdomains that share a mesh are found once.
  std::map<const fem::Mesh*, std::vector<fem::Side>> ofMesh;
  std::vector<std::vector<SideKey>> sends(ranks);
  const auto home = [&](const SideKey& key) { return at(key.back()) % ranks; };
  std::vector<std::vector<SideKey>> keys(owned.size());
  agree(comm, [&] {
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const fem::PlacedMesh& placed = owned[i].mesh;
      const fem::Mesh& mesh = *placed.mesh;
      if (ofMesh.count(&mesh) == 0)
        ofMesh[&mesh] = fem::boundarySides(mesh);
      std::unordered_map<int, long long> numbers;
      for (std::size_t k = 0; k < mesh.boundary.size(); ++k)
        numbers[mesh.boundary[k]] = placed.boundaryNumbers[k];
      for (const fem::Side& side : ofMesh[&mesh]) {
        keys[i].push_back(keyOf(numbers, mesh, side));
        sends[home(keys[i].back())].push_back(keys[i].back());
      }
    }
  });
  const std::vector<std::vector<SideKey>> received = exchangeItems(comm, sends);
  std::vector<std::vector<char>> answers;
  agree(comm, [&] { answers = areAlone(received); });
  answers = exchangeItems(comm, answers);
  std::vector<std::vector<fem::Side>> outer(owned.size());
  agree(comm, [&] {
    std::vector<std::size_t> next(ranks, 0); // answers come in the order of the questions
    for (std::size_t i = 0; i < owned.size(); ++i)
      for (std::size_t k = 0; k < keys[i].size(); ++k) {
        const std::size_t rank = home(keys[i][k]);
        if (answers[rank][next[rank]++] != 0)
          outer[i].push_back(ofMesh.at(owned[i].mesh.mesh.get())[k]);
      }
  });
  return outer;
}

} // namespace Harmos::scene
