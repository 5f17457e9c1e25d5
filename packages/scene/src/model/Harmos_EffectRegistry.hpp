// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::scene {

/// A kind of effect that decks may name.
struct EffectKind {
  std::string name;         ///< "Contact": of the list in the deck, in the log and the summary
  ParameterSpec parameters; ///< of one effect; its meaning is the sentence that says what the effect is
  /// Makes one from its validated list, for a scene that has its bodies.
  /// @param path of the list in the deck, for messages: "Effects/Contact/joint".
  /// @throws InputError for bodies that are not there and settings that make no sense.
  std::function<std::shared_ptr<const Effect>(const Teuchos::ParameterList& list, const std::string& path,
                                              const Scene& scene)>
      make;
  /// Whether effects of it have a magnitude, which the parameter History, added by the registry, scales.
  bool hasMagnitude = false;
};

/// The kinds of effects that an application admits in its decks, in an order that is also that of the rows
/// and the log. An object, filled by calls: nothing registers itself, for linkers drop what nobody calls.
///
/// Guarded by tests/unit/effects/test_registry.cpp.
class EffectRegistry {
 public:
  /// @throws InternalError for a name that is taken.
  void add(EffectKind kind);

  const std::vector<EffectKind>& kinds() const { return kinds_; }

  /// The list Effects: a sublist a kind, in which each effect has a name of its own.
  void addParameters(ParameterSpec& deck) const;

  /// The parameters of an effect of a kind, all at their defaults.
  /// @throws InternalError for a kind that is not registered.
  Teuchos::ParameterList defaultsOf(const std::string& kind) const;

  /// Adds the effects that a validated deck names to a scene that has its bodies.
  /// @throws InputError, see EffectKind::make. Local.
  void addEffects(const Teuchos::ParameterList& deck, Scene& scene) const;

  /// Kinds, what they are and their parameters, for the terminal.
  void write(std::ostream& out) const;

 private:
  ParameterSpec spec() const;
  static ParameterSpec parametersOf(const EffectKind& kind);

  std::vector<EffectKind> kinds_;
};

/// The last part of a path: the name that an effect has in its deck.
std::string nameIn(const std::string& path);

} // namespace Harmos::scene
