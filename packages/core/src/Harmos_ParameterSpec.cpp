// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ParameterSpec.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_StandardParameterEntryValidators.hpp>
#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <ostream>
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

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

std::string joined(const std::vector<std::string>& texts) {
  std::string result;
  for (const std::string& text : texts)
    result += (result.empty() ? "" : ", ") + quoted(text);
  return result;
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

std::string unknownName(const std::string& what, const std::string& path, const std::string& name,
                        const std::vector<std::string>& candidates) {
  std::string message = "unknown " + what + " " + quoted(path + name);
  const std::string nearest = nearestName(name, candidates);
  if (!nearest.empty())
    message += "; did you mean " + quoted(nearest) + "?";
  message += candidates.empty() ? " Nothing is allowed here." : " Allowed here: " + joined(candidates) + ".";
  return message;
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
  return "of type " + entry.getAny(false).typeName();
}

} // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  // Further away than half of its letters, a name is no longer a misspelling.
  std::size_t best = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = editDistance(lowered(name), lowered(candidate));
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  // Or its beginning: "Tol" for "Tolerance".
  if (nearest.empty() && name.size() >= 3)
    for (const std::string& candidate : candidates)
      if (lowered(candidate).compare(0, name.size(), lowered(name)) == 0)
        return candidate;
  return nearest;
}

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
  return nullptr;
}

std::vector<std::string> ParameterSpec::names() const {
  std::vector<std::string> result;
  for (const Parameter& parameter : parameters_)
    result.push_back(parameter.name);
  for (const ParameterSpec& sublist : lists_)
    result.push_back(sublist.name());
  return result;
}

std::string ParameterSpec::typeName(Type type) {
  switch (type) {
  case Type::Integer:
    return "integer";
  case Type::Real:
    return "real";
  case Type::Boolean:
    return "boolean";
  case Type::Text:
    return "string";
  case Type::Choice:
    return "choice";
  }
  return "";
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
    std::vector<std::string> values;
    for (const Choice& allowed : parameter.allowed)
      values.push_back(allowed.first);
    return "one of " + joined(values) + " (type=\"string\")";
  }
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
    if (!entry.isType<std::string>())
      return wrongType();
    const std::string value = Teuchos::getValue<std::string>(entry);
    std::vector<std::string> values;
    for (const Choice& allowed : parameter.allowed)
      values.push_back(allowed.first);
    if (std::find(values.begin(), values.end(), value) == values.end()) {
      const std::string nearest = nearestName(value, values);
      faults.push_back(place + " = " + quoted(value) + " is not allowed, expected " + expected(parameter) +
                       (nearest.empty() ? "" : "; did you mean " + quoted(nearest) + "?"));
      return;
    }
    result.set(parameter.name, value);
    return;
  }
  }
}

void ParameterSpec::validate(const Teuchos::ParameterList& given, const std::string& path,
                             Teuchos::ParameterList& result, std::vector<std::string>& faults) const {
  for (auto item = given.begin(); item != given.end(); ++item) {
    const std::string& name = given.name(item);
    const Teuchos::ParameterEntry& entry = given.entry(item);
    if (entry.isList()) {
      const ParameterSpec* sublist = findList(name);
      if (sublist != nullptr)
        sublist->validate(given.sublist(name), path + name + "/", result.sublist(name), faults);
      else if (find(name) != nullptr)
        faults.push_back(quoted(path + name) + " is a list, expected " + expected(*find(name)));
      else
        faults.push_back(unknownName("list", path, name, names()));
    } else {
      const Parameter* parameter = find(name);
      if (parameter != nullptr)
        validate(*parameter, entry, path, result, faults);
      else if (findList(name) != nullptr)
        faults.push_back(quoted(path + name) + " is a single value, expected a ParameterList");
      else
        faults.push_back(unknownName("parameter", path, name, names()));
    }
  }
}

Teuchos::ParameterList ParameterSpec::validated(const Teuchos::ParameterList& given,
                                                const std::string& source) const {
  Teuchos::ParameterList result = defaults();
  std::vector<std::string> faults;
  validate(given, "", result, faults);
  if (!faults.empty()) {
    std::string message = source + ": ";
    if (faults.size() > 1)
      message += std::to_string(faults.size()) + " faults:";
    for (const std::string& fault : faults)
      message += (faults.size() > 1 ? "\n  " : "") + fault;
    throw InputError(message, {{"source", source}, {"faults", std::to_string(faults.size())}});
  }
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
  } else if (validators && parameter.type == Type::Choice) {
    Teuchos::Array<std::string> values;
    for (const Choice& allowed : parameter.allowed)
      values.push_back(allowed.first);
    validator = Teuchos::rcp(new Teuchos::StringValidator(values));
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
  }
}

void ParameterSpec::fill(Teuchos::ParameterList& list, bool validators) const {
  list.setName(name_);
  for (const Parameter& parameter : parameters_)
    setDefault(parameter, list, validators);
  for (const ParameterSpec& sublist : lists_)
    sublist.fill(list.sublist(sublist.name(), false, sublist.meaning()), validators);
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

void ParameterSpec::set(Teuchos::ParameterList& list, const std::string& path, const std::string& value,
                        const std::string& source) const {
  set(list, "", path, value, source);
}

// The head is the path of this list in the deck, with its slash.
void ParameterSpec::set(Teuchos::ParameterList& list, const std::string& head, const std::string& path,
                        const std::string& value, const std::string& source) const {
  const std::size_t slash = path.find('/');
  if (slash != std::string::npos) {
    const std::string first = path.substr(0, slash);
    const ParameterSpec* sublist = findList(first);
    if (sublist == nullptr) {
      std::vector<std::string> known;
      for (const ParameterSpec& candidate : lists_)
        known.push_back(candidate.name());
      throw InputError(source + ": " + unknownName("list", head, first, known), {{"path", head + path}});
    }
    sublist->set(list.sublist(first), head + first + "/", path.substr(slash + 1), value, source);
    return;
  }
  const Parameter* parameter = find(path);
  if (parameter == nullptr)
    throw InputError(source + ": " + unknownName("parameter", head, path, names()), {{"path", head + path}});
  const auto refuse = [&] {
    throw InputError(source + ": " + quoted(value) + " cannot be the value of " + quoted(head + path) +
                         ", expected " + expected(*parameter),
                     {{"path", head + path}});
  };
  std::istringstream text(value);
  switch (parameter->type) {
  case Type::Integer: {
    int number = 0;
    if (!(text >> number) || !(text >> std::ws).eof())
      refuse();
    list.set(path, number);
    return;
  }
  case Type::Real: {
    double number = 0.0;
    if (!(text >> number) || !(text >> std::ws).eof())
      refuse();
    list.set(path, number);
    return;
  }
  case Type::Boolean:
    if (value != "true" && value != "false")
      refuse();
    list.set(path, value == "true");
    return;
  case Type::Text:
  case Type::Choice:
    list.set(path, value);
    return;
  }
}

void ParameterSpec::writeXml(std::ostream& out) const {
  Teuchos::writeParameterListToXmlOStream(*teuchosList(), out);
}

void ParameterSpec::writeMarkdown(std::ostream& out, const std::string& path) const {
  out << (path == name_ ? "# Parameters of " : "## ") << path << "\n\n" << meaning_ << "\n\n";
  if (!parameters_.empty()) {
    out << "| Parameter | Type | Default | Allowed | Meaning |\n|---|---|---|---|---|\n";
    for (const Parameter& parameter : parameters_) {
      std::string allowed;
      if (parameter.type == Type::Integer || parameter.type == Type::Real)
        allowed = parameter.range.text();
      for (const Choice& choice : parameter.allowed)
        allowed += (allowed.empty() ? "" : "; ") + ("`" + choice.first + "`: " + choice.second);
      out << "| `" << parameter.name << "` | " << typeName(parameter.type) << " | `" << defaultText(parameter)
          << "` | " << allowed << " | " << parameter.meaning << " |\n";
    }
    out << "\n";
  }
  for (const ParameterSpec& sublist : lists_)
    sublist.writeMarkdown(out, path + "/" + sublist.name());
}

void ParameterSpec::writeMarkdown(std::ostream& out) const {
  writeMarkdown(out, name_);
}

void ParameterSpec::writeText(std::ostream& out, const std::string& path) const {
  out << path << "  -- " << meaning_ << "\n";
  for (const Parameter& parameter : parameters_) {
    out << "  " << parameter.name << " = " << defaultText(parameter) << "   [" << typeName(parameter.type);
    if (parameter.type == Type::Integer || parameter.type == Type::Real)
      out << " in " << parameter.range.text();
    out << "]\n      " << parameter.meaning << "\n";
    for (const Choice& choice : parameter.allowed)
      out << "      " << quoted(choice.first) << ": " << choice.second << "\n";
  }
  out << "\n";
  for (const ParameterSpec& sublist : lists_)
    sublist.writeText(out, (path.empty() ? "" : path + "/") + sublist.name());
}

void ParameterSpec::writeText(std::ostream& out) const {
  out << meaning_ << "\n\n";
  for (const Parameter& parameter : parameters_)
    out << "  " << parameter.name << " = " << defaultText(parameter) << "   " << parameter.meaning << "\n";
  for (const ParameterSpec& sublist : lists_)
    sublist.writeText(out, sublist.name());
}

} // namespace Harmos
