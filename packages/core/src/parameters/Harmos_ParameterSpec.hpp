// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_NearestName.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <iosfwd>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace Harmos {

/// Admissible numbers; either end may be excluded.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool leastExcluded = false;
  bool mostExcluded = false;

  static Range atLeast(double least) {
    return {least, std::numeric_limits<double>::infinity(), false, false};
  }
  static Range above(double least) { return {least, std::numeric_limits<double>::infinity(), true, false}; }
  static Range within(double least, double most) { return {least, most, false, false}; }
  static Range strictlyWithin(double least, double most) { return {least, most, true, true}; }

  bool contains(double value) const;
  std::string text() const;
};

/// The one description of a parameter list: type, default, range and meaning of every parameter.
///
/// From it come the validation of decks, the defaults, the reference pages and Teuchos' valid parameters;
/// there is no second list anywhere. Names are matched exactly: case, spaces and all; there are no synonyms.
///
/// Parameters that few users set are in the sublist "Expert" of their list, see expert(). This version still
/// reads each of them directly in the list, its place in version 0.1, with a note that names the present
/// place.
///
/// Guarded by tests/unit/core/test_parameter_spec.cpp and test_expert_parameters.cpp.
class ParameterSpec {
 public:
  /// An allowed value of a choice and what it means.
  using Choice = std::pair<std::string, std::string>;

  /// @param name of the list as it stands in the deck; @param meaning a sentence.
  ParameterSpec(std::string name, std::string meaning);

  ParameterSpec& integer(const std::string& name, int value, int least, int most, const std::string& meaning);
  ParameterSpec& real(const std::string& name, double value, const Range& range, const std::string& meaning);
  ParameterSpec& boolean(const std::string& name, bool value, const std::string& meaning);
  ParameterSpec& text(const std::string& name, const std::string& value, const std::string& meaning);
  ParameterSpec& choice(const std::string& name, const std::string& value, const std::vector<Choice>& allowed,
                        const std::string& meaning);
  /// The same, or an integer, of type "int" in a deck; in the validated list it is text.
  ParameterSpec& choiceOrInteger(const std::string& name, const std::string& value,
                                 const std::vector<Choice>& allowed, int least, int most,
                                 const std::string& meaning) {
    choice(name, value, allowed, meaning);
    parameters_.back().mayBeInteger = true;
    parameters_.back().range = Range::within(least, most);
    return *this;
  }
  /// The parameter that was added last had this name before: it is still read, with a note.
  ParameterSpec& formerly(const std::string& name) {
    parameters_.back().former = name;
    return *this;
  }
  /// As many numbers as the default has; type "Array(double)" and "Array(int)" in a deck.
  ParameterSpec& reals(const std::string& name, const std::vector<double>& value, const Range& range,
                       const std::string& meaning);
  /// Any number of numbers, none by default; type "Array(double)".
  ParameterSpec& series(const std::string& name, const Range& range, const std::string& meaning);
  ParameterSpec& integers(const std::string& name, const std::vector<int>& value, int least, int most,
                          const std::string& meaning);
  /// Any number of texts; type "Array(string)".
  ParameterSpec& texts(const std::string& name, const std::vector<std::string>& value,
                       const std::string& meaning);
  ParameterSpec& list(ParameterSpec sublist);
  /// Sublists of any names, each as the member describes; the member's own name is what the reference calls
  /// such a name: "<body>".
  ParameterSpec& family(ParameterSpec member);

  /// The sublist "Expert" of this list, made on demand: parameters, and lists, that few users set. A list
  /// with a family has none. In a deck their names are also read directly in this list.
  ParameterSpec& expert();

  /// A list that another library describes and checks: it is taken as it is. In assignments values are true
  /// or false, whole numbers, numbers, else text.
  ParameterSpec& foreign(const std::string& name, const std::string& meaning) {
    list(ParameterSpec(name, meaning));
    lists_.back().isForeign_ = true;
    return *this;
  }

  /// A name that people may expect and that is none here; they are told why, in a clause: "a contact has no
  /// magnitude".
  ParameterSpec& absent(const std::string& name, const std::string& why);

  const std::string& name() const { return name_; }
  const std::string& meaning() const { return meaning_; }

  /// The given list, checked and completed by the defaults.
  ///
  /// Every fault is reported at once, each with its path in the deck, what was found, what is allowed and the
  /// nearest known name. A whole number is accepted where a real one is expected; no other conversion is
  /// made. Expert parameters at their old place move to "Expert"; at both places they must be equal.
  ///
  /// @param source what the message calls the origin, a file name for instance.
  /// @param notes null or: a sentence for each name at an old place is added.
  /// @throws InputError
  Teuchos::ParameterList validated(const Teuchos::ParameterList& given, const std::string& source,
                                   std::vector<std::string>* notes = nullptr) const;

  /// Of a validated list of another description, the entries that this one has too.
  Teuchos::ParameterList commonPart(const Teuchos::ParameterList& other) const;

  /// All parameters at their defaults.
  Teuchos::ParameterList defaults() const;

  /// Defaults with documentation strings and Teuchos validators, for getValidParameters().
  Teuchos::RCP<Teuchos::ParameterList> teuchosList() const;

  /// Puts a value, given as text, at a path: "List/Sublist/Name". It replaces the value at either place of an
  /// expert parameter.
  /// @param notes as of validated().
  /// @throws InputError if the path is unknown (the nearest is offered) or the text is not of its type.
  void set(Teuchos::ParameterList& list, const std::string& path, const std::string& value,
           const std::string& source, std::vector<std::string>* notes = nullptr) const;

  /// A complete deck with the defaults, each parameter with its documentation string.
  void writeXml(std::ostream& out) const;

  /// For the documentation: a heading for each list, an item for each parameter, at most 118 columns wide.
  void writeMarkdown(std::ostream& out) const;

  /// For the terminal: everything, each choice with its meaning.
  void writeText(std::ostream& out) const;

  /// The same of one list or parameter, named by its path: "Solver", "Bodies/<body>", "Solver/Tolerance".
  /// @throws InputError if the path is unknown; the nearest name is offered.
  void writeText(std::ostream& out, const std::string& path) const;

  /// For the terminal, at most 118 columns wide: the public parameters, a line each.
  void writeOverview(std::ostream& out) const;

 private:
  static void setForeign(Teuchos::ParameterList& list, const std::string& path, const std::string& value);
  /// What a walk through a list finds.
  struct Findings {
    std::vector<std::string> faults, notes;
  };

  enum class Type { Integer, Real, Boolean, Text, Choice, Integers, Reals, Series, Texts };

  struct Parameter {
    std::string name;
    Type type;
    std::string meaning;
    // The default; the member that the type names.
    int integer = 0;
    double real = 0.0;
    bool boolean = false;
    std::string text;
    std::vector<int> integers;
    std::vector<double> reals;
    std::vector<std::string> texts;
    Range range;
    std::vector<Choice> allowed;
    bool mayBeInteger = false; ///< beside choices
    std::string former;        ///< name; empty: it never had another
  };

  Parameter& add(const std::string& name, Type type, const std::string& meaning);
  const Parameter* find(const std::string& name) const;
  /// Of a name that a parameter had before.
  const Parameter* findFormer(const std::string& name) const;
  const ParameterSpec* findList(const std::string& name) const;
  /// Null, or the description of "Expert" if it has the name, which then stands at its old place.
  const ParameterSpec* expertOf(const std::string& name) const;
  std::vector<std::string> names() const;
  std::string unknownName(const std::string& what, const std::string& path, const std::string& name,
                          const std::vector<std::string>& candidates) const;
  std::string unknownParameter(const std::string& path, const std::string& name) const;
  static std::string moved(const std::string& path, const std::string& name);
  static std::string renamed(const std::string& path, const Parameter& parameter);
  void set(Teuchos::ParameterList& list, const std::string& head, const std::string& path,
           const std::string& value, const std::string& source, Findings& findings) const;
  static void set(const Parameter& parameter, Teuchos::ParameterList& list, const std::string& value,
                  const std::string& place, const std::string& source);
  void validate(const Teuchos::ParameterList& given, const std::string& path, Teuchos::ParameterList& result,
                Findings& findings) const;
  void validateList(const Teuchos::ParameterList& given, const std::string& path, const std::string& name,
                    Teuchos::ParameterList& result, Findings& findings) const;
  void validateValue(const Teuchos::ParameterEntry& entry, const std::string& path, const std::string& name,
                     Teuchos::ParameterList& result, Findings& findings) const;
  static void validate(const Parameter& parameter, const Teuchos::ParameterEntry& entry,
                       const std::string& path, Teuchos::ParameterList& result,
                       std::vector<std::string>& faults);
  static void setDefault(const Parameter& parameter, Teuchos::ParameterList& list, bool validators);
  void fill(Teuchos::ParameterList& list, bool validators) const;
  static std::string expected(const Parameter& parameter);
  static std::string typeName(Type type);
  static bool hasRange(Type type);
  static std::string defaultText(const Parameter& parameter);
  void writeMarkdown(std::ostream& out, const std::string& path) const;
  static void writeMarkdown(std::ostream& out, const Parameter& parameter);
  static void writeText(std::ostream& out, const Parameter& parameter);
  void writeLists(std::ostream& out, const std::string& path) const;
  void writeOverview(std::ostream& out, const std::string& path) const;
  static void writeOverview(std::ostream& out, const Parameter& parameter);
  void writeOverviewHead(std::ostream& out, const std::string& path) const;
  void writeOverviewOfFamily(std::ostream& out, const std::string& path) const;
  std::size_t numberOfParameters() const;

  std::string name_;
  std::string meaning_;
  std::vector<Parameter> parameters_;
  std::vector<ParameterSpec> lists_;
  std::vector<ParameterSpec> family_; // none or one
  std::vector<ParameterSpec> expert_; // none or one
  std::vector<std::pair<std::string, std::string>> absent_;
  bool isForeign_ = false;
};

} // namespace Harmos
