"""Tests of the recipes of packages and of the workflows: their syntax, versions and sources."""

import ast
import importlib.machinery
import importlib.util
import re
import tomllib
import unittest
import unittest.mock
from pathlib import Path

import jinja2
import pytest

from conftest import ROOT, called, execute

PACKAGING = ROOT / "packaging"
META = PACKAGING / "conda" / "recipe" / "meta.yaml"
RECIPES = (META, PACKAGING / "spack" / "package.py")
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
STEP = re.compile(r"^( +)(?:- )?run: (\|\n(?:\1 +.*\n|\n)+|>-\n(?:\1 +.*\n)+|.+\n)", re.MULTILINE)
EXPRESSION = re.compile(r"\$\{\{.*?\}\}")


def meta() -> str:
    """The recipe of conda after its templates."""
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined, autoescape=False)
    functions = {"compiler": "{}_linux-64".format, "stdlib": "{}_stdlib".format}
    return environment.from_string(META.read_text(encoding="utf-8")).render(**functions)


@pytest.mark.usefixtures("folder")
class RecipesTest(unittest.TestCase):
    def test_syntax(self) -> None:
        """Python, shell and YAML can be read."""
        for path in (RECIPES[1], PACKAGING / "fill_recipes"):
            ast.parse(path.read_text(encoding="utf-8"), str(path))
        for path in (META.with_name("build.sh"), PACKAGING / "from_sources"):
            execute("bash", "-n", path)
            self.assertTrue(path.stat().st_mode & 0o100, path)
        texts = {path.name: path.read_text(encoding="utf-8") for path in WORKFLOWS}
        texts |= {"meta.yaml": meta(), "citation": (ROOT / "CITATION.cff").read_text("utf-8")}
        try:
            import yaml
        except ImportError:
            yaml = None
        for name, text in texts.items():
            self.assertNotIn("\t", text, name)
            if yaml:
                self.assertIsInstance(yaml.safe_load(text), dict, name)

    def test_steps_of_workflows(self) -> None:
        """The commands of every step are a script of bash; actions are named by their commits."""
        for path in WORKFLOWS:
            text = path.read_text(encoding="utf-8")
            steps = [match[2] for match in STEP.finditer(text)]
            self.assertEqual(len(steps), len(re.findall(r"\brun: ", text)), path.name)
            for step in steps:
                script = EXPRESSION.sub("x", re.sub(r"^(\||>-)\n", "", step))
                execute("bash", "-n", "-c", script)
            for action in re.findall(r"uses: (\S+)", text):
                self.assertRegex(action, r"^actions/[\w-]+@[0-9a-f]{40}$")

    def test_one_release(self) -> None:
        """All recipes take the same sources, and the version of the project."""
        version = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))["version"]
        for path in RECIPES:
            text = meta() if path == META else path.read_text(encoding="utf-8")
            for part in (f"spintop-{version}", "sundials-7.1.1", "v2.0.0-rc.1"):
                self.assertIn(f"{part}.tar.gz", text, path.name)
            script = META.with_name("build.sh").read_text("utf-8") if path == META else text
            self.assertIn("packaging/from_sources", script, path.name)
        release = (ROOT / ".github" / "workflows" / "release.yml").read_text(encoding="utf-8")
        self.assertIn("sundials-7.1.1.tar.gz", release)
        execute(ROOT / "scripts/check_version.py")

    def test_fill(self) -> None:
        """Address, maintainer and checksums of a release; what is wrong is said."""
        files = [self.folder / name for name in ("a", "b", "c")]
        for path in files:
            path.write_bytes(path.name.encode())
        path = str(PACKAGING / "fill_recipes")
        loader = importlib.machinery.SourceFileLoader("fill_recipes", path)
        spec = importlib.util.spec_from_loader("fill_recipes", loader)
        filler = importlib.util.module_from_spec(spec)
        loader.exec_module(filler)

        def fill(*arguments: str | Path) -> tuple[int, str]:
            code, _, said = called(filler.main, "fill_recipes", *arguments)
            return code, said

        target = self.folder / "recipes"
        self.assertEqual(fill("https://a.org/top/", "me", *files, target), (0, ""))
        made = [path for path in target.rglob("*") if path.is_file()]
        self.assertEqual(len(made), 3)
        for path in made:
            text = path.read_text(encoding="utf-8")
            for word in ("0" * 64, "example.org", "MAINTAINER"):
                self.assertNotIn(word, text)
        digest = "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb"
        text = (target / "spack/package.py").read_text()
        self.assertLess(text.index(digest), text.index("resource("))
        self.assertEqual(fill("https://a.org", "me")[0], 2)
        code, said = fill("https://a.org", "me", self.folder / "none", *files[:2], target)
        self.assertEqual((code, "No such file" in said), (4, True))
