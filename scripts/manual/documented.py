"""Which public items of the sources have no docstring, as FORD reads them."""

from collections.abc import Iterator

from ford.fortran_project import Project

FACE = "spintop"
"""The module that re-exports what users of the library need: components of its types count, too."""


def _is_documented(item: object) -> bool:
    """Whether there is a docstring: at the item, or at what it stands for."""
    if "".join(getattr(item, "doc_list", None) or []).strip():
        return True
    if procedure := getattr(item, "procedure", None):
        return _is_documented(procedure)
    stands_for = [proc.procedure for proc in getattr(item, "modprocs", None) or []]
    stands_for += getattr(item, "routines", None) or []
    stands_for += getattr(item, "bindings", None) or []
    if getattr(item, "deferred", False):
        stands_for = [item.proto]
    return bool(stands_for) and all(_is_documented(part) for part in stands_for)


def _bare(items: list) -> Iterator[object]:
    """The public items without a docstring."""
    return (item for item in items if item.permission == "public" and not _is_documented(item))


def find_undocumented(project: Project) -> Iterator[str]:
    """Modules, procedures, types, what is bound to them, and components that users see."""
    face = [name for module in project.modules if module.name == FACE for name in module.all_types]
    for module in [*project.modules, *project.submodules]:
        if not _is_documented(module):
            yield f"{module.filename}: {module.obj} {module.name}"
    for module in project.modules:
        procedures = [*module.functions, *module.subroutines]
        for item in _bare([*procedures, *module.interfaces, *module.absinterfaces, *module.types]):
            yield f"{module.filename}: {item.name}"
        for kind in module.types:
            parts = kind.variables if kind.name.lower() in face else []
            for item in _bare([*kind.boundprocs, *parts]):
                yield f"{module.filename}: {kind.name}%{item.name}"
