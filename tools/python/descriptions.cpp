// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/descriptions.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace adit::python {
namespace {

namespace py = pybind11;

constexpr const char* kSignatureEnd = "\n--\n\n";  // by which Python knows it

/// The places of `letter` outside of brackets and quotes.
std::vector<std::size_t> outer_places(std::string_view text, char letter) {
  std::vector<std::size_t> places;
  int depth = 0;
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      i += c == '\\' ? 1 : 0;
      quote = c == quote ? '\0' : quote;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == letter && depth == 0) {
      places.push_back(i);
    } else if (std::strchr("([{<", c) != nullptr) {
      ++depth;
    } else if (std::strchr(")]}", c) != nullptr || (c == '>' && text[i - 1] != '-')) {
      --depth;
    }
  }
  return places;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  while (!text.empty() && text.back() == ' ') {
    text.remove_suffix(1);
  }
  return text;
}

bool is_literal(const std::string& text) {
  try {
    py::module_::import("ast").attr("literal_eval")(text);
    return true;
  } catch (const py::error_already_set&) {
    return false;
  }
}

/// "name" or "name=default" of "name: type = default".
std::string parameter_of(std::string_view text) {
  const auto equals = outer_places(text, '=');
  const auto colons = outer_places(text, ':');
  const std::size_t end = equals.empty() ? text.size() : equals.front();
  std::string parameter(trimmed(text.substr(0, colons.empty() ? end : colons.front())));
  if (!equals.empty()) {
    const std::string usual(trimmed(text.substr(end + 1)));
    parameter += "=" + (is_literal(usual) ? usual : "...");
  }
  return parameter;
}

/// The lines "name(...) -> type" of what pybind11 writes above a docstring; of overloads numbered.
std::vector<std::string> signature_lines(const std::string& name, const std::string& doc) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < doc.size()) {
    const std::size_t end = std::min(doc.find('\n', begin), doc.size());
    std::string line = doc.substr(begin, end - begin);
    std::size_t number = 0;
    while (number < line.size() && std::isdigit(static_cast<unsigned char>(line[number])) != 0) {
      ++number;
    }
    if (number > 0 && line.compare(number, 2, ". ") == 0) {
      line.erase(0, number + 2);
    }
    if (line.starts_with(name + "(") && line.find(") -> ") != std::string::npos) {
      lines.push_back(std::move(line));
    }
    begin = end + 1;
  }
  return lines;
}

/// That of the overload with the most parameters; empty where pybind11 has written none.
std::string signature_of(const std::string& name, const std::string& doc) {
  std::string most;
  std::size_t most_parameters = 0;
  for (const std::string& line : signature_lines(name, doc)) {
    const std::string signature = text_signature(line);
    const std::size_t parameters = 1 + outer_places(signature.substr(1), ',').size();
    if (most.empty() || parameters > most_parameters) {
      most = signature;
      most_parameters = parameters;
    }
  }
  return most;
}

/// Python reads a signature out of the text that a function was made with, and hides it from
/// __doc__. Returns it; empty: there is none.
std::string describe_function(const py::handle& object) {
  const py::object function = py::getattr(object, "__func__", object);  // of methods
  if (!PyCFunction_Check(function.ptr())) {
    return {};
  }
  PyMethodDef* made = reinterpret_cast<PyCFunctionObject*>(function.ptr())->m_ml;
  if (made->ml_doc == nullptr || made->ml_name == nullptr) {
    return {};
  }
  const std::string name = made->ml_name;
  const std::string doc = made->ml_doc;
  std::string signature = signature_of(name, doc);
  if (!signature.empty()) {
    const std::string whole = name + signature + kSignatureEnd + doc;
    std::free(const_cast<char*>(made->ml_doc));  // as pybind11 has made it, and frees this one
    made->ml_doc = strdup(whole.c_str());
  }
  return signature;
}

/// Of a class Python reads it out of the text that the class was made with.
void describe_class(PyTypeObject* type, const std::string& signature) {
  const std::string name =
      py::handle(reinterpret_cast<PyObject*>(type)).attr("__name__").cast<std::string>();
  const std::string whole = name + signature + kSignatureEnd + (type->tp_doc ? type->tp_doc : "");
#if PY_VERSION_HEX >= 0x030D0000
  void* text = PyMem_Malloc(whole.size() + 1);
#else
  void* text = PyObject_Malloc(whole.size() + 1);
#endif
  if (text != nullptr) {
    std::memcpy(text, whole.c_str(), whole.size() + 1);
    type->tp_doc = static_cast<const char*>(text);  // the old one stays: once a class
  }
}

/// Its value as a repr shows it; empty for arrays, other objects and long texts.
std::string shown_value(const py::object& value) {
  constexpr std::size_t kLongest = 80;
  if (!py::isinstance<py::bool_>(value) && !py::isinstance<py::int_>(value) &&
      !py::isinstance<py::float_>(value) && !py::isinstance<py::str>(value) &&
      !py::isinstance<py::tuple>(value)) {
    return {};
  }
  const auto text = py::repr(value).cast<std::string>();
  return text.size() <= kLongest ? text : std::string();
}

/// "<adit.Edge from_=0 to=1 kind='odometry'>": what has a short repr of its own.
std::string shown(const py::object& self) {
  const py::object type = py::type::of(self);
  std::string text = "<adit." + type.attr("__name__").cast<std::string>();
  if (py::hasattr(self, "__len__")) {
    text += " of " + std::to_string(py::len(self));
  }
  for (const auto& [name, member] : py::dict(type.attr("__dict__"))) {
    if (!PyObject_TypeCheck(member.ptr(), &PyProperty_Type)) {
      continue;
    }
    if (const std::string value = shown_value(self.attr(name)); !value.empty()) {
      text += " " + py::str(name).cast<std::string>() + "=" + value;
    }
  }
  return text + ">";
}

}  // namespace

std::string text_signature(std::string_view line) {
  const std::size_t open = line.find('(');
  const std::string_view inside = line.substr(open + 1, line.rfind(") -> ") - open - 1);
  std::string signature;
  std::size_t begin = 0;
  std::vector<std::size_t> ends = outer_places(inside, ',');
  ends.push_back(inside.size());
  for (const std::size_t end : ends) {
    if (const std::string_view one = trimmed(inside.substr(begin, end - begin)); !one.empty()) {
      signature += (signature.empty() ? "" : ", ") + parameter_of(one);
    }
    begin = end + 1;
  }
  return "(" + signature + ")";
}

void describe_all(py::module_& module) {
  for (const auto& [name, object] : py::dict(module.attr("__dict__"))) {
    if (!PyType_Check(object.ptr())) {
      describe_function(object);
      continue;
    }
    auto* type = reinterpret_cast<PyTypeObject*>(object.ptr());
    if (PyType_IsSubtype(type, reinterpret_cast<PyTypeObject*>(PyExc_BaseException)) != 0) {
      continue;
    }
    std::string constructor;
    const py::dict members(object.attr("__dict__"));
    for (const auto& [member_name, member] : members) {
      const std::string signature = describe_function(member);
      if (member_name.cast<std::string>() == "__init__") {
        constructor = signature;
      }
    }
    // Without its "self"; a class that Python cannot make takes whatever it is given, and raises.
    const std::size_t comma = constructor.find(", ");
    describe_class(type, constructor.empty()          ? "(*args, **kwargs)"
                         : comma == std::string::npos ? "()"
                                                      : "(" + constructor.substr(comma + 2));
    if (!members.contains("__repr__")) {
      object.attr("__repr__") =
          py::cpp_function(&shown, py::name("__repr__"), py::is_method(object));
    }
  }
}

}  // namespace adit::python
