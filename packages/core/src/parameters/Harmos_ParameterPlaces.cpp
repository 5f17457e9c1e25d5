// SPDX-License-Identifier: BSD-3-Clause

/// The part of ParameterSpec that finds the place of a name: assignments by path, and the sublists "Expert".

#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_ParameterText.hpp"

#include <algorithm>
#include <cstdlib>

namespace Harmos {
namespace {

// "{1, 2}" or "1, 2".
std::vector<std::string> splitArray(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '{' || c == '}'; }),
             text.end());
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    const std::size_t first = item.find_first_not_of(" \t"), last = item.find_last_not_of(" \t");
    result.push_back(first == std::string::npos ? "" : item.substr(first, last - first + 1));
  }
  return result;
}

void removeAt(Teuchos::ParameterList& list, const std::string& path) {
  const std::size_t slash = path.find('/');
  const std::string first = path.substr(0, slash);
  if (slash == std::string::npos)
    list.remove(first, false);
  else if (list.isSublist(first))
    removeAt(list.sublist(first), path.substr(slash + 1));
}

} // namespace

ParameterSpec& ParameterSpec::expert() {
  if (expert_.empty()) {
    HARMOS_REQUIRE(family_.empty(), "the list " + quoted(name()) + " has a family, and no expert parameters");
    expert_.emplace_back(expertName, "Parameters that are rarely set.");
  }
  return expert_.front();
}

const ParameterSpec* ParameterSpec::expertOf(const std::string& name) const {
  if (expert_.empty() || find(name) != nullptr || findList(name) != nullptr)
    return nullptr;
  const ParameterSpec& expert = expert_.front();
  return expert.find(name) != nullptr || expert.findList(name) != nullptr ? &expert : nullptr;
}

const ParameterSpec::Parameter* ParameterSpec::findFormer(const std::string& name) const {
  for (const Parameter& parameter : parameters_)
    if (!parameter.former.empty() && parameter.former == name)
      return &parameter;
  return nullptr;
}

std::string ParameterSpec::renamed(const std::string& path, const Parameter& parameter) {
  return quoted(path + parameter.former) + " is now " + quoted(path + parameter.name) +
         "; this version still reads the old name";
}

std::string ParameterSpec::moved(const std::string& path, const std::string& name) {
  return quoted(path + name) + " is now " + quoted(path + expertName + "/" + name) +
         "; this version still reads the old place";
}

std::string ParameterSpec::unknownName(const std::string& what, const std::string& path,
                                       const std::string& name,
                                       const std::vector<std::string>& candidates) const {
  std::string message = "unknown " + what + " " + quoted(path + name);
  std::vector<std::string> known = candidates;
  for (const ParameterSpec& expert : expert_)
    for (const std::string& rare : expert.names())
      known.push_back(rare);
  const std::string nearest = nearestName(name, known);
  const bool isPublic = std::find(candidates.begin(), candidates.end(), nearest) != candidates.end();
  if (!nearest.empty())
    message += "; did you mean " + quoted((isPublic ? "" : std::string(expertName) + "/") + nearest) + "?";
  std::string allowed;
  for (const std::string& candidate : candidates)
    allowed += (allowed.empty() ? "" : ", ") + quoted(candidate);
  return message + (allowed.empty() ? " Nothing is allowed here." : " Allowed here: " + allowed + ".");
}

std::string ParameterSpec::unknownParameter(const std::string& path, const std::string& name) const {
  for (const auto& [absent, why] : absent_)
    if (absent == name)
      return "unknown parameter " + quoted(path + name) + ": " + why;
  return unknownName("parameter", path, name, names());
}

Teuchos::ParameterList ParameterSpec::commonPart(const Teuchos::ParameterList& other) const {
  if (isForeign_)
    return other;
  Teuchos::ParameterList result;
  for (auto item = other.begin(); item != other.end(); ++item) {
    const std::string& name = other.name(item);
    const ParameterSpec* sublist = findList(name);
    if (sublist == nullptr && !family_.empty())
      sublist = &family_.front();
    if (!other.entry(item).isList()) {
      if (find(name) != nullptr)
        result.setEntry(name, other.entry(item));
    } else if (sublist != nullptr) {
      result.sublist(name) = sublist->commonPart(other.sublist(name));
    }
  }
  return result;
}

void ParameterSpec::set(Teuchos::ParameterList& list, const std::string& path, const std::string& value,
                        const std::string& source, std::vector<std::string>* notes) const {
  Findings findings;
  set(list, "", path, value, source, findings);
  if (notes != nullptr)
    notes->insert(notes->end(), findings.notes.begin(), findings.notes.end());
}

// The head is the path of this list in the deck, with its slash.
void ParameterSpec::set(Teuchos::ParameterList& list, const std::string& head, const std::string& path,
                        const std::string& value, const std::string& source, Findings& findings) const {
  if (isForeign_)
    return setForeign(list, path, value);
  const std::size_t slash = path.find('/');
  const std::string first = path.substr(0, slash);
  if (const ParameterSpec* expert = expertOf(first); expert != nullptr) {
    findings.notes.push_back(moved(head, path));
    expert->set(list.sublist(expertName), head, path, value, source, findings);
    return removeAt(list, path);
  }
  if (slash == std::string::npos) {
    const Parameter* parameter = find(path);
    if (parameter == nullptr && (parameter = findFormer(path)) != nullptr)
      findings.notes.push_back(renamed(head, *parameter));
    if (parameter == nullptr)
      throw InputError(source + ": " + unknownParameter(head, path), {{"path", head + path}});
    if (!parameter->former.empty())
      list.remove(parameter->former, false);
    return set(*parameter, list, value, head + path, source);
  }
  const ParameterSpec* sublist = findList(first);
  if (sublist == nullptr && !family_.empty())
    sublist = &family_.front(); // a member that the deck does not have yet is made
  if (sublist == nullptr) {
    std::vector<std::string> known;
    for (const std::string& candidate : names())
      if (find(candidate) == nullptr)
        known.push_back(candidate);
    throw InputError(source + ": " + unknownName("list", head, first, known), {{"path", head + path}});
  }
  const std::string rest = path.substr(slash + 1);
  sublist->set(list.sublist(first), head + first + "/", rest, value, source, findings);
  if (!expert_.empty() && first == expertName)
    removeAt(list, rest);
}

void ParameterSpec::set(const Parameter& parameter, Teuchos::ParameterList& list, const std::string& value,
                        const std::string& place, const std::string& source) {
  const auto refuse = [&] {
    throw InputError(source + ": " + quoted(value) + " is not a valid value of " + quoted(place) +
                         ", expected " + expected(parameter),
                     {{"path", place}});
  };
  switch (parameter.type) {
  case Type::Integer: {
    int number = 0;
    if (!parseNumber(value, number))
      refuse();
    list.set(parameter.name, number);
    return;
  }
  case Type::Real: {
    double number = 0.0;
    if (!parseNumber(value, number))
      refuse();
    list.set(parameter.name, number);
    return;
  }
  case Type::Integers: {
    Teuchos::Array<int> numbers;
    for (const std::string& item : splitArray(value)) {
      numbers.push_back(0);
      if (!parseNumber(item, numbers.back()))
        refuse();
    }
    list.set(parameter.name, numbers);
    return;
  }
  case Type::Reals:
  case Type::Series: {
    Teuchos::Array<double> numbers;
    for (const std::string& item : splitArray(value)) {
      numbers.push_back(0.0);
      if (!parseNumber(item, numbers.back()))
        refuse();
    }
    list.set(parameter.name, numbers);
    return;
  }
  case Type::Texts:
    list.set(parameter.name, Teuchos::Array<std::string>(splitArray(value)));
    return;
  case Type::Boolean:
    if (value != "true" && value != "false")
      refuse();
    list.set(parameter.name, value == "true");
    return;
  case Type::Text:
  case Type::Choice:
    list.set(parameter.name, value);
    return;
  }
}

void ParameterSpec::setForeign(Teuchos::ParameterList& list, const std::string& path,
                               const std::string& value) {
  if (const std::size_t slash = path.find('/'); slash != std::string::npos)
    return setForeign(list.sublist(path.substr(0, slash)), path.substr(slash + 1), value);
  const char* const begin = value.c_str();
  char* end = nullptr;
  if (value == "true" || value == "false")
    list.set(path, value == "true");
  else if (const long whole = std::strtol(begin, &end, 10); end != begin && *end == '\0')
    list.set(path, static_cast<int>(whole));
  else if (const double number = std::strtod(begin, &end); end != begin && *end == '\0')
    list.set(path, number);
  else
    list.set(path, value);
}

} // namespace Harmos
