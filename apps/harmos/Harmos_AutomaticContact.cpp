// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AutomaticContact.hpp"

#include "Harmos_Decomposition.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FacingSides.hpp"
#include "Harmos_NearestName.hpp"

#include <algorithm>
#include <set>

namespace Harmos::app {
namespace {

using Teuchos::ParameterList;
using BodyPair = std::pair<int, int>; // the lower number first

constexpr const char* kindName = "Automatic contact";

std::vector<std::string> namesOf(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const scene::Body& body : scene.bodies)
    names.push_back(body.name);
  return names;
}

std::set<int> bodiesIn(const ParameterList& list, const std::string& path,
                       const std::vector<std::string>& names) {
  std::set<int> bodies;
  for (const std::string& name : list.get<Teuchos::Array<std::string>>("Bodies")) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw InputError("\"" + path + "/Bodies\" names the body \"" + name + "\", which does not exist" +
                           offer(name, names),
                       {{"path", path + "/Bodies"}});
    bodies.insert(static_cast<int>(found - names.begin()));
  }
  for (int b = 0;
       b < static_cast<int>(names.size()) && list.get<Teuchos::Array<std::string>>("Bodies").empty(); ++b)
    bodies.insert(b);
  return bodies;
}

// Those that a contact or tie of the deck couples.
std::set<BodyPair> coupledPairs(const ParameterList& effects, const std::vector<std::string>& names) {
  std::set<BodyPair> pairs;
  for (const char* kind : {"Contact", "Tie"}) {
    const ParameterList& list = effects.sublist(kind);
    for (auto item = list.begin(); item != list.end(); ++item) {
      const auto bodyOf = [&](const char* side) {
        const auto part = list.sublist(list.name(item)).get<std::string>(side);
        const auto found = std::find(names.begin(), names.end(), part.substr(0, part.find('/')));
        return static_cast<int>(found - names.begin());
      };
      pairs.insert(std::minmax(bodyOf("First"), bodyOf("Second")));
    }
  }
  return pairs;
}

long long sumOf(const std::map<std::size_t, long long>& counts) {
  long long sum = 0;
  for (const auto& entry : counts)
    sum += entry.second;
  return sum;
}

// Adds contacts of pairs to the effects of a deck, and their parts to the scene.
class Pairs {
 public:
  Pairs(const DeckContext& context, const scene::EffectRegistry& registry, ParameterList& effects,
        scene::Scene& scene)
      : context_(context),
        registry_(registry),
        effects_(effects),
        scene_(scene),
        names_(namesOf(scene)),
        taken_(coupledPairs(effects, names_)) {}

  /// @param faced of the scene's meshes.
  void add(const ParameterList& list, const std::string& path,
           const std::map<BodyPair, scene::FacingCounts>& faced, const std::vector<double>& diagonals) {
    const std::set<int> bodies = bodiesIn(list, path, names_);
    for (int body : bodies)
      if (name(body).find('/') != std::string::npos)
        throw InputError("\"" + path + "\" names contacts by their bodies, but body \"" + name(body) +
                             "\" has a slash in its name, the separator of lists; rename it, or leave it out",
                         {{"path", path + "/Bodies"}});
    int count = 0;
    for (const auto& [pair, sides] : faced) {
      // Both need sides: a corner that reaches into another body faces nothing.
      if (bodies.count(pair.first) == 0 || bodies.count(pair.second) == 0 || sides.first.empty() ||
          sides.second.empty() || !taken_.insert(pair).second)
        continue;
      const double nearness =
          scene::usualNearness * std::min(diagonals[static_cast<std::size_t>(pair.first)],
                                          diagonals[static_cast<std::size_t>(pair.second)]);
      addPair(list, pair, sides, nearness);
      ++count;
    }
    if (count == 0)
      scene_.notes.push_back("\"" + path +
                             "\": no two of its bodies have sides that face each other within \"Distance\", "
                             "or other effects couple them all");
  }

 private:
  const std::string& name(int body) const { return names_[static_cast<std::size_t>(body)]; }

  // A name that nothing has yet.
  template<class IsTaken>
  static std::string unused(const std::string& wanted, const IsTaken& isTaken) {
    std::string result = wanted;
    for (int k = 2; isTaken(result); ++k)
      result = wanted + "-" + std::to_string(k);
    return result;
  }

  // A contact for each two shapes of sides. @param nearness of the two, where the list has none.
  void addPair(const ParameterList& list, const BodyPair& pair, const scene::FacingCounts& sides,
               double nearness) {
    const double distance = list.get<double>("Distance");
    const std::map<std::size_t, std::string> first =
                                                 partsFacing(pair.first, pair.second, distance, sides.first),
                                             second =
                                                 partsFacing(pair.second, pair.first, distance, sides.second);
    const bool isFirst = sumOf(sides.first) >= sumOf(sides.second);
    for (const auto& one : first)
      for (const auto& other : second) {
        const std::string key =
            addContact(list, name(pair.first) + "-" + name(pair.second), isFirst ? one.second : other.second,
                       isFirst ? other.second : one.second, distance > 0.0 ? distance : nearness);
        context_.log.info("Automatic contact \"" + key + "\": \"" + name(pair.first) + "\" (" +
                          std::to_string(sides.first.at(one.first)) + " sides) and \"" + name(pair.second) +
                          "\" (" + std::to_string(sides.second.at(other.first)) + " sides)");
      }
  }

  // By the numbers of corners of their sides.
  std::map<std::size_t, std::string> partsFacing(int body, int other, double distance,
                                                 const std::map<std::size_t, long long>& sides) {
    std::map<std::size_t, std::string> parts;
    for (const auto& entry : sides) {
      fem::BoundaryRule rule;
      rule.name = unused("facing " + name(other), [&](const std::string& part) {
        return std::any_of(
            scene_.boundaryRules.begin(), scene_.boundaryRules.end(),
            [&](const fem::BoundaryRule& known) { return known.name == part && known.isOn(name(body)); });
      });
      rule.bodies = {name(body)};
      rule.facing = fem::BoundaryRule::Facing{{name(other)}, distance};
      if (sides.size() > 1)
        rule.corners = entry.first;
      scene_.boundaryRules.push_back(rule);
      parts[entry.first] = name(body) + "/" + rule.name;
    }
    return parts;
  }

  // @return its name.
  std::string addContact(const ParameterList& list, const std::string& wanted, const std::string& first,
                         const std::string& second, double reach) {
    const std::string key = unused(wanted, [&](const std::string& known) {
      return effects_.sublist("Contact").isSublist(known) || effects_.sublist("Friction").isSublist(known);
    });
    ParameterList contact = registry_.defaultsOf("Contact");
    contact.set("First", first);
    contact.set("Second", second);
    contact.set("Reach", reach);
    for (const char* parameter : {"Gap", "Adjust", "Stiffness"})
      contact.set(parameter, list.get<double>(parameter));
    effects_.sublist("Contact").set(key, contact);
    if (list.get<double>("Friction coefficient") > 0.0) {
      ParameterList friction = registry_.defaultsOf("Friction");
      friction.set("Contact", "Contact/" + key);
      friction.set("Coefficient", list.get<double>("Friction coefficient"));
      effects_.sublist("Friction").set(key, friction);
    }
    return key;
  }

  const DeckContext& context_;
  const scene::EffectRegistry& registry_;
  ParameterList& effects_;
  scene::Scene& scene_;
  std::vector<std::string> names_;
  std::set<BodyPair> taken_;
};

} // namespace

scene::EffectKind kindOfAutomaticContact() {
  ParameterSpec spec(
      "<contacts>", "A contact between any two bodies that have sides near each other. It is "
                    "called \"one-other\" by the bodies, in their order; their parts are \"facing <body>\".");
  spec.texts("Bodies", {}, "The bodies; none: all.");
  spec.real("Distance", 0.0, Range::atLeast(0.0),
            "Largest distance of sides that face each other, a length: more than what closes under load. "
            "0: a twentieth of the diagonal of the smaller body.");
  spec.real("Friction coefficient", 0.0, Range::atLeast(0.0), "Coulomb friction; 0: none.");
  spec.real("Gap", 0.0, Range(), "As of a contact.");
  spec.real("Adjust", 0.0, Range::atLeast(0.0), "As of a contact.");
  spec.real("Stiffness", 0.0, Range::atLeast(0.0), "As of a contact.");
  return {kindName, spec,
          [](const ParameterList&, const std::string& path,
             const scene::Scene&) -> std::shared_ptr<const scene::Effect> {
            throw InternalError("\"" + path + "\" was not replaced by contacts");
          },
          false};
}

ParameterList withAutomaticContacts(const DeckContext& context, const scene::EffectRegistry& registry,
                                    scene::Scene& scene) {
  ParameterList deck = context.deck;
  const ParameterList automatic = deck.sublist("Effects").sublist(kindName);
  if (automatic.begin() == automatic.end())
    return deck;
  deck.sublist("Effects").set(kindName, ParameterList());
  scene::Scene bodies = scene; // no rules, no effects
  bodies.boundaryRules.clear();
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(context.comm, bodies);
  const std::vector<double> diagonals = scene::bodyDiagonals(context.comm, scene.bodies.size(), owned);
  Pairs pairs(context, registry, deck.sublist("Effects"), scene);
  for (auto item = automatic.begin(); item != automatic.end(); ++item) {
    const ParameterList& list = automatic.sublist(automatic.name(item));
    const auto faced =
        scene::facingPairs(context.comm, scene.bodies.size(), owned, list.get<double>("Distance"));
    pairs.add(list, std::string("Effects/") + kindName + "/" + automatic.name(item), faced, diagonals);
  }
  return deck;
}

} // namespace Harmos::app
