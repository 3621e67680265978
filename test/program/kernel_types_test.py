"""Fortran and C agree on the kernels: on types and sizes of arguments, and on constants."""

import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KERNELS = ROOT / "src/kernels"

# A function of C as a module of Fortran declares it.
DECLARED = re.compile(
    r"^ +(?:pure )?(?:real\(c_double\) |integer\(c_int\) )?(subroutine|function) \w+\([^)]*\)"
    r"(?: |&\n)*bind\(C, name='(spintop_\w+)'\)\n.*?^ +end \1 \w+\n",
    re.M | re.S,
)
COMPONENT = r"(\w+)(?:\[\d+\])?;$"
TYPE = re.compile(r"^typedef struct (\w+)_t \{\n(.*?)^\} \w+;\n", re.M | re.S)

# Constants of C, and the modules that have them under another name or in another place.
CONSTANTS = {
    "instants": ("top/motions.f90", "instants"),
    "components": ("formulations/series/lane_series.f90", "components"),
    "quotient + 1": ("formulations/series/lane_series.f90", "quotient"),
    "numerator + 1": ("formulations/series/lane_series.f90", "numerator"),
    "frame + 1": ("formulations/series/lane_series.f90", "row_frame"),
    "torque + 1": ("formulations/series/lane_series.f90", "row_torque"),
    "push + 1": ("formulations/series/lane_series.f90", "row_push"),
    "drags + 1": ("formulations/series/lane_series.f90", "row_drags"),
    "of_drag": ("formulations/series/lane_series.f90", "rows_of_drag"),
    "drag_v": ("formulations/series/lane_series.f90", "row_moment"),
    "numbers": ("kernels/kernel_types.f90", "numbers"),
    "highest_order": ("kernels/kernel_types.f90", "highest_order"),
    "lanes": ("kernels/kernel_types.f90", "lanes"),
    "rows": ("kernels/kernel_types.f90", "rows"),
    "more_rows": ("kernels/kernel_types.f90", "more_rows"),
    "sizeof(struct one_constants) / sizeof(double)": ("kernels/kernel_types.f90", "one_constants"),
    "sizeof(struct lanes_constants) / sizeof(double[lanes])": (
        "kernels/kernel_types.f90",
        "lane_constants",
    ),
    "most_drags": ("kernels/kernel_types.f90", "most_drags"),
}


def constant(module: str, name: str) -> int:
    """The value of a constant of a module."""
    text = (ROOT / "src" / module).read_text(encoding="utf-8")
    value = re.search(rf"^ [^!]*\b{name} = (\d+)(?:,|$)", text, re.M)
    assert value, f"{module} has no {name}"
    return int(value[1])


@unittest.skipUnless(shutil.which("gfortran") and shutil.which("gcc"), "no gfortran or no gcc")
class KernelTypesTest(unittest.TestCase):
    """gfortran writes in C what it takes for a type or a procedure, and gcc compares."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        kernels = (KERNELS / "kernel_list.h").read_text(encoding="utf-8")
        names = re.findall(r"^(?:PROCEDURE|FUNCTION)\((\w+),", kernels, re.M)
        self.names = {f"spintop_{name}" for name in names}
        self.declared: dict[str, str] = {}
        for path in ROOT.glob("src/**/*.f90"):
            for found in DECLARED.finditer(path.read_text(encoding="utf-8")):
                if found[2] in self.names:
                    self.declared[found[2]] = found[0]

    def compile(self, command: str, name: str, text: str) -> subprocess.CompletedProcess[str]:
        (self.folder / name).write_text(text, encoding="utf-8")
        words = [*command.split(), "-fsyntax-only", name]
        return subprocess.run(
            words, cwd=self.folder, capture_output=True, text=True, check=False, timeout=60
        )

    def prototypes(self) -> str:
        """The types and the declared kernels in C, as gfortran writes them."""
        modules = (ROOT / "src/foundation/kinds.f90", KERNELS / "kernel_types.f90")
        source = "\n".join(path.read_text(encoding="utf-8") for path in modules)
        for name, text in self.declared.items():
            source += f"""
                module {name}_declared
                    use, intrinsic :: iso_c_binding, only: c_double, c_int
                    use spintop_kernel_types
                    implicit none
                    interface\n{text}
                    end interface
                end module {name}_declared
                """
        done = self.compile("gfortran -fc-prototypes", "declared.f90", source)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def compare(self, *statements: str) -> None:
        """Nothing that gcc reads after the declarations of C contradicts them."""
        files = ("kernels.h", "kernels_of_level.h")
        text = "".join(f'#include "{KERNELS / name}"\n' for name in files)
        text = "#define KERNELS table\nextern const struct kernels table;\n" + text
        text = f"#include <stddef.h>\nstruct kernels;\n{text}" + "\n".join(statements) + "\n"
        done = self.compile("gcc -Wall -Werror", "compare.c", text)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_types(self) -> None:
        """Each type has the components of the structure, of the same sizes at the same places."""
        types = dict(TYPE.findall(self.prototypes()))
        self.assertGreater(len(types), 5)
        statements = []
        for name, components in types.items():
            statements.append(f"struct fortran_{name} {{\n{components}}};")
            kinds = (f"struct {name}", f"struct fortran_{name}")
            places = [
                f"offsetof({{0}}, {part})" for part in re.findall(COMPONENT, components, re.M)
            ]
            sizes = [
                f"sizeof (({{0}} *)0)->{part}" for part in re.findall(COMPONENT, components, re.M)
            ]
            for value in ("sizeof({0})", *places, *sizes):
                one, other = map(value.format, kinds)
                statements.append(f'_Static_assert({one} == {other}, "{one}");')
        self.compare(*statements)

    def test_procedures(self) -> None:
        """Each kernel is declared in Fortran, with the arguments that it has in C."""
        self.assertGreater(len(self.names), 15)
        self.assertEqual(self.declared.keys(), self.names)
        lines = re.findall(r"^(?:void|double) spintop_.*;$", self.prototypes(), re.M)
        self.assertEqual(len(set(lines)), len(self.names))
        self.compare(*(re.sub(r"\b(\w+)_t \*", r"struct \1 *", line) for line in lines))

    def test_constants(self) -> None:
        self.compare(
            *(
                f'_Static_assert({name} == {constant(*place)}, "{name}");'
                for name, place in CONSTANTS.items()
            )
        )

    def test_differences_are_found(self) -> None:
        """The comparison fails where it should."""
        for wrong in (
            '_Static_assert(sizeof(struct symmetric_top) == 8, "");',
            "void spintop_add_terms(int order, const double *c, double h, float *change);",
        ):
            with self.subTest(wrong), self.assertRaises(AssertionError):
                self.compare(wrong)
