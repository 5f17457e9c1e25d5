// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressRecovery.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include "Harmos_StressSums.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace Harmos::run {
namespace {

struct NodalShare {
  long long node;
  fem::Voigt weighted;
  double size, state;
  std::array<int, 2> regions;
};

// Brings together what the copies of a node have, in place. Copies meet on the rank that their number names,
// and the sums go back. Collective.
void addCopies(const Teuchos::Comm<int>& comm, const std::vector<scene::OwnedSubdomain>& owned,
               std::vector<fem::StressSums>& sums) {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<NodalShare>> sends(ranks);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
      const long long number = owned[i].mesh.boundaryNumbers[k];
      const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
      sends[static_cast<std::size_t>(number) % ranks].push_back(
          {number, sums[i].weighted[node], sums[i].size[node],
           sums[i].states.empty() ? 0.0 : sums[i].states[node], sums[i].regions[node]});
    }
  std::vector<std::vector<NodalShare>> received = exchangeItems(comm, sends);
  std::map<long long, NodalShare> total;
  for (const std::vector<NodalShare>& part : received)
    for (const NodalShare& share : part) {
      const auto [place, isNew] = total.emplace(share.node, share);
      if (isNew)
        continue;
      NodalShare& sum = place->second;
      sum.size += share.size;
      sum.state += share.state;
      for (std::size_t r = 0; r < 6; ++r)
        sum.weighted[r] += share.weighted[r];
      sum.regions = {std::min(sum.regions[0], share.regions[0]), std::max(sum.regions[1], share.regions[1])};
    }
  for (std::vector<NodalShare>& part : received)
    for (NodalShare& share : part)
      share = total.at(share.node);
  const std::vector<std::vector<NodalShare>> answers = exchangeItems(comm, received);
  std::vector<std::size_t> next(ranks, 0); // answers come in the order of the questions
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
      const std::size_t r = static_cast<std::size_t>(owned[i].mesh.boundaryNumbers[k]) % ranks;
      const NodalShare& share = answers[r][next[r]++];
      const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
      sums[i].weighted[node] = share.weighted;
      sums[i].size[node] = share.size;
      if (!sums[i].states.empty())
        sums[i].states[node] = share.state;
      sums[i].regions[node] = share.regions;
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
                            const feti::TornVector& displacement, double time,
                            const MaterialStates& states = {}) {
  const std::vector<double> temperature = scene.temperatureRises(time);
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
                               scene.nodalRises(owned[i], time), states.empty() ? nullptr : &states[i]});
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
                                                      const feti::TornVector& displacement, double time,
                                                      std::vector<std::vector<double>>* cells) {
  const std::vector<Group> groups = groupsOf(scene, owned, displacement, time);
  const std::vector<fem::StressSums> means = nodalStresses(comm, scene, owned, groups);
  std::vector<double> squares(2, 0.0);
  if (cells != nullptr)
    cells->assign(owned.size(), {});
  agree(comm, [&] {
    for (const Group& group : groups) {
      std::vector<const fem::StressSums*> recovered;
      for (std::size_t i : group.members)
        recovered.push_back(&means[i]);
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
