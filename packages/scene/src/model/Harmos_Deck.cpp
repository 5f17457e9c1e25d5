// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Deck.hpp"

#include "Harmos_Agreement.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_StringInputSource.hpp>
#include <Teuchos_XMLParameterListCoreHelpers.hpp>
#include <Teuchos_XMLParameterListReader.hpp>
#include <Teuchos_YamlParameterListCoreHelpers.hpp>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

namespace Harmos::scene {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// What helps of Teuchos' messages, which also tell file, line and failed condition of its own sources.
std::string reasonOf(const std::string& message) {
  std::istringstream lines(message);
  std::string line, reason, last;
  while (std::getline(lines, line)) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos)
      continue;
    last = line.substr(begin);
    for (const char* sign : {"error", "failure", "Expected", "Got:"})
      if (last.find(sign) != std::string::npos) {
        reason += (reason.empty() ? "" : "; ") + last;
        break;
      }
  }
  return reason.empty() ? last : reason;
}

bool isValueOf(const std::string& type, const std::string& text);

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks), end = text.find_last_not_of(blanks);
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

// "{1, 2}" of values of the type.
bool isArrayOf(const std::string& type, const std::string& text) {
  const std::string whole = trimmed(text);
  if (whole.size() < 2 || whole.front() != '{' || whole.back() != '}')
    return false;
  const std::string inner = whole.substr(1, whole.size() - 2);
  if (trimmed(inner).empty())
    return true;
  std::istringstream items(inner + ",");
  for (std::string item; std::getline(items, item, ',');)
    // "inf" and "nan": in an array Teuchos reads them as 0, too.
    if (!isValueOf(type, trimmed(item)) || item.find_first_of("nN") != std::string::npos)
      return false;
  return true;
}

// Whether the whole text is a value of the type; Teuchos reads as much as it understands and drops the rest.
bool isValueOf(const std::string& type, const std::string& text) {
  if (type == "int" || type == "double") {
    errno = 0;
    char* end = nullptr;
    if (type == "double") {
      std::strtod(text.c_str(), &end);
    } else {
      const long value = std::strtol(text.c_str(), &end, 10);
      if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
        return false;
    }
    const bool overflow = errno == ERANGE && type == "int";
    return !text.empty() && end == text.c_str() + text.size() && !overflow;
  }
  if (type == "Array(int)" || type == "Array(double)")
    return isArrayOf(type.substr(6, type.size() - 7), text);
  if (type == "bool")
    return text == "true" || text == "false";
  return true;
}

// Faults that Teuchos' reader lets pass: values that are not of their type, names that stand twice in a list.
void checkValues(const Teuchos::XMLObject& list, const std::string& path) {
  std::set<std::string> names;
  for (int k = 0; k < list.numChildren(); ++k) {
    const Teuchos::XMLObject& child = list.getChild(k);
    if (!child.hasAttribute("name"))
      continue;
    const std::string name = child.getRequired("name");
    const std::string place = "\"" + path + name + "\"";
    if (!names.insert(name).second)
      throw InputError(place + " is given twice; remove one of them");
    if (child.getTag() == "ParameterList") {
      checkValues(child, path + name + "/");
    } else if (child.hasAttribute("type") && child.hasAttribute("value")) {
      const std::string type = child.getRequired("type"), value = child.getRequired("value");
      if (!isValueOf(type, value))
        throw InputError(place + " has the type \"" + type + "\", but \"" + value +
                         "\" is not a valid value of that type" +
                         (type == "bool"                ? " (true or false)"
                          : type.rfind("Array", 0) == 0 ? " (finite numbers in braces, separated by commas)"
                                                        : ""));
    }
  }
}

Teuchos::ParameterList parse(const std::string& file) {
  if (std::filesystem::is_directory(file))
    throw InputError("the deck \"" + file + "\" is a directory; name an XML or YAML file", {{"file", file}});
  std::ifstream stream(file);
  if (!stream)
    throw InputError("the deck \"" + file + "\" cannot be read: " + std::strerror(errno) +
                         "; check the path, which is relative to the working directory",
                     {{"file", file}});
  std::ostringstream text;
  text << stream.rdbuf();
  Teuchos::ParameterList list;
  try {
    if (endsWith(file, ".yaml") || endsWith(file, ".yml")) {
      list = *Teuchos::getParametersFromYamlString(text.str());
    } else {
      const Teuchos::XMLObject xml = Teuchos::StringInputSource(text.str()).getObject();
      checkValues(xml, "");
      list = Teuchos::XMLParameterListReader().toParameterList(xml);
    }
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what(), {{"file", file}});
  } catch (const std::exception& error) {
    throw InputError("the deck \"" + file +
                         "\" is not a well-formed ParameterList: " + reasonOf(error.what()),
                     {{"file", file}});
  }
  return list;
}

std::string differenceBelow(const Teuchos::ParameterList& one, const Teuchos::ParameterList& other,
                            const std::vector<std::string>& ignored, const std::string& place) {
  const auto textOf = [](const Teuchos::ParameterList& list, const std::string& name) -> std::string {
    if (!list.isParameter(name))
      return "absent";
    return list.isSublist(name) ? "a list" : Teuchos::toString(list.getEntry(name).getAny(false));
  };
  for (const auto& entry : one) {
    const std::string& name = entry.first;
    const std::string path = place + name;
    if (std::find(ignored.begin(), ignored.end(), path) != ignored.end())
      continue;
    std::string found;
    if (entry.second.isList() && other.isSublist(name))
      found = differenceBelow(one.sublist(name), other.sublist(name), ignored, path + "/");
    else if (entry.second.isList() || !other.isParameter(name) || other.isSublist(name) ||
             !(entry.second.getAny(false) == other.getEntry(name).getAny(false)))
      found = "\"" + path + "\" was " + textOf(one, name) + ", is " + textOf(other, name);
    if (!found.empty())
      return found;
  }
  for (const auto& entry : other)
    if (!one.isParameter(entry.first))
      return "\"" + place + entry.first + "\" was absent, is " + textOf(other, entry.first);
  return "";
}

} // namespace

std::string firstDifference(const Teuchos::ParameterList& one, const Teuchos::ParameterList& other,
                            const std::vector<std::string>& ignored) {
  return differenceBelow(one, other, ignored, "");
}

Teuchos::ParameterList readDeck(const Teuchos::Comm<int>& comm, const std::string& file,
                                const std::vector<std::string>& assignments, const ParameterSpec& spec,
                                std::vector<std::string>* notes) {
  std::string text;
  agree(comm, [&] {
    if (comm.getRank() != 0)
      return;
    Teuchos::ParameterList list = parse(file);
    std::string source = file;
    for (const std::string& assignment : assignments) {
      const std::size_t sign = assignment.find('=');
      if (sign == std::string::npos || sign == 0)
        throw InputError("--set \"" + assignment + "\" is not of the form \"List/Name=value\"");
      spec.set(list, assignment.substr(0, sign), assignment.substr(sign + 1), "--set", notes);
    }
    if (!assignments.empty())
      source += " with --set";
    std::ostringstream stream;
    Teuchos::writeParameterListToXmlOStream(spec.validated(list, source, notes), stream);
    text = stream.str();
  });
  int size = static_cast<int>(text.size());
  Teuchos::broadcast<int, int>(comm, 0, 1, &size);
  text.resize(static_cast<std::size_t>(size));
  Teuchos::broadcast<int, char>(comm, 0, size, text.data());
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(text, Teuchos::ptr(&list));
  return list;
}

} // namespace Harmos::scene
