"""Fortran and C agree on the kernels: on types and sizes of arguments, and on constants."""

import re
import shutil

import pytest

from conftest import ROOT, each, execute

KERNELS = ROOT / "src/kernels"

# A function of C as a module of Fortran declares it.
DECLARED = re.compile(
    r"^ +(?:pure )?(?:real\(c_double\) |integer\(c_int\) )?(subroutine|function) \w+\([^)]*\)"
    r"(?: |&\n)*bind\(C, name='(spintop_\w+)'\)\n.*?^ +end \1 \w+\n",
    re.M | re.S,
)
COMPONENT = r"(\w+)(?:\[\d+\])?;$"
TYPE = re.compile(r"^typedef struct (\w+)_t \{\n(.*?)^\} \w+;\n", re.M | re.S)

# Constants of C, and the modules that have them, most under another name.
SERIES, TYPES = "formulations/series/lane_series.f90", "kernels/kernel_types.f90"
SAME = ["numbers", "highest_order", "lanes", "rows", "more_rows", "block_size", "most_drags"]
CONSTANTS = {
    "instants": ("top/motions.f90", "instants"),
    "components": (SERIES, "components"),
    "quotient + 1": (SERIES, "quotient"),
    "numerator + 1": (SERIES, "numerator"),
    "3 * of_frame + 1": (SERIES, "row_frame"),
    "3 * of_torque + 1": (SERIES, "row_torque"),
    "3 * of_push + 1": (SERIES, "row_push"),
    "lanes_drags + 1": (SERIES, "row_drags"),
    "lanes_of_drag": (SERIES, "rows_of_drag"),
    "lanes_v": (SERIES, "row_moment"),
    "sizeof(struct one_constants) / sizeof(double)": (TYPES, "one_constants"),
    "sizeof(struct lanes_constants) / sizeof(double[lanes])": (TYPES, "lane_constants"),
    **{name: (TYPES, name) for name in SAME},
}


def constant(module, name):
    text = (ROOT / "src" / module).read_text(encoding="utf-8")
    value = re.search(rf"^ [^!]*\b{name} = (\d+)(?:,|$)", text, re.M)
    assert value, f"{module} has no {name}"
    return int(value[1])


pytestmark = pytest.mark.skipif(
    not (shutil.which("gfortran") and shutil.which("gcc")), reason="no gfortran or no gcc"
)
LIST = (KERNELS / "kernel_list.h").read_text(encoding="utf-8")
NAMES = {f"spintop_{name}" for name in re.findall(r"^(?:PROCEDURE|FUNCTION)\((\w+),", LIST, re.M)}
DECLARATIONS = {
    found[2]: found[0]
    for path in ROOT.glob("src/**/*.f90")
    for found in DECLARED.finditer(path.read_text(encoding="utf-8"))
    if found[2] in NAMES
}


def check(folder, command, name, text):
    """What a compiler says of a source that has no error."""
    (folder / name).write_text(text, encoding="utf-8")
    return execute(*command.split(), "-fsyntax-only", name, cwd=folder, timeout=60).stdout


def prototypes(folder):
    """The types and the declared kernels in C, as gfortran writes them."""
    modules = (ROOT / "src/foundation/kinds.f90", KERNELS / "kernel_types.f90")
    source = "\n".join(path.read_text(encoding="utf-8") for path in modules)
    for name, text in DECLARATIONS.items():
        source += f"""
            module {name}_declared
                use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_long_long
                use spintop_kernel_types
                implicit none
                interface\n{text}
                end interface
            end module {name}_declared
            """
    return check(folder, "gfortran -fc-prototypes", "declared.f90", source)


def compare(folder, *statements):
    """Nothing that gcc reads after the declarations of C contradicts them."""
    files = ("kernels.h", "kernels_of_level.h")
    text = "".join(f'#include "{KERNELS / name}"\n' for name in files)
    text = "#define KERNELS table\nextern const struct kernels table;\n" + text
    text = f"#include <stddef.h>\nstruct kernels;\n{text}" + "\n".join(statements) + "\n"
    check(folder, "gcc -Wall -Werror", "compare.c", text)


def test_types(folder):
    """Each type has the components of the structure, of the same sizes at the same places."""
    types = dict(TYPE.findall(prototypes(folder)))
    assert len(types) > 3
    statements = []
    for name, components in types.items():
        statements.append(f"struct fortran_{name} {{\n{components}}};")
        parts = re.findall(COMPONENT, components, re.M)
        places = [f"offsetof({{0}}, {part})" for part in parts]
        sizes = [f"sizeof (({{0}} *)0)->{part}" for part in parts]
        for value in ("sizeof({0})", *places, *sizes):
            one, other = map(value.format, (f"struct {name}", f"struct fortran_{name}"))
            statements.append(f'_Static_assert({one} == {other}, "{one}");')
    compare(folder, *statements)


def test_procedures(folder):
    """Each kernel is declared in Fortran, with the arguments that it has in C."""
    assert len(NAMES) > 15
    assert DECLARATIONS.keys() == NAMES
    lines = re.findall(r"^(?:void|double) spintop_.*;$", prototypes(folder), re.M)
    assert len(set(lines)) == len(NAMES)
    compare(folder, *(re.sub(r"\b(\w+)_t \*", r"struct \1 *", line) for line in lines))


def test_constants(folder):
    pairs = ((name, constant(*place)) for name, place in CONSTANTS.items())
    compare(folder, *(f'_Static_assert({name} == {value}, "{name}");' for name, value in pairs))


@each(
    "wrong",
    '_Static_assert(sizeof(struct symmetric_top) == 8, "");',
    "void spintop_multiply_lanes(int degree, const double *x, const double *y, float *product);",
)
def test_differences_are_found(folder, wrong):
    with pytest.raises(AssertionError):
        compare(folder, wrong)
