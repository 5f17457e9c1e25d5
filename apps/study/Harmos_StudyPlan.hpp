// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Application.hpp"

#include <string>
#include <vector>

namespace Harmos::study {

/// What is varied: each value sets all of the axis' parameters.
struct Axis {
  std::string name;
  std::vector<std::string> parameters;          ///< paths in the application's deck
  std::vector<std::vector<std::string>> values; ///< of each parameter
  std::vector<std::string> labels;              ///< what sentences and charts call a value

  /// "8;4": all the parameters' values as the table has them.
  std::string text(std::size_t value) const;
};

/// One value of each axis, by its place.
using Setting = std::vector<std::size_t>;

/// A study, read and checked.
struct Plan {
  app::Application application;
  std::string studyDeck;
  std::string deck;                ///< of the application
  std::vector<std::string> common; ///< assignments of all runs
  std::vector<Axis> axes;
  std::vector<std::string> reference, coarser, coarsest; ///< assignments of the reference meshes
  std::vector<double> targets;
  int repetitions = 1;
  double leastSeconds = 0.0; ///< of all repetitions together
  double tightTolerance = 0.0;
  bool charts = true;
  std::string output;
  bool hasToleranceRule = false;  ///< the deck knows "Solver/Tolerance rule"
  bool hasFriction = false;       ///< the reference's deck names friction
  std::vector<std::string> notes; ///< on rank 0: names at old places in the application's deck and the axes
  /// Of all that errors depend on beside the values of the axes: tables of different ones do not mix.
  std::string fingerprint;

  /// Specification of a study deck.
  static ParameterSpec deckSpec();

  /// @throws InputError on all ranks: what the specification refuses; an application, parameter or value that
  ///         is not there. @note Collective.
  Plan(const Teuchos::Comm<int>& comm, const app::CommandLine& line);

  /// All settings, those of the same scene one after the other.
  std::vector<Setting> settings() const;
  /// "List/Name=value": those that make the scene (meshes, materials, effects), and those of the solver,
  /// which leave it as it is.
  std::vector<std::string> sceneAssignments(const Setting& setting) const;
  std::vector<std::string> solverAssignments(const Setting& setting) const;
  /// "h = 1/32, tolerance 1e-4".
  std::string label(const Setting& setting) const;
  /// The application's deck with these assignments upon the common ones. @note Collective.
  Teuchos::ParameterList readDeck(const Teuchos::Comm<int>& comm, const std::vector<std::string>& assignments,
                                  std::vector<std::string>* newNotes = nullptr) const;

 private:
  void readAxes(const Teuchos::ParameterList& list);
  void checkValues(const Teuchos::Comm<int>& comm);
  std::vector<std::string> assignments(const Setting& setting, bool ofScene) const;
};

} // namespace Harmos::study
