// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <exception>
#include <string>

#include "calls.h"
#include "interruptible.h"
#include "results.h"
#include "vdb_offset/api.h"
#include "vdb_offset/layer_plan.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

/// The module vdb_offset._core, which vdb_offset/_calls.py makes functions with keywords of.
namespace vdb_offset::python {
namespace {

/// A class of exceptions that is one of the library's and one of Python's own.
py::object exception_class(py::module_& module, const char* name, const py::tuple& bases, const char* text) {
  const std::string full = "vdb_offset." + std::string(name);
  py::object made =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr));
  if (!made) throw py::error_already_set();
  module.attr(name) = made;
  return made;
}

/// The library's exceptions as Python's. Their classes live as long as the module does.
void add_exceptions(py::module_& module) {
  const auto builtin = [](PyObject* base) { return py::reinterpret_borrow<py::object>(base); };
  static const PyObject *error, *input, *option, *expression, *budget, *cancelled, *result;
  const py::object base = exception_class(module, "Error", py::make_tuple(builtin(PyExc_Exception)),
                                          "Base class of all that the library raises on purpose.");
  const auto add = [&](const char* name, const py::object& above, PyObject* beside, const char* text) {
    return exception_class(module, name, beside ? py::make_tuple(above, builtin(beside)) : py::make_tuple(above), text);
  };
  const py::object of_input = add("InvalidInput", base, PyExc_ValueError, "A mesh or an option that cannot be used.");
  const py::object of_option =
      add("InvalidOption", base, PyExc_ValueError, "An option whose value cannot be understood.");
  const py::object of_expression =
      add("InvalidExpression", of_option, nullptr, "An expression that cannot be understood, with the column.");
  const py::object of_budget =
      add("OutOfBudget", base, PyExc_MemoryError, "Work that was refused before it started, as it would not fit.");
  const py::object of_cancelled = add("Cancelled", base, nullptr, "The progress callback asked to stop.");
  const py::object of_result =
      add("InvalidResult", base, PyExc_RuntimeError, "An iso-surface that is not valid: `statistics` is its report.");
  error = base.ptr();
  input = of_input.ptr();
  option = of_option.ptr();
  expression = of_expression.ptr();
  budget = of_budget.ptr();
  cancelled = of_cancelled.ptr();
  result = of_result.ptr();
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11's own signature
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const PyObject* type, const std::exception& e) {
      PyErr_SetString(const_cast<PyObject*>(type), e.what());
    };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::cast_error& e) {  // a number out of range, or a text that is none
      raise(option, e);
    } catch (const InvalidExpression& e) {
      raise(expression, e);
    } catch (const InvalidOption& e) {
      raise(option, e);
    } catch (const InvalidInput& e) {
      raise(input, e);
    } catch (const OutOfBudget& e) {
      raise(budget, e);
    } catch (const Cancelled& e) {
      raise(cancelled, e);
    } catch (const InvalidResult& e) {
      const py::handle type(const_cast<PyObject*>(result));
      const py::object raised = type(e.what());
      raised.attr("statistics") = from_json(e.report);
      PyErr_SetObject(type.ptr(), raised.ptr());
    } catch (const Error& e) {
      raise(error, e);
    }
  });
}

/// A call whose first argument is known.
template <class Result, class First, class... Rest>
auto with(Result (*call)(First, Rest...), First first) {
  return [call, first](Rest... rest) { return call(first, rest...); };
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  add_exceptions(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(&Calls::end));
  module.attr("version") = version();
  py::list states;
  for (std::size_t s = 0; s < kVertexStateCount; ++s) states.append(name(static_cast<VertexState>(s)));
  module.attr("states") = py::tuple(states);
  module.def("offset", with(&offset_arrays, Input::Mesh));
  module.def("offset_curves", with(&offset_arrays, Input::Curves));
  module.def("fit", &fit_arrays);
  module.def("offset_to_tolerance", &refined_arrays);
  module.def("check", with(&check_arrays, Input::Mesh));
  module.def("check_curves", with(&check_arrays, Input::Curves));
  module.def("shell", &shell_arrays);
  module.def("iso_surface", &iso_arrays);
  module.def("iso_shell", &iso_shell_arrays);
  module.def("plan", with(&plan, Input::Mesh));
  module.def("plan_curves", with(&plan, Input::Curves));
  module.def("height_of_y_plus", &height_of_y_plus);
  module.def("layers", with(&layer_arrays, Input::Mesh));
  module.def("curve_layers", with(&layer_arrays, Input::Curves));
  module.def("structured_layers", with(&block_arrays, Input::Mesh));
  module.def("structured_curve_layers", with(&block_arrays, Input::Curves));
}

}  // namespace vdb_offset::python
