#include "python/bindings.hpp"

#include <string>

namespace hemi::python {

namespace {

/// Kept for the process's life, as the types of a module are.
struct Types {
    py::object error;
    py::object invalid_argument;
    py::object input;
    py::object parse;
    py::object io;
    py::object gl;
    py::object no_device;
    py::object out_of_memory;
    py::object not_converged;
    py::object cancelled;
};
Types* types = nullptr;

py::object make_type(py::module_& module, const char* name, const char* text, const py::tuple& bases) {
    const std::string full_name = std::string("hemi.") + name;
    auto type = py::reinterpret_steal<py::object>(
        PyErr_NewExceptionWithDoc(full_name.c_str(), text, bases.ptr(), nullptr));
    if (!type) {
        throw py::error_already_set();
    }
    module.add_object(name, type);
    return type;
}

py::object exception_of(const py::object& type, const Error& error) {
    py::object exception = type(error.what());
    exception.attr("settings") = py::cast(error.settings());
    return exception;
}

void raise(const py::object& type, const Error& error) {
    const py::object exception = exception_of(type, error);
    PyErr_SetObject(type.ptr(), exception.ptr());
}

void raise(const ParseError& error) {
    const py::object exception = exception_of(types->parse, error);
    exception.attr("file") = error.file();
    exception.attr("line") = error.line();
    exception.attr("column") = error.column();
    PyErr_SetObject(types->parse.ptr(), exception.ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const ParseError& error) {
        raise(error);
    } catch (const InvalidArgument& error) {
        raise(types->invalid_argument, error);
    } catch (const InputError& error) {
        raise(types->input, error);
    } catch (const IoError& error) {
        raise(types->io, error);
    } catch (const NoDevice& error) {
        raise(types->no_device, error);
    } catch (const GlError& error) {
        raise(types->gl, error);
    } catch (const OutOfMemory& error) {
        raise(types->out_of_memory, error);
    } catch (const NotConverged& error) {
        raise(types->not_converged, error);
    } catch (const Cancelled& error) {
        raise(types->cancelled, error);
    } catch (const Error& error) {
        raise(types->error, error);
    }
}

} // namespace

void bind_errors(py::module_& module) {
    const auto builtin = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
    types = new Types;
    types->error =
        make_type(module, "Error",
                  "Base of all that hemi raises.\n\n"
                  "Attributes\n----------\n"
                  "settings : list of str\n    Settings that would help, such as \"max-memory\".\n",
                  py::make_tuple(builtin(PyExc_Exception)));
    const py::tuple error = py::make_tuple(types->error);
    types->invalid_argument =
        make_type(module, "InvalidArgument", "An argument is outside its documented range.",
                  py::make_tuple(types->error, builtin(PyExc_ValueError)));
    types->input =
        make_type(module, "InputError",
                  "A scene, a mesh or a stored file cannot be used as it is, or not be read.", error);
    types->parse = make_type(module, "ParseError",
                             "Text that does not parse.\n\n"
                             "Attributes\n----------\n"
                             "file : str\nline, column : int\n    From 1; 0 where unknown.\n",
                             py::make_tuple(types->input));
    types->io = make_type(module, "IoError", "A file cannot be written.",
                          py::make_tuple(types->error, builtin(PyExc_OSError)));
    types->gl = make_type(module, "GlError", "OpenGL refused something.", error);
    types->no_device = make_type(module, "NoDevice", "There is no OpenGL device of the kind asked for.",
                                 py::make_tuple(types->gl));
    types->out_of_memory = make_type(module, "OutOfMemory", "The work would need more memory than allowed.",
                                     py::make_tuple(types->error, builtin(PyExc_MemoryError)));
    types->not_converged = make_type(module, "NotConverged", "A solver did not reach its tolerance.", error);
    types->cancelled = make_type(module, "Cancelled", "The progress function returned False.", error);
    make_type(module, "HemiWarning", "Something that you should know and that does not stop the work.",
              py::make_tuple(builtin(PyExc_UserWarning)));
    py::register_exception_translator([](std::exception_ptr thrown) {
        if (thrown) {
            translate(std::move(thrown));
        }
    });
}

} // namespace hemi::python
