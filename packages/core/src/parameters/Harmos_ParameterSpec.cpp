// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ParameterSpec.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_ParameterText.hpp"

#include <Teuchos_StandardParameterEntryValidators.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos {
namespace {

std::string numberText(double value) {
  if (std::isinf(value))
    return value > 0 ? "inf" : "-inf";
  std::ostringstream text;
  text << std::setprecision(15) << value;
  return text.str();
}

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts)
    result += (result.empty() ? "" : ", ") + quoted(text);
  return result;
}

template<class List, class Text>
std::string arrayText(const List& values, Text&& text) {
  std::string result;
  for (const auto& value : values)
    result += (result.empty() ? "" : ", ") + text(value);
  return "{" + result + "}";
}

std::string foundText(const Teuchos::ParameterEntry& entry) {
  std::ostringstream value;
  entry.getAny(false).print(value);
  if (entry.isType<bool>())
    return std::string("a boolean (") + (Teuchos::getValue<bool>(entry) ? "true" : "false") + ")";
  if (entry.isType<int>())
    return "an integer (" + value.str() + ")";
  if (entry.isType<double>())
    return "a real number (" + numberText(Teuchos::getValue<double>(entry)) + ")";
  if (entry.isType<std::string>())
    return "a string (" + quoted(value.str()) + ")";
  if (entry.isType<Teuchos::Array<double>>())
    return "an array (" + arrayText(Teuchos::getValue<Teuchos::Array<double>>(entry), numberText) + ")";
  if (entry.isType<Teuchos::Array<int>>() || entry.isType<Teuchos::Array<std::string>>())
    return "an array (" + value.str() + ")";
  return "of type " + entry.getAny(false).typeName();
}

template<class T>
Teuchos::Array<T> arrayOf(const std::vector<T>& values) {
  return Teuchos::Array<T>(values.begin(), values.end());
}

std::vector<std::string> namesOf(const std::vector<ParameterSpec::Choice>& choices) {
  std::vector<std::string> names;
  for (const ParameterSpec::Choice& choice : choices)
    names.push_back(choice.first);
  return names;
}

// Values at the old place and in the list "Expert" that differ.
void findContradictions(const Teuchos::ParameterEntry& old, const Teuchos::ParameterList& expert,
                        const std::string& path, const std::string& name, std::vector<std::string>& faults,
                        const std::string& between = "") {
  if (!expert.isParameter(name) || old.isList() != expert.isSublist(name))
    return;
  if (old.isList()) {
    const Teuchos::ParameterList& list = Teuchos::getValue<Teuchos::ParameterList>(old);
    for (auto item = list.begin(); item != list.end(); ++item)
      findContradictions(list.entry(item), expert.sublist(name), path, list.name(item), faults,
                         between + name + "/");
    return;
  }
  const std::string one = foundText(old), other = foundText(expert.getEntry(name));
  if (one != other)
    faults.push_back(quoted(path + between + name) + " is " + one + ", but " +
                     quoted(path + expertName + "/" + between + name) + " is " + other +
                     "; keep the second, which is its present place");
}

} // namespace

bool Range::contains(double value) const {
  // NaN and the infinities lie in no range.
  const bool above = leastExcluded ? value > least : value >= least;
  const bool below = mostExcluded ? value < most : value <= most;
  return std::isfinite(value) && above && below;
}

std::string Range::text() const {
  const bool openLeft = leastExcluded || std::isinf(least);
  const bool openRight = mostExcluded || std::isinf(most);
  return std::string(openLeft ? "(" : "[") + numberText(least) + ", " + numberText(most) +
         (openRight ? ")" : "]");
}

ParameterSpec::ParameterSpec(std::string name, std::string meaning)
    : name_(std::move(name)), meaning_(std::move(meaning)) {}

ParameterSpec::Parameter& ParameterSpec::add(const std::string& name, Type type, const std::string& meaning) {
  HARMOS_REQUIRE(find(name) == nullptr && findList(name) == nullptr,
                 "the parameter " + quoted(name) + " is specified twice");
  Parameter parameter;
  parameter.name = name;
  parameter.type = type;
  parameter.meaning = meaning;
  parameters_.push_back(std::move(parameter));
  return parameters_.back();
}

ParameterSpec& ParameterSpec::integer(const std::string& name, int value, int least, int most,
                                      const std::string& meaning) {
  Parameter& parameter = add(name, Type::Integer, meaning);
  parameter.integer = value;
  parameter.range = Range::within(least, most);
  return *this;
}

ParameterSpec& ParameterSpec::real(const std::string& name, double value, const Range& range,
                                   const std::string& meaning) {
  Parameter& parameter = add(name, Type::Real, meaning);
  parameter.real = value;
  parameter.range = range;
  return *this;
}

ParameterSpec& ParameterSpec::boolean(const std::string& name, bool value, const std::string& meaning) {
  add(name, Type::Boolean, meaning).boolean = value;
  return *this;
}

ParameterSpec& ParameterSpec::text(const std::string& name, const std::string& value,
                                   const std::string& meaning) {
  add(name, Type::Text, meaning).text = value;
  return *this;
}

ParameterSpec& ParameterSpec::choice(const std::string& name, const std::string& value,
                                     const std::vector<Choice>& allowed, const std::string& meaning) {
  Parameter& parameter = add(name, Type::Choice, meaning);
  parameter.text = value;
  parameter.allowed = allowed;
  return *this;
}

ParameterSpec& ParameterSpec::reals(const std::string& name, const std::vector<double>& value,
                                    const Range& range, const std::string& meaning) {
  Parameter& parameter = add(name, Type::Reals, meaning);
  parameter.reals = value;
  parameter.range = range;
  return *this;
}

ParameterSpec& ParameterSpec::series(const std::string& name, const Range& range,
                                     const std::string& meaning) {
  add(name, Type::Series, meaning).range = range;
  return *this;
}

ParameterSpec& ParameterSpec::absent(const std::string& name, const std::string& why) {
  absent_.emplace_back(name, why);
  return *this;
}

ParameterSpec& ParameterSpec::integers(const std::string& name, const std::vector<int>& value, int least,
                                       int most, const std::string& meaning) {
  Parameter& parameter = add(name, Type::Integers, meaning);
  parameter.integers = value;
  parameter.range = Range::within(least, most);
  return *this;
}

ParameterSpec& ParameterSpec::texts(const std::string& name, const std::vector<std::string>& value,
                                    const std::string& meaning) {
  add(name, Type::Texts, meaning).texts = value;
  return *this;
}

ParameterSpec& ParameterSpec::family(ParameterSpec member) {
  HARMOS_REQUIRE(family_.empty(), "the list \"" + name_ + "\" has two families");
  family_.push_back(std::move(member));
  return *this;
}

ParameterSpec& ParameterSpec::list(ParameterSpec sublist) {
  HARMOS_REQUIRE(find(sublist.name()) == nullptr && findList(sublist.name()) == nullptr,
                 "the list " + quoted(sublist.name()) + " is specified twice");
  lists_.push_back(std::move(sublist));
  return *this;
}

const ParameterSpec::Parameter* ParameterSpec::find(const std::string& name) const {
  for (const Parameter& parameter : parameters_)
    if (parameter.name == name)
      return &parameter;
  return nullptr;
}

const ParameterSpec* ParameterSpec::findList(const std::string& name) const {
  for (const ParameterSpec& sublist : lists_)
    if (sublist.name() == name)
      return &sublist;
  return !expert_.empty() && name == expertName ? &expert_.front() : nullptr;
}

std::vector<std::string> ParameterSpec::names() const {
  std::vector<std::string> result;
  for (const Parameter& parameter : parameters_)
    result.push_back(parameter.name);
  for (const ParameterSpec& sublist : lists_)
    result.push_back(sublist.name());
  for (const ParameterSpec& expert : expert_)
    result.push_back(expert.name());
  return result;
}

std::string ParameterSpec::expected(const Parameter& parameter) {
  switch (parameter.type) {
  case Type::Integer:
    return "an integer (type=\"int\") in " + parameter.range.text();
  case Type::Real:
    return "a real number (type=\"double\") in " + parameter.range.text();
  case Type::Boolean:
    return "a boolean (type=\"bool\"), true or false";
  case Type::Text:
    return "a string (type=\"string\")";
  case Type::Choice: {
    const std::vector<std::string> values = namesOf(parameter.allowed);
    return "one of " + joined(values) + " (type=\"string\")" +
           (parameter.mayBeInteger ? ", or an integer (type=\"int\") in " + parameter.range.text() : "");
  }
  case Type::Integers:
    return std::to_string(parameter.integers.size()) + " integers (type=\"Array(int)\") in " +
           parameter.range.text();
  case Type::Reals:
    return std::to_string(parameter.reals.size()) + " real numbers (type=\"Array(double)\") in " +
           parameter.range.text();
  case Type::Series:
    return "real numbers (type=\"Array(double)\") in " + parameter.range.text();
  case Type::Texts:
    return "strings (type=\"Array(string)\")";
  }
  return "";
}

std::string ParameterSpec::defaultText(const Parameter& parameter) {
  switch (parameter.type) {
  case Type::Integer:
    return std::to_string(parameter.integer);
  case Type::Real:
    return numberText(parameter.real);
  case Type::Boolean:
    return parameter.boolean ? "true" : "false";
  case Type::Text:
  case Type::Choice:
    return quoted(parameter.text);
  case Type::Integers:
    return arrayOf(parameter.integers).toString();
  case Type::Reals:
  case Type::Series:
    return arrayText(parameter.reals, numberText);
  case Type::Texts:
    return arrayOf(parameter.texts).toString();
  }
  return "";
}

void ParameterSpec::validate(const Parameter& parameter, const Teuchos::ParameterEntry& entry,
                             const std::string& path, Teuchos::ParameterList& result,
                             std::vector<std::string>& faults) {
  const std::string place = quoted(path + parameter.name);
  const auto wrongType = [&] {
    faults.push_back(place + " is " + foundText(entry) + ", expected " + expected(parameter));
  };
  const auto outOfRange = [&](const std::string& value) {
    faults.push_back(place + " = " + value + " is out of range, expected " + expected(parameter));
  };
  switch (parameter.type) {
  case Type::Integer: {
    if (!entry.isType<int>())
      return wrongType();
    const int value = Teuchos::getValue<int>(entry);
    if (!parameter.range.contains(value))
      return outOfRange(std::to_string(value));
    result.set(parameter.name, value);
    return;
  }
  case Type::Real: {
    if (!entry.isType<double>() && !entry.isType<int>())
      return wrongType();
    const double value =
        entry.isType<int>() ? Teuchos::getValue<int>(entry) : Teuchos::getValue<double>(entry);
    if (!parameter.range.contains(value))
      return outOfRange(numberText(value));
    result.set(parameter.name, value);
    return;
  }
  case Type::Boolean:
    if (!entry.isType<bool>())
      return wrongType();
    result.set(parameter.name, Teuchos::getValue<bool>(entry));
    return;
  case Type::Text:
    if (!entry.isType<std::string>())
      return wrongType();
    result.set(parameter.name, Teuchos::getValue<std::string>(entry));
    return;
  case Type::Choice: {
    const bool isInteger = parameter.mayBeInteger && entry.isType<int>();
    if (!isInteger && !entry.isType<std::string>())
      return wrongType();
    const std::string value =
        isInteger ? std::to_string(Teuchos::getValue<int>(entry)) : Teuchos::getValue<std::string>(entry);
    if (int number = 0; parameter.mayBeInteger && parseNumber(value, number)) {
      if (!parameter.range.contains(number))
        return outOfRange(value);
      result.set(parameter.name, std::to_string(number));
      return;
    }
    const std::vector<std::string> values = namesOf(parameter.allowed);
    if (std::find(values.begin(), values.end(), value) == values.end()) {
      const std::string nearest = nearestName(value, values);
      faults.push_back(place + " = " + quoted(value) + " is not allowed, expected " + expected(parameter) +
                       (nearest.empty() ? "" : "; did you mean " + quoted(nearest) + "?"));
      return;
    }
    result.set(parameter.name, value);
    return;
  }
  case Type::Integers: {
    if (!entry.isType<Teuchos::Array<int>>())
      return wrongType();
    const auto values = Teuchos::getValue<Teuchos::Array<int>>(entry);
    if (static_cast<std::size_t>(values.size()) != parameter.integers.size())
      return wrongType();
    for (int value : values)
      if (!parameter.range.contains(value))
        return outOfRange(std::to_string(value));
    result.set(parameter.name, values);
    return;
  }
  case Type::Reals:
  case Type::Series: {
    Teuchos::Array<double> values;
    if (entry.isType<Teuchos::Array<int>>()) {
      for (int value : Teuchos::getValue<Teuchos::Array<int>>(entry))
        values.push_back(value);
    } else if (entry.isType<Teuchos::Array<double>>()) {
      values = Teuchos::getValue<Teuchos::Array<double>>(entry);
    } else {
      return wrongType();
    }
    if (parameter.type == Type::Reals && static_cast<std::size_t>(values.size()) != parameter.reals.size())
      return wrongType();
    for (double value : values)
      if (!parameter.range.contains(value))
        return outOfRange(numberText(value));
    result.set(parameter.name, values);
    return;
  }
  case Type::Texts:
    if (!entry.isType<Teuchos::Array<std::string>>())
      return wrongType();
    result.set(parameter.name, Teuchos::getValue<Teuchos::Array<std::string>>(entry));
    return;
  }
}

void ParameterSpec::validateList(const Teuchos::ParameterList& given, const std::string& path,
                                 const std::string& name, Teuchos::ParameterList& result,
                                 Findings& findings) const {
  if (const ParameterSpec* sublist = findList(name); sublist != nullptr)
    sublist->validate(given, path + name + "/", result.sublist(name), findings);
  else if (!family_.empty()) {
    Teuchos::ParameterList& member = result.sublist(name);
    family_.front().fill(member, false);
    member.setName(name);
    family_.front().validate(given, path + name + "/", member, findings);
  } else if (find(name) != nullptr)
    findings.faults.push_back(quoted(path + name) + " is a list, expected " + expected(*find(name)));
  else
    findings.faults.push_back(unknownName("list", path, name, names()));
}

void ParameterSpec::validateValue(const Teuchos::ParameterEntry& entry, const std::string& path,
                                  const std::string& name, Teuchos::ParameterList& result,
                                  Findings& findings) const {
  if (const Parameter* parameter = find(name); parameter != nullptr)
    validate(*parameter, entry, path, result, findings.faults);
  else if (findList(name) != nullptr)
    findings.faults.push_back(quoted(path + name) + " is a single value, expected a ParameterList");
  else
    findings.faults.push_back(unknownParameter(path, name));
}

void ParameterSpec::validate(const Teuchos::ParameterList& given, const std::string& path,
                             Teuchos::ParameterList& result, Findings& findings) const {
  if (isForeign_)
    result.setParameters(given);
  for (auto item = given.begin(); !isForeign_ && item != given.end(); ++item) {
    const std::string& name = given.name(item);
    const Teuchos::ParameterEntry& entry = given.entry(item);
    const ParameterSpec* expert = expertOf(name);
    if (expert != nullptr) {
      findings.notes.push_back(moved(path, name));
      if (given.isSublist(expertName))
        findContradictions(entry, given.sublist(expertName), path, name, findings.faults);
    }
    if (const Parameter* present = findFormer(name); present != nullptr && !entry.isList()) {
      findings.notes.push_back(renamed(path, *present));
      if (const auto* other = given.getEntryPtr(present->name); other != nullptr && *other != entry)
        findings.faults.push_back(quoted(path + name) + " and " + quoted(path + present->name) +
                                  ", its present name, have different values; keep the second");
      validate(*present, entry, path, result, findings.faults);
      continue;
    }
    const ParameterSpec& owner = expert != nullptr ? *expert : *this;
    Teuchos::ParameterList& place = expert != nullptr ? result.sublist(expertName) : result;
    if (entry.isList())
      owner.validateList(given.sublist(name), path, name, place, findings);
    else
      owner.validateValue(entry, path, name, place, findings);
  }
}

Teuchos::ParameterList ParameterSpec::validated(const Teuchos::ParameterList& given,
                                                const std::string& source,
                                                std::vector<std::string>* notes) const {
  Teuchos::ParameterList result = defaults();
  Findings findings;
  validate(given, "", result, findings);
  if (const std::vector<std::string>& faults = findings.faults; !faults.empty()) {
    std::string message = source + ": ";
    if (faults.size() > 1)
      message += std::to_string(faults.size()) + " faults:";
    for (const std::string& fault : faults)
      message += (faults.size() > 1 ? "\n  " : "") + fault;
    throw InputError(message, {{"source", source}, {"faults", std::to_string(faults.size())}});
  }
  if (notes != nullptr)
    notes->insert(notes->end(), findings.notes.begin(), findings.notes.end());
  return result;
}

void ParameterSpec::setDefault(const Parameter& parameter, Teuchos::ParameterList& list, bool validators) {
  Teuchos::RCP<const Teuchos::ParameterEntryValidator> validator;
  if (validators && parameter.type == Type::Integer) {
    validator = Teuchos::rcp(new Teuchos::EnhancedNumberValidator<int>(
        static_cast<int>(parameter.range.least), static_cast<int>(parameter.range.most)));
  } else if (validators && parameter.type == Type::Real) {
    // Teuchos knows closed ranges only: an excluded end moves by one representable number.
    double least = parameter.range.least;
    double most = parameter.range.most;
    if (parameter.range.leastExcluded)
      least = std::nextafter(least, most);
    if (parameter.range.mostExcluded)
      most = std::nextafter(most, least);
    const double largest = std::numeric_limits<double>::max();
    validator = Teuchos::rcp(
        new Teuchos::EnhancedNumberValidator<double>(std::max(least, -largest), std::min(most, largest)));
  } else if (validators && parameter.type == Type::Choice && !parameter.mayBeInteger) {
    validator = Teuchos::rcp(new Teuchos::StringValidator(namesOf(parameter.allowed)));
  }
  const std::string doc = validators ? parameter.meaning : std::string();
  switch (parameter.type) {
  case Type::Integer:
    list.set(parameter.name, parameter.integer, doc, validator);
    return;
  case Type::Real:
    list.set(parameter.name, parameter.real, doc, validator);
    return;
  case Type::Boolean:
    list.set(parameter.name, parameter.boolean, doc);
    return;
  case Type::Text:
  case Type::Choice:
    list.set(parameter.name, parameter.text, doc, validator);
    return;
  case Type::Integers:
    list.set(parameter.name, arrayOf(parameter.integers), doc);
    return;
  case Type::Reals:
  case Type::Series:
    list.set(parameter.name, arrayOf(parameter.reals), doc);
    return;
  case Type::Texts:
    list.set(parameter.name, arrayOf(parameter.texts), doc);
    return;
  }
}

void ParameterSpec::fill(Teuchos::ParameterList& list, bool validators) const {
  list.setName(name_);
  for (const Parameter& parameter : parameters_)
    setDefault(parameter, list, validators);
  for (const ParameterSpec& sublist : lists_)
    sublist.fill(list.sublist(sublist.name(), false, sublist.meaning()), validators);
  for (const ParameterSpec& expert : expert_)
    expert.fill(list.sublist(expert.name(), false, expert.meaning()), validators);
}

Teuchos::ParameterList ParameterSpec::defaults() const {
  Teuchos::ParameterList list;
  fill(list, false);
  return list;
}

Teuchos::RCP<Teuchos::ParameterList> ParameterSpec::teuchosList() const {
  Teuchos::RCP<Teuchos::ParameterList> list = Teuchos::parameterList(name_);
  fill(*list, true);
  return list;
}

} // namespace Harmos
