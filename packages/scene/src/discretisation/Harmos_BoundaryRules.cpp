// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundaryRules.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FacingSides.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_NearestName.hpp"
#include "Harmos_OuterSides.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <unordered_map>

namespace Harmos::scene {
namespace {

// What a rule has met on a body: sides it looked at, those that met each condition, those that met all.
constexpr std::size_t tallies = fem::BoundaryRule::conditions + 2;

class RuleWork {
 public:
  RuleWork(const Teuchos::Comm<int>& comm, const Scene& scene, std::vector<OwnedSubdomain>& owned)
      : comm_(comm),
        scene_(scene),
        owned_(owned),
        names_(gatherPartNames(comm, scene.bodies.size(), owned)),
        diagonals_(bodyDiagonals(comm, scene.bodies.size(), owned)),
        counts_(scene.boundaryRules.size() * scene.bodies.size() * tallies, 0.0) {}

  void go() {
    requireNames();
    outer_ = outerSides(comm_, owned_);
    for (const fem::BoundaryRule& rule : scene_.boundaryRules)
      if (rule.facing && faced_.count(rule.facing->distance) == 0)
        faced_[rule.facing->distance] =
            facedBodies(comm_, scene_.bodies.size(), owned_, outer_, rule.facing->distance);
    agree(comm_, [&] {
      for (std::size_t r = 0; r < scene_.boundaryRules.size(); ++r)
        for (std::size_t i = 0; i < owned_.size(); ++i)
          chooseSides(r, i);
    });
    globalSum(comm_, counts_);
    requireSides();
    nameNodes();
  }

 private:
  const std::string& bodyName(std::size_t body) const { return scene_.bodies[body].name; }
  double* countsOf(std::size_t rule, std::size_t body) {
    return &counts_[(rule * scene_.bodies.size() + body) * tallies];
  }
  static std::string pathOf(const fem::BoundaryRule& rule) { return "Boundary parts/" + rule.name; }

  // Every rank has the same names and meets the same errors.
  void requireNames() const {
    std::vector<std::set<std::string>> known = names_.withSides;
    for (const fem::BoundaryRule& rule : scene_.boundaryRules) {
      const std::string path = pathOf(rule);
      std::set<std::string> candidates;
      for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
        if (!rule.isOn(bodyName(b)))
          continue;
        if (names_.all[b].count(rule.name) > 0)
          throw InputError("\"" + path + "\": body \"" + bodyName(b) +
                               "\" has a part of this name in its mesh; use another name or restrict the "
                               "rule to other bodies by \"Bodies\"",
                           {{"path", path}});
        candidates.insert(known[b].begin(), known[b].end());
      }
      for (const std::string& part : rule.of)
        if (candidates.count(part) == 0)
          throw InputError("\"" + path + "/Of\" names the boundary part \"" + part +
                               "\", which does not exist or has no sides; name parts without their body" +
                               offer(part, {candidates.begin(), candidates.end()}),
                           {{"path", path + "/Of"}});
      for (std::size_t b = 0; b < scene_.bodies.size(); ++b)
        if (rule.isOn(bodyName(b)))
          known[b].insert(rule.name);
    }
  }

  // Whether a side of a subdomain faces one of a rule's bodies.
  bool faces(const fem::BoundaryRule& rule, std::size_t i, const fem::Side& side) const {
    if (!rule.facing)
      return false;
    const std::vector<fem::Side>& outer = outer_[i];
    const auto found = std::lower_bound(outer.begin(), outer.end(), side, isBefore);
    if (found == outer.end() || isBefore(side, *found))
      return false; // inside the body
    const std::vector<int>& bodies = faced_.at(rule.facing->distance)[i][at(found - outer.begin())];
    return std::any_of(bodies.begin(), bodies.end(), [&](int body) {
      const std::vector<std::string>& named = rule.facing->bodies;
      return std::find(named.begin(), named.end(), bodyName(at(body))) != named.end();
    });
  }

  void chooseSides(std::size_t r, std::size_t i) {
    const fem::BoundaryRule& rule = scene_.boundaryRules[r];
    OwnedSubdomain& item = owned_[i];
    const auto body = at(item.body);
    if (!rule.isOn(bodyName(body)))
      return;
    std::vector<fem::Side> chosen;
    double* counts = countsOf(r, body);
    for (const fem::Side& side : rule.of.empty() ? outer_[i] : sidesOf(item.mesh, rule.of)) {
      const fem::BoundaryRule::Verdict verdict = rule.judge(
          fem::geometryOf(item.mesh, side), rule.tolerance * diagonals_[body], faces(rule, i, side));
      counts[0] += 1.0;
      for (std::size_t c = 0; c < verdict.size(); ++c)
        counts[1 + c] += verdict[c] ? 1.0 : 0.0;
      if (std::find(verdict.begin(), verdict.end(), false) == verdict.end())
        chosen.push_back(side);
    }
    counts[tallies - 1] += static_cast<double>(chosen.size());
    if (!chosen.empty())
      item.mesh.sides[rule.name] = chosen;
  }

  static bool isBefore(const fem::Side& a, const fem::Side& b) {
    return std::tie(a.cell, a.side) < std::tie(b.cell, b.side);
  }

  static std::vector<fem::Side> sidesOf(const fem::PlacedMesh& mesh, const std::vector<std::string>& parts) {
    std::set<fem::Side, decltype(&isBefore)> all(&isBefore);
    for (const std::string& part : parts)
      if (const auto found = mesh.sides.find(part); found != mesh.sides.end())
        all.insert(found->second.begin(), found->second.end());
    return {all.begin(), all.end()};
  }

  // Sums over all ranks: the same everywhere.
  void requireSides() {
    for (std::size_t r = 0; r < scene_.boundaryRules.size(); ++r) {
      const fem::BoundaryRule& rule = scene_.boundaryRules[r];
      double chosen = 0.0;
      for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
        const double own = countsOf(r, b)[tallies - 1];
        chosen += own;
        if (!rule.bodies.empty() && rule.isOn(bodyName(b)) && own == 0.0)
          throw nothingChosen(r, b, b + 1);
      }
      if (chosen == 0.0)
        throw nothingChosen(r, 0, scene_.bodies.size());
    }
  }

  InputError nothingChosen(std::size_t r, std::size_t begin, std::size_t end) {
    const fem::BoundaryRule& rule = scene_.boundaryRules[r];
    std::array<double, tallies> counts{};
    for (std::size_t b = begin; b < end; ++b)
      for (std::size_t c = 0; c < tallies; ++c)
        counts[c] += countsOf(r, b)[c];
    std::ostringstream text;
    text << '"' << pathOf(rule) << "\" selects no side of "
         << (end == begin + 1 ? "body \"" + bodyName(begin) + "\"" : "any body") << ": of "
         << static_cast<long long>(counts[0]) << (rule.of.empty() ? " on its boundary" : " of its parts");
    std::string list;
    int given = 0;
    for (std::size_t c = 0; c < fem::BoundaryRule::conditions; ++c)
      if (const std::string words = rule.words()[c]; !words.empty()) {
        ++given;
        list += (list.empty() ? " " : ", ") + std::to_string(static_cast<long long>(counts[1 + c])) +
                " are " + words;
      }
    text << list << (given > 1 ? ", none meets all conditions" : "") << "; list the boundary with --parts"
         << (rule.box || rule.plane || rule.cylinder ? ", or widen its \"Tolerance\"" : "");
    return InputError(text.str(), {{"path", pathOf(rule)}});
  }

  // A node of a part, by its number, on its way to those who have copies.
  struct Member {
    long long number;
    std::size_t rule;
    bool operator<(const Member& other) const {
      return std::tie(number, rule) < std::tie(other.number, other.rule);
    }
    bool operator==(const Member& other) const { return number == other.number && rule == other.rule; }
  };

  void nameNodes() {
    const auto ranks = at(comm_.getSize());
    const auto home = [&](long long number) { return at(number) % ranks; };
    std::vector<std::vector<Member>> members(ranks);
    std::vector<std::vector<long long>> asked(ranks);
    std::vector<std::unordered_map<long long, int>> nodes; // of each subdomain, by number
    agree(comm_, [&] {
      for (const OwnedSubdomain& item : owned_) {
        const fem::Mesh& mesh = *item.mesh.mesh;
        for (std::size_t r = 0; r < scene_.boundaryRules.size(); ++r)
          if (const auto sides = item.mesh.sides.find(scene_.boundaryRules[r].name);
              sides != item.mesh.sides.end() && scene_.boundaryRules[r].isOn(bodyName(at(item.body))))
            for (int node : fem::nodesOf(mesh, sides->second)) {
              const long long number = item.mesh.number(node);
              members[home(number)].push_back({number, r});
            }
        nodes.emplace_back();
        for (std::size_t k = 0; k < mesh.boundary.size(); ++k) {
          nodes.back()[item.mesh.boundaryNumbers[k]] = mesh.boundary[k];
          asked[home(item.mesh.boundaryNumbers[k])].push_back(item.mesh.boundaryNumbers[k]);
        }
      }
      for (std::vector<long long>& numbers : asked)
        makeSet(numbers);
    });
    members = exchangeItems(comm_, members);
    asked = exchangeItems(comm_, asked);
    std::vector<std::vector<Member>> answers(ranks);
    agree(comm_, [&] {
      std::vector<Member> all;
      for (const std::vector<Member>& part : members)
        all.insert(all.end(), part.begin(), part.end());
      makeSet(all);
      for (std::size_t rank = 0; rank < ranks; ++rank)
        for (long long number : asked[rank])
          for (auto found = std::lower_bound(all.begin(), all.end(), Member{number, 0});
               found != all.end() && found->number == number; ++found)
            answers[rank].push_back(*found);
    });
    answers = exchangeItems(comm_, answers);
    agree(comm_, [&] {
      for (std::size_t i = 0; i < owned_.size(); ++i)
        for (const std::vector<Member>& part : answers)
          for (const Member& member : part)
            if (const auto node = nodes[i].find(member.number); node != nodes[i].end())
              owned_[i].mesh.sets[scene_.boundaryRules[member.rule].name].push_back(node->second);
      for (OwnedSubdomain& item : owned_)
        for (const fem::BoundaryRule& rule : scene_.boundaryRules)
          if (const auto set = item.mesh.sets.find(rule.name);
              set != item.mesh.sets.end() && rule.isOn(bodyName(at(item.body))))
            makeSet(set->second);
    });
  }

  template<class T>
  static void makeSet(std::vector<T>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
  }

  const Teuchos::Comm<int>& comm_;
  const Scene& scene_;
  std::vector<OwnedSubdomain>& owned_;
  PartNames names_;
  std::vector<double> diagonals_;
  std::vector<double> counts_;                // by rule and body
  std::vector<std::vector<fem::Side>> outer_; // of each subdomain
  std::map<double, FacedBodies> faced_;       // by distance
};

} // namespace

void chooseBoundaryParts(const Teuchos::Comm<int>& comm, const Scene& scene,
                         std::vector<OwnedSubdomain>& owned) {
  if (!scene.boundaryRules.empty())
    RuleWork(comm, scene, owned).go();
}

} // namespace Harmos::scene
