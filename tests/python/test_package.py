"""Stubs, docstrings, installation, the example."""

import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys

import pytest

import hemi

FOLDER = pathlib.Path(hemi.__file__).parent
STUB = ast.parse((FOLDER / "__init__.pyi").read_text())
SOURCE = pathlib.Path(__file__).parents[2]
IMPLIED = {"__init__", "__new__", "__repr__", "__weakref__", "__dict__", "__doc__", "__module__"}


def stub_members(nodes):
    """Names in a part of the stub, with their nodes; private ones are the stub's own."""
    found = {}
    for node in nodes:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = node
    return {name: node for name, node in found.items() if not re.match("_[^_]", name)}


def arguments_of_stub(function):
    """Names in order, and those with a default."""
    spec = function.args
    names = [argument.arg for argument in [*spec.args, *spec.kwonlyargs] if argument.arg != "self"]
    positional = [argument.arg for argument in spec.args]
    optional = set(positional[len(positional) - len(spec.defaults):])
    optional |= {argument.arg for argument, default in zip(spec.kwonlyargs, spec.kw_defaults) if default is not None}
    return names, optional


def split_at_commas(text):
    """Parts between the commas that are in no bracket."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[(") - (letter in "])")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def arguments_of_module(function):
    """The same, of the signature that pybind11 writes at the beginning of the docstring."""
    signature = function.__doc__.splitlines()[0]
    inside = signature[signature.index("(") + 1:signature.rindex(") ->")]
    parts = [part for part in split_at_commas(inside) if ": " in part and not part.startswith("self: ")]
    return [part.split(":")[0] for part in parts], {part.split(":")[0] for part in parts if " = " in part}


def public_members(type_):
    own = {name for name in vars(type_) if not name.startswith("_") or name in ("__len__", "__matmul__")}
    return own | ({"__array_ufunc__"} & set(vars(type_)))


def classes():
    return [name for name in hemi.__all__ if inspect.isclass(getattr(hemi, name))]


def test_every_public_name_is_in_the_stub_and_the_other_way_round():
    stub = stub_members(STUB.body)
    assert set(stub) == {*hemi.__all__, "__all__", "__version__"}
    compiled = {name for name in vars(hemi._hemi) if not name.startswith("_")}
    assert set(hemi.__all__) == compiled


@pytest.mark.parametrize("name", classes())
def test_every_member_of_a_class_is_in_the_stub_and_the_other_way_round(name):
    type_ = getattr(hemi, name)
    stub = stub_members(next(node for node in STUB.body if getattr(node, "name", "") == name).body)
    if issubclass(type_, Exception):
        assert [base.__name__ for base in type_.__bases__] == [
            base.id for node in STUB.body if getattr(node, "name", "") == name for base in node.bases]
        return # what they carry is set when they are raised
    assert set(stub) - IMPLIED == public_members(type_) - IMPLIED
    for member, node in stub.items():
        is_property = isinstance(node, ast.FunctionDef) and any(
            isinstance(decorator, ast.Name) and decorator.id == "property" for decorator in node.decorator_list)
        assert isinstance(vars(type_).get(member), property) == is_property, member


def test_arguments_are_those_of_the_stub():
    compared = 0
    functions = [(getattr(hemi, name), node) for name, node in stub_members(STUB.body).items()
                 if isinstance(node, ast.FunctionDef)]
    for name in classes():
        body = next(node for node in STUB.body if getattr(node, "name", "") == name).body
        functions += [(getattr(getattr(hemi, name), member), node) for member, node in stub_members(body).items()
                      if isinstance(node, ast.FunctionDef) and not node.decorator_list and member != "__len__"]
    for function, node in functions:
        assert arguments_of_module(function) == arguments_of_stub(node), node.name
        compared += 1
    assert compared >= 14


def test_every_public_name_has_a_docstring():
    for name in hemi.__all__:
        item = getattr(hemi, name)
        assert item.__doc__ and item.__module__ == "hemi", name
        if inspect.isclass(item) and not issubclass(item, Exception):
            for member in public_members(item) - IMPLIED - {"__array_ufunc__", "__len__", "__matmul__"}:
                assert vars(item)[member].__doc__, f"{name}.{member}"


def test_a_python_without_build_folders_finds_what_was_installed(tmp_path):
    subprocess.run(["cmake", "--install", os.environ["HEMI_BUILD"], "--prefix", tmp_path], check=True,
                   capture_output=True)
    folder, = tmp_path.glob("lib/python3*/*-packages")
    assert {path.name for path in (folder / "hemi").iterdir() if path.suffix != ".so"} == {
        "__init__.py", "__init__.pyi", "_progress.py", "py.typed"}
    environment = {name: value for name, value in os.environ.items() if not name.startswith("HEMI_")}
    program = subprocess.run(
        [sys.executable, "-c", "import hemi; print(hemi.__file__); print(hemi.worker_program())"],
        env={**environment, "PYTHONPATH": str(folder)}, cwd=tmp_path, check=True, capture_output=True, text=True)
    assert program.stdout.splitlines() == [str(folder / "hemi" / "__init__.py"),
                                           str(tmp_path / "libexec/hemi/hemi-hemicube-worker")]


def test_the_example_plots_a_row(tmp_path):
    picture = tmp_path / "row.png"
    done = subprocess.run([sys.executable, SOURCE / "tools/python/mesh_to_factors.py", "-o", picture], check=False,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert picture.read_bytes()[:4] == b"\x89PNG" and picture.stat().st_size > 10000
    assert "sum" in done.stdout
