// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::scene {

class Effect;

/// A factor over time: piecewise linear, constant before its first time and after its last.
/// Guarded by tests/unit/scene/test_timeline.cpp.
class History {
 public:
  /// @param times rising; @param values one for each.
  /// @throws InputError for none, for times that do not rise, and for lists of different lengths.
  History(std::vector<double> times, std::vector<double> values);

  double operator()(double time) const;
  const std::vector<double>& times() const { return times_; }

 private:
  std::vector<double> times_, values_;
};

/// The times at which a run looks at its scene, and how the magnitudes of effects go in between: a magnitude
/// at a time is what the effect says times the factor of its history.
///
/// The run begins at time 0, without loads and displacements. The histories "ramp" (from 0 at the beginning
/// to 1 at the end) and "constant" (1) are always there; an effect with a magnitude follows the first where
/// there are several steps and the second where there is one or bodies have inertia, unless follow() says
/// otherwise.
///
/// Guarded by tests/unit/scene/test_timeline.cpp.
class Timeline {
 public:
  /// One step, to time 1.
  Timeline() = default;
  /// @param ends of the steps. @param smallest part of a step, as a share of it, that is tried where the step
  /// itself does not converge.
  /// @throws InputError for none, and for times that are not positive or do not rise.
  explicit Timeline(std::vector<double> ends, double smallest = defaultSmallest);
  static constexpr double defaultSmallest = 1.0 / 64.0;

  /// The list Steps of a deck.
  static void addTo(ParameterSpec& deck, bool mayBeTransient = false);
  /// From a validated deck. @throws InputError for steps and histories that make no sense.
  static Timeline fromDeck(const Teuchos::ParameterList& deck);

  /// @throws InputError if there is one of that name.
  void add(const std::string& name, History history);
  /// @param effect of the scene. @param history "": the default.
  void follow(const Effect& effect, const std::string& history);
  /// What another timeline says of effects.
  void followAsIn(const Timeline& other) { followed_ = other.followed_; }
  /// @throws InputError for an effect among these that follows a history which is not there, with the nearest
  /// name, or that has no magnitude.
  void check(const std::vector<std::shared_ptr<const Effect>>& effects) const;

  const std::vector<double>& ends() const { return ends_; }
  double end() const { return ends_.back(); }
  /// More than one, or one whose time a deck gives.
  bool hasSteps() const { return ends_.size() > 1 || isGiven_; }
  /// A single step is one in which loads come up, and which may be halved, not a static state.
  void bringUp() { isGiven_ = true; }
  double smallest() const { return smallest_; }
  /// Whether bodies have inertia, and the spectral radius ρ∞ of their time integration.
  bool isTransient() const { return spectralRadius_.has_value(); }
  double spectralRadius() const { return spectralRadius_.value_or(1.0); }
  /// Of periods of what moves, relative: steps are halved until they are as exact; 0: they are as given.
  double timeError() const { return timeError_; }
  void keepWithin(double timeError) { timeError_ = timeError; }
  /// Makes it transient. @param spectralRadius from 0 to 1: how much of motions stays that steps do not
  /// resolve.
  void integrate(double spectralRadius) { spectralRadius_ = spectralRadius; }

  /// The name of the history that an effect follows.
  std::string historyOf(const Effect& effect) const;
  /// Of a history at a time. @throws InternalError if there is none of that name.
  double factor(const std::string& history, double time) const;
  double factor(const Effect& effect, double time) const { return factor(historyOf(effect), time); }
  /// Of those that were added, by the alphabet.
  std::vector<std::string> names() const;
  /// Between two of these times that follow each other every history is linear; from the run's beginning to
  /// its end.
  std::vector<double> corners() const;

 private:
  std::vector<double> ends_ = {1.0};
  double smallest_ = defaultSmallest;
  bool isGiven_ = false; // the times, by a deck
  std::optional<double> spectralRadius_;
  double timeError_ = 0.0;
  std::map<std::string, History> histories_;
  std::map<const Effect*, std::string> followed_;
};

} // namespace Harmos::scene
