// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressRecovery.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include "Harmos_StressPatches.hpp"
#include "Harmos_StressSums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace Harmos::run {
namespace {

struct NodalShare {
  long long node;
  fem::Voigt weighted;
  double size, state;
};

// Sums of a patch of so many functions.
template<std::size_t Functions>
struct PatchShare {
  long long node;
  int region;
  std::array<double, Functions * Functions> gram;
  std::array<double, Functions * 6> moments;
};

// Copies meet on the rank that their number names, and the sums of those with equal keys go back, to each
// rank in the order of what it sent. Collective.
template<class Share, class KeyOf, class Add>
std::vector<std::vector<Share>> merged(const Teuchos::Comm<int>& comm,
                                       const std::vector<std::vector<Share>>& sends, KeyOf keyOf, Add add) {
  std::vector<std::vector<Share>> received = exchangeItems(comm, sends);
  std::map<decltype(keyOf(std::declval<Share>())), Share> total;
  for (const std::vector<Share>& part : received)
    for (const Share& share : part) {
      const auto [place, isNew] = total.emplace(keyOf(share), share);
      if (!isNew)
        add(place->second, share);
    }
  for (std::vector<Share>& part : received)
    for (Share& share : part)
      share = total.at(keyOf(share));
  return exchangeItems(comm, received);
}

// Visits copies of nodes: subdomain, node, and its number.
template<class Visit>
void visitCopies(const std::vector<scene::OwnedSubdomain>& owned, Visit visit) {
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k)
      visit(i, owned[i].mesh.mesh->boundary[k], owned[i].mesh.boundaryNumbers[k]);
}

// Brings together what the copies of a node have, in place. Collective.
void addCopies(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned,
               std::vector<fem::StressSums>& sums) {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<NodalShare>> sends(ranks);
  visitCopies(owned, [&](std::size_t i, int n, long long number) {
    const auto node = static_cast<std::size_t>(n);
    sends[static_cast<std::size_t>(number) % ranks].push_back(
        {number, sums[i].weighted[node], sums[i].size[node],
         sums[i].states.empty() ? 0.0 : sums[i].states[node]});
  });
  const auto answers = merged(
      comm, sends, [](const NodalShare& share) { return share.node; },
      [](NodalShare& sum, const NodalShare& share) {
        sum.size += share.size;
        sum.state += share.state;
        for (std::size_t r = 0; r < 6; ++r)
          sum.weighted[r] += share.weighted[r];
      });
  std::vector<std::size_t> next(ranks, 0); // answers come in the order of the questions
  visitCopies(owned, [&](std::size_t i, int n, long long number) {
    const std::size_t r = static_cast<std::size_t>(number) % ranks;
    const NodalShare& share = answers[r][next[r]++];
    const auto node = static_cast<std::size_t>(n);
    sums[i].weighted[node] = share.weighted;
    sums[i].size[node] = share.size;
    if (!sums[i].states.empty())
      sums[i].states[node] = share.state;
  });
}

// Likewise of patches with so many functions: those of equal nodes and regions. Collective.
template<std::size_t Functions>
void addCopies(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned,
               std::vector<fem::StressPatches>& patches) {
  using Share = PatchShare<Functions>;
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<Share>> sends(ranks);
  std::vector<std::vector<std::pair<double*, double*>>> sums(ranks);
  visitCopies(owned, [&](std::size_t i, int node, long long number) {
    fem::StressPatches& of = patches[i];
    if (of.functions != static_cast<int>(Functions))
      return;
    const std::size_t r = static_cast<std::size_t>(number) % ranks;
    const auto first = std::lower_bound(of.places.begin(), of.places.end(), node,
                                        [](const auto& place, int n) { return place.node < n; });
    for (auto place = first; place != of.places.end() && place->node == node; ++place) {
      const auto p = static_cast<std::size_t>(place - of.places.begin());
      double* gram = of.gram.data() + p * of.gramSize();
      double* moments = of.moments.data() + p * of.momentSize();
      Share& share = sends[r].emplace_back(Share{number, place->region, {}, {}});
      std::copy_n(gram, share.gram.size(), share.gram.begin());
      std::copy_n(moments, share.moments.size(), share.moments.begin());
      sums[r].emplace_back(gram, moments);
    }
  });
  const auto answers = merged(
      comm, sends, [](const Share& share) { return std::make_pair(share.node, share.region); },
      [](Share& sum, const Share& share) {
        for (std::size_t k = 0; k < sum.gram.size(); ++k)
          sum.gram[k] += share.gram[k];
        for (std::size_t k = 0; k < sum.moments.size(); ++k)
          sum.moments[k] += share.moments[k];
      });
  for (std::size_t r = 0; r < ranks; ++r)
    for (std::size_t k = 0; k < answers[r].size(); ++k) {
      std::copy(answers[r][k].gram.begin(), answers[r][k].gram.end(), sums[r][k].first);
      std::copy(answers[r][k].moments.begin(), answers[r][k].moments.end(), sums[r][k].second);
    }
}

// Subdomains of one body that share a mesh: gone through together.
struct Group {
  const scene::Body* body;
  const fem::Mesh* mesh;
  std::vector<std::size_t> members;
  std::vector<fem::NodalSolution> solutions;
};

std::vector<Group> groupsOf(const scene::Scene& scene, const std::vector<scene::OwnedSubdomain>& owned,
                            const feti::TornVector& displacement, std::optional<double> time,
                            const MaterialStates& states = {}) {
  const std::vector<double> temperature =
      time ? scene.temperatureRises(*time) : std::vector<double>(scene.bodies.size(), 0.0);
  std::map<std::pair<const fem::Mesh*, int>, std::size_t> places;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < owned.size(); ++i) {
    const fem::Mesh* mesh = owned[i].mesh.mesh.get();
    const auto [place, isNew] = places.emplace(std::make_pair(mesh, owned[i].body), groups.size());
    if (isNew)
      groups.push_back({&scene.bodies[static_cast<std::size_t>(owned[i].body)], mesh, {}, {}});
    Group& group = groups[place->second];
    group.members.push_back(i);
    group.solutions.push_back({&displacement[i], temperature[static_cast<std::size_t>(owned[i].body)],
                               time ? scene.nodalRises(owned[i], *time) : nullptr,
                               states.empty() ? nullptr : &states[i]});
  }
  return groups;
}

// Mean stresses at the nodes of each subdomain, over its copies' cells too. Collective.
std::vector<fem::StressSums> nodalStresses(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                                           const std::vector<scene::OwnedSubdomain>& owned,
                                           const std::vector<Group>& groups) {
  std::vector<fem::StressSums> sums(owned.size());
  agree(comm, [&] {
    for (const Group& group : groups) {
      std::vector<fem::StressSums> part =
          scene.physics == scene::Physics::Membrane
              ? fem::fluxSums(*group.mesh, group.solutions)
              : fem::stressSums(*group.mesh, scene::elasticityOf(scene, *group.body), group.solutions);
      for (std::size_t k = 0; k < part.size(); ++k)
        sums[group.members[k]] = std::move(part[k]);
    }
  });
  addCopies(comm, owned, sums);
  for (fem::StressSums& sum : sums)
    for (std::size_t node = 0; node < sum.weighted.size(); ++node) {
      for (double& entry : sum.weighted[node])
        entry /= sum.size[node];
      if (!sum.states.empty())
        sum.states[node] /= sum.size[node];
    }
  return sums;
}

} // namespace

RecoveredStress recoverStress(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                              const std::vector<scene::OwnedSubdomain>& owned,
                              const feti::TornVector& displacement, double time,
                              const MaterialStates& states) {
  RecoveredStress result;
  for (fem::StressSums& sum :
       nodalStresses(comm, scene, owned, groupsOf(scene, owned, displacement, time, states))) {
    if (scene.yields()) { // of bodies that do not it is zero
      sum.states.resize(sum.weighted.size(), 0.0);
      result.states.push_back(std::move(sum.states));
    }
    result.stress.push_back(std::move(sum.weighted));
  }
  return result;
}

std::vector<std::vector<fem::Voigt>> cellStresses(const scene::Scene& scene,
                                                  const std::vector<scene::OwnedSubdomain>& owned,
                                                  const feti::TornVector& displacement, double time,
                                                  const MaterialStates& states) {
  std::vector<std::vector<fem::Voigt>> result(owned.size());
  for (const Group& group : groupsOf(scene, owned, displacement, time, states)) {
    auto part = fem::cellStresses(*group.mesh, scene::elasticityOf(scene, *group.body), group.solutions);
    for (std::size_t k = 0; k < part.size(); ++k)
      result[group.members[k]] = std::move(part[k]);
  }
  return result;
}

feti::DiscretisationError estimateDiscretisationError(const Teuchos::Comm<int>& comm,
                                                      const scene::Scene& scene,
                                                      const std::vector<scene::OwnedSubdomain>& owned,
                                                      const feti::TornVector& displacement,
                                                      std::optional<double> time,
                                                      std::vector<std::vector<double>>* cells) {
  const std::vector<Group> groups = groupsOf(scene, owned, displacement, time);
  std::vector<fem::StressPatches> patches(owned.size());
  agree(comm, [&] {
    for (const Group& group : groups) {
      std::vector<fem::StressPatches> part =
          scene.physics == scene::Physics::Membrane
              ? fem::fluxPatches(*group.mesh, group.solutions)
              : fem::stressPatches(*group.mesh, scene::elasticityOf(scene, *group.body), group.solutions);
      for (std::size_t k = 0; k < part.size(); ++k)
        patches[group.members[k]] = std::move(part[k]);
    }
  });
  addCopies<1>(comm, owned, patches);
  addCopies<6>(comm, owned, patches);  // of the second order in the plane,
  addCopies<10>(comm, owned, patches); // and in space
  std::vector<double> squares(2, 0.0);
  if (cells != nullptr)
    cells->assign(owned.size(), {});
  agree(comm, [&] {
    for (const Group& group : groups) {
      std::vector<const fem::StressPatches*> recovered;
      for (std::size_t i : group.members)
        recovered.push_back(&patches[i]);
      fem::RecoveryError part = scene.physics == scene::Physics::Membrane
                                    ? fem::fluxRecoveryError(*group.mesh, group.solutions, recovered)
                                    : fem::recoveryError(*group.mesh, scene::elasticityOf(scene, *group.body),
                                                         group.solutions, recovered);
      squares[0] += part.error;
      squares[1] += part.energy;
      for (std::size_t k = 0; k < group.members.size() && cells != nullptr; ++k)
        (*cells)[group.members[k]] = std::move(part.cells[k]);
    }
  });
  globalSum(comm, squares);
  return {std::sqrt(squares[0]), std::sqrt(squares[1])};
}

} // namespace Harmos::run
