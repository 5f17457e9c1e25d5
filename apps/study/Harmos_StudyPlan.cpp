// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyPlan.hpp"

#include "Harmos_Deck.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FiberComposite.hpp"
#include "Harmos_HarmosApplication.hpp"
#include "Harmos_NearestName.hpp"
#include "Harmos_Signorini.hpp"

#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <sstream>

namespace Harmos::study {
namespace {

using Texts = std::vector<std::string>;

Texts textsOf(const Teuchos::ParameterList& list, const std::string& name) {
  return list.get<Teuchos::Array<std::string>>(name).toVector();
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

Texts split(const std::string& text, char separator) {
  Texts parts;
  std::istringstream stream(text);
  std::string part;
  while (std::getline(stream, part, separator))
    parts.push_back(trimmed(part));
  return parts;
}

// "[2 2 1]" stands for the array {2, 2, 1}: commas separate the values of an axis.
std::string valueOf(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']')
    return text;
  std::istringstream items(text.substr(1, text.size() - 2));
  std::string item, result;
  while (items >> item)
    result += (result.empty() ? "" : ", ") + item;
  return "{" + result + "}";
}

// "tolerance" of "Solver/Tolerance".
std::string lastName(const std::string& path) {
  std::string name = path.substr(path.rfind('/') + 1);
  name[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(name[0])));
  return name;
}

// What leaves meshes and effects as they are, see run::RunOptions::addTo().
bool isOfSolver(const std::string& path) {
  static const std::set<std::string> lists = {"Decomposition", "Dual operator", "Solver", "Output"};
  return lists.count(path.substr(0, path.find('/'))) > 0;
}

std::string hashOf(const std::string& text) { // FNV-1a
  std::uint64_t hash = 14695981039346656037ull;
  for (char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  std::ostringstream stream;
  stream << std::hex << hash;
  return stream.str();
}

// By the decks' own names: scenes are not made to be asked.
bool namesFriction(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList none;
  const auto within = [&](const Teuchos::ParameterList& list, const char* name) -> const auto& {
    return list.isSublist(name) ? list.sublist(name) : none;
  };
  const Teuchos::ParameterList &effects = within(deck, "Effects"), &model = within(deck, "Model");
  const auto isGiven = [&](const char* name) {
    return model.isParameter(name) && model.get<double>(name) > 0.0;
  };
  return within(effects, "Friction").numParams() > 0 || isGiven("Slip bound") ||
         isGiven("Coefficient of friction");
}

std::string joined(const Texts& texts) {
  std::string result;
  for (const std::string& text : texts)
    result += text + "\n";
  return result;
}

ParameterSpec specOf(const app::Application& application) {
  return app::deckSpec(application);
}

} // namespace

std::string Axis::text(std::size_t value) const {
  std::string result;
  for (const std::string& item : values[value])
    result += (result.empty() ? "" : ";") + item;
  return result;
}

ParameterSpec Plan::deckSpec() {
  ParameterSpec deck("study", "Deck of study: computing time for an accuracy, for a scene and its settings.");
  ParameterSpec study("Study", "Scene, runs and targets.");
  study.choice("Application", "signorini",
               {{"signorini", "Signorini problems"},
                {"fiber_composite", "the fibre composite"},
                {"harmos", "any scene of a deck"}},
               "Application of the deck.");
  study.text("Deck", "", "Deck of the application, relative to this deck.");
  study.texts("Set", {}, "Assignments for all runs: \"List/Name=value\". Arrays are written [2 2 1].");
  study.integer("Repetitions", 3, 1, 1000, "Least number of repetitions of each run. Seconds are medians.");
  study.real("Least seconds", 0.5, Range::atLeast(0.0),
             "Least total seconds of the repetitions of a run. Shorter runs are repeated further, at most a "
             "hundred times: the time of a single short run is noise.");
  study.texts("Targets", {"1e-1", "1e-2"},
              "Relative errors for which the report names the cheapest settings.");
  study.real("Tight tolerance", 1e-10, Range::strictlyWithin(0.0, 1e-4),
             "Solver/Tolerance of the reference runs for solver errors. If it is not reached, ten times as "
             "much, and so on.");
  study.boolean("Charts", true, "Draw charts at the end, if Python and Matplotlib are found.");
  study.text("Output", "study", "Directory of study.csv, study.json and the charts; --output overrides it.");
  deck.list(std::move(study));
  ParameterSpec reference("Reference", "Reference solution for errors, and the estimate of its own error.");
  reference.texts("Set", {},
                  "Assignments of the reference, the finest mesh, in addition to those of \"Study/Set\".");
  reference.texts(
      "Coarser", {},
      "Assignments of the next coarser mesh, coarser than \"Set\" by the factor of \"Coarsest\" to "
      "this one.");
  reference.texts("Coarsest", {}, "Assignments of a third mesh. The three give the rate of convergence.");
  deck.list(std::move(reference));
  ParameterSpec axes("Axes", "Axes of the study. Every combination of values is run.");
  ParameterSpec axis("<axis>",
                     "An axis of the study, by a name of your choice. Every combination of the values "
                     "of all axes is run.");
  axis.texts("Parameters", {}, "Paths in the application's deck that each value sets.");
  axis.texts("Values", {},
             "Values; those of several parameters with a semicolon between: {2;16, 4;8}. Arrays are written "
             "[2 2 1].");
  axis.texts("Labels", {}, "Names of the values in report and charts; none: name and value.");
  axes.family(std::move(axis));
  deck.list(std::move(axes));
  return deck;
}

Plan::Plan(const Teuchos::Comm<int>& comm, const app::CommandLine& line) : studyDeck(line.deck) {
  const Teuchos::ParameterList list = scene::readDeck(comm, line.deck, line.assignments, deckSpec());
  const Teuchos::ParameterList& study = list.sublist("Study");
  const std::string name = study.get<std::string>("Application");
  application = name == "signorini"         ? app::signoriniApplication()
                : name == "fiber_composite" ? app::fiberCompositeApplication()
                                            : app::harmosApplication();
  const std::string file = study.get<std::string>("Deck");
  if (file.empty())
    throw InputError(line.deck + ": \"Study/Deck\" is empty; give a deck of " + name +
                     ", relative to this one");
  deck = file.front() == '/' ? file : app::directoryOf(line.deck) + file;
  repetitions = study.get<int>("Repetitions");
  leastSeconds = study.get<double>("Least seconds");
  tightTolerance = study.get<double>("Tight tolerance");
  charts = study.get<bool>("Charts");
  output = line.output.empty() ? study.get<std::string>("Output") : line.output;
  for (const std::string& text : textsOf(study, "Targets")) {
    char* end = nullptr;
    targets.push_back(std::strtod(text.c_str(), &end));
    if (text.empty() || *end != '\0' || !(targets.back() > 0.0))
      throw InputError(line.deck + ": \"Study/Targets\" holds \"" + text +
                       "\", which is not a positive number");
  }
  const auto assignmentsOf = [&](const Teuchos::ParameterList& from, const std::string& key) {
    Texts result = textsOf(from, key);
    for (std::string& assignment : result) {
      const std::size_t sign = assignment.find('=');
      if (sign == std::string::npos || sign == 0)
        throw InputError(line.deck + ": \"" + from.name().substr(from.name().rfind('>') + 1) + "/" + key +
                         "\" holds \"" + assignment + "\", which is not of the form \"List/Name=value\"");
      assignment = trimmed(assignment.substr(0, sign)) + "=" + valueOf(trimmed(assignment.substr(sign + 1)));
    }
    return result;
  };
  common = assignmentsOf(study, "Set");
  const Teuchos::ParameterList& references = list.sublist("Reference");
  reference = assignmentsOf(references, "Set");
  coarser = assignmentsOf(references, "Coarser");
  coarsest = assignmentsOf(references, "Coarsest");
  for (const Texts* which : {&reference, &coarser, &coarsest})
    if (which->empty())
      throw InputError(line.deck + ": the list \"Reference\" needs \"Set\", \"Coarser\" and \"Coarsest\": "
                                   "assignments of three meshes, finest first");
  readAxes(list.sublist("Axes"));

  const Teuchos::ParameterList basis = readDeck(comm, {});
  hasToleranceRule = basis.sublist("Solver").isParameter("Tolerance rule");
  checkValues(comm);
  hasFriction = namesFriction(readDeck(comm, reference));
  std::ostringstream text;
  Teuchos::writeParameterListToXmlOStream(basis, text);
  text << name << "\n"
       << joined(reference) << "\n"
       << joined(coarser) << "\n"
       << joined(coarsest) << "\n"
       << tightTolerance;
  for (const Axis& axis : axes)
    text << "\n" << axis.name << "\n" << joined(axis.parameters);
  fingerprint = hashOf(text.str());
}

void Plan::readAxes(const Teuchos::ParameterList& list) {
  for (auto member = list.begin(); member != list.end(); ++member) {
    const std::string name = list.name(member), place = "\"Axes/" + name + "\"";
    const Teuchos::ParameterList& from = list.sublist(name);
    Axis axis;
    axis.name = name;
    axis.parameters = textsOf(from, "Parameters");
    axis.labels = textsOf(from, "Labels");
    const Texts texts = textsOf(from, "Values");
    if (axis.parameters.empty() || texts.empty())
      throw InputError(studyDeck + ": " + place + " needs \"Parameters\" and \"Values\"");
    if (!axis.labels.empty() && axis.labels.size() != texts.size())
      throw InputError(studyDeck + ": " + place + " has " + std::to_string(texts.size()) + " values, but " +
                       std::to_string(axis.labels.size()) + " labels");
    for (const std::string& text : texts) {
      Texts items = split(text, ';');
      if (items.size() != axis.parameters.size())
        throw InputError(studyDeck + ": " + place + " sets " + std::to_string(axis.parameters.size()) +
                         " parameters, but its value \"" + text + "\" has " + std::to_string(items.size()) +
                         " parts; separate them by semicolons");
      for (std::string& item : items)
        item = valueOf(item);
      if (std::find(axis.values.begin(), axis.values.end(), items) != axis.values.end())
        throw InputError(studyDeck + ": " + place + " has the value \"" + text + "\" twice");
      axis.values.push_back(std::move(items));
      if (axis.labels.size() < texts.size() && textsOf(from, "Labels").empty())
        axis.labels.push_back((axis.parameters.size() == 1 ? lastName(axis.parameters[0]) : name) + " " +
                              axis.text(axis.values.size() - 1));
    }
    axes.push_back(std::move(axis));
  }
  if (axes.empty())
    throw InputError(studyDeck + ": the list \"Axes\" is empty; add the parameters to vary");
}

void Plan::checkValues(const Teuchos::Comm<int>& comm) {
  const auto check = [&](const std::string& what, const Texts& assignments) {
    try {
      std::vector<std::string> found;
      readDeck(comm, assignments, &found);
      for (const std::string& note : found)
        if (std::find(notes.begin(), notes.end(), note) == notes.end())
          notes.push_back(note);
    } catch (const InputError& error) {
      throw InputError(studyDeck + ": " + what + ": " + error.what(), error.data());
    }
  };
  for (const Axis& axis : axes)
    for (const Texts& items : axis.values) {
      Texts assignments;
      for (std::size_t k = 0; k < items.size(); ++k)
        assignments.push_back(axis.parameters[k] + "=" + items[k]);
      check("\"Axes/" + axis.name + "\"", assignments);
    }
  check("\"Reference/Set\"", reference);
  check("\"Reference/Coarser\"", coarser);
  check("\"Reference/Coarsest\"", coarsest);
}

Teuchos::ParameterList Plan::readDeck(const Teuchos::Comm<int>& comm, const Texts& assignments,
                                      Texts* newNotes) const {
  Texts all = common;
  all.insert(all.end(), assignments.begin(), assignments.end());
  return scene::readDeck(comm, deck, all, specOf(application), newNotes);
}

std::vector<Setting> Plan::settings() const {
  std::vector<Setting> all = {{}};
  for (const Axis& axis : axes) {
    std::vector<Setting> longer;
    for (const Setting& setting : all)
      for (std::size_t value = 0; value < axis.values.size(); ++value) {
        longer.push_back(setting);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  // Scenes in the order in which they come first.
  std::vector<Texts> scenes;
  const auto sceneOf = [&](const Setting& setting) {
    const Texts scene = sceneAssignments(setting);
    const std::ptrdiff_t place = std::find(scenes.begin(), scenes.end(), scene) - scenes.begin();
    if (place == static_cast<std::ptrdiff_t>(scenes.size()))
      scenes.push_back(scene);
    return place;
  };
  std::vector<std::pair<std::ptrdiff_t, Setting>> keyed;
  for (const Setting& setting : all) {
    const std::ptrdiff_t scene = sceneOf(setting);
    keyed.emplace_back(scene, setting);
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k] = keyed[k].second;
  return all;
}

Texts Plan::assignments(const Setting& setting, bool ofScene) const {
  Texts result;
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (std::size_t k = 0; k < axes[a].parameters.size(); ++k)
      if (isOfSolver(axes[a].parameters[k]) != ofScene)
        result.push_back(axes[a].parameters[k] + "=" + axes[a].values[setting[a]][k]);
  return result;
}

Texts Plan::sceneAssignments(const Setting& setting) const {
  return assignments(setting, true);
}

Texts Plan::solverAssignments(const Setting& setting) const {
  return assignments(setting, false);
}

std::string Plan::label(const Setting& setting) const {
  std::string result;
  for (std::size_t a = 0; a < axes.size(); ++a)
    result += (result.empty() ? "" : ", ") + axes[a].labels[setting[a]];
  return result;
}

} // namespace Harmos::study
