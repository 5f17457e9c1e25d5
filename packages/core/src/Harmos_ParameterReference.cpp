// SPDX-License-Identifier: BSD-3-Clause

/// The part of ParameterSpec that writes the reference of parameters.

#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <cstdlib>
#include <ostream>

namespace Harmos {
namespace {

std::string inQuotes(const std::string& text) {
  return "\"" + text + "\"";
}

// Markdown takes <...> for HTML, which it does not show.
std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text)
    result += (c == '<' ? "\\" : "") + std::string(1, c);
  return result;
}

constexpr const char* orInteger = " or integer";

} // namespace

bool ParameterSpec::hasRange(Type type) {
  return type == Type::Integer || type == Type::Real || type == Type::Integers || type == Type::Reals ||
         type == Type::Series;
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
  case Type::Integers:
    return "integers";
  case Type::Reals:
    return "reals";
  case Type::Series:
    return "reals, any number of them";
  case Type::Texts:
    return "strings";
  }
  return "";
}

void ParameterSpec::writeXml(std::ostream& out) const {
  Teuchos::writeParameterListToXmlOStream(*teuchosList(), out);
}

void ParameterSpec::writeMarkdown(std::ostream& out, const std::string& path) const {
  out << (path == name_ ? "# Parameters of " : "## ") << escaped(path) << "\n\n" << meaning_ << "\n\n";
  if (!parameters_.empty()) {
    out << "| Parameter | Type | Default | Allowed | Meaning |\n|---|---|---|---|---|\n";
    for (const Parameter& parameter : parameters_) {
      std::string allowed;
      if (hasRange(parameter.type))
        allowed = parameter.range.text();
      else if (parameter.type == Type::Boolean)
        allowed = "`true`, `false`";
      else if (parameter.type == Type::Text || parameter.type == Type::Texts)
        allowed = "any";
      for (const Choice& choice : parameter.allowed)
        allowed += (allowed.empty() ? "" : "; ") + ("`" + choice.first + "`: " + choice.second);
      if (parameter.mayBeInteger)
        allowed += "; an integer in " + parameter.range.text();
      out << "| `" << parameter.name << "` | " << typeName(parameter.type)
          << (parameter.mayBeInteger ? orInteger : "") << " | `" << defaultText(parameter) << "` | "
          << allowed << " | " << parameter.meaning << " |\n";
    }
    out << "\n";
  }
  for (const ParameterSpec& sublist : lists_)
    sublist.writeMarkdown(out, path + "/" + sublist.name());
  for (const ParameterSpec& member : family_)
    member.writeMarkdown(out, path + "/" + member.name());
}

void ParameterSpec::writeMarkdown(std::ostream& out) const {
  writeMarkdown(out, name_);
}

void ParameterSpec::writeText(std::ostream& out, const std::string& path) const {
  out << path << "  -- " << meaning_ << "\n";
  for (const Parameter& parameter : parameters_) {
    out << "  " << parameter.name << " = " << defaultText(parameter) << "   [" << typeName(parameter.type)
        << (parameter.mayBeInteger ? orInteger : "");
    if (hasRange(parameter.type) || parameter.mayBeInteger)
      out << " in " << parameter.range.text();
    out << "]\n      " << parameter.meaning << "\n";
    for (const Choice& choice : parameter.allowed)
      out << "      " << inQuotes(choice.first) << ": " << choice.second << "\n";
  }
  out << "\n";
  for (const ParameterSpec& sublist : lists_)
    sublist.writeText(out, (path.empty() ? "" : path + "/") + sublist.name());
  for (const ParameterSpec& member : family_)
    member.writeText(out, path + "/" + member.name());
}

void ParameterSpec::writeText(std::ostream& out) const {
  out << meaning_ << "\n\n";
  for (const Parameter& parameter : parameters_)
    out << "  " << parameter.name << " = " << defaultText(parameter) << "   " << parameter.meaning << "\n";
  for (const ParameterSpec& sublist : lists_)
    sublist.writeText(out, sublist.name());
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
