"""The manual and the pages of the API as one site, by FORD, which `scripts/api_docs` installs.

FORD reads the sources and [extra.ford] of fpm.toml. Its pages would take styles and scripts from
the network: Bootstrap is put beside them instead, and equations become MathML, which a browser
shows by itself.
"""

import base64
import contextlib
import hashlib
import io
import os
import re
import shutil
import sys
import tomllib
from importlib.resources import files
from pathlib import Path

import ford
from bs4 import BeautifulSoup
from ford.settings import ProjectSettings, load_toml_settings
from latex2mathml.converter import convert

from manual.pages import ROOT, links_of, manual_pages, map_links, map_maths, map_prose, title_of

SITE = ROOT / "build" / "api"
SOURCES = ROOT / "build" / "api_pages"
COPIES = ROOT / "build" / "api_files"
"""The pages of the manual as FORD takes them, and the files that they link to."""

BOOTSTRAP = files("js_lib_bootstrap5") / "static" / "js-lib-bootstrap5"
_PLACEHOLDER = "EQUATION{}X"


class Pages:
    """Turns pages of the manual into those of FORD, which lie elsewhere."""

    def __init__(self) -> None:
        self.equations: list[str] = []
        self.problems: list[str] = []

    def place_of(self, target: Path) -> Path:
        """Where a file of the project is in the site."""
        name = target.relative_to(ROOT)
        if name == Path("README.md"):
            return SITE / "index.html"
        if target.suffix == ".md" and name.parent == Path("doc"):
            return SITE / "page" / f"{name.stem}.html"
        return SITE / "files" / (name if target.is_file() else name / "index.html")

    def convert(self, page: Path) -> str:
        """The text of a page with equations set aside and links for its place in the site."""
        place = self.place_of(page)

        def change_link(target: str) -> str:
            if re.match(r"[a-z]+:|#", target):
                return target
            path, mark, anchor = target.partition("#")
            file = (page.parent / path).resolve()
            if not file.exists():
                self.problems.append(f"{page.relative_to(ROOT)}: no {target}")
                return target
            found = self.place_of(file)
            if SITE / "files" in found.parents:
                self.copy(file, found)
            return os.path.relpath(found, place.parent) + mark + anchor

        def change_maths(tex: str, displayed: bool) -> str:
            spaced = re.sub(r"(?<=.) *(\\(?:sin|cos)(?:\^2)?) *(?=\\)", r"\\,\1\\,", tex)
            self.equations.append(convert(spaced, display="block" if displayed else "inline"))
            return _PLACEHOLDER.format(len(self.equations) - 1)

        def change(prose: str) -> str:
            return map_links(map_maths(prose, change_maths), change_link)

        return map_prose(page.read_text(encoding="utf-8"), change)

    def copy(self, file: Path, found: Path) -> None:
        """Keep a copy of a file, or a list of the files of a folder, for the site."""
        copy = COPIES / found.relative_to(SITE)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if file.is_file():
            shutil.copyfile(file, copy)
            return
        names = sorted(entry.name for entry in file.iterdir() if entry.is_file())
        for name in names:
            shutil.copyfile(file / name, copy.parent / name)
        items = "".join(f'<li><a href="{name}">{name}</a></li>' for name in names)
        head = f"<!DOCTYPE html><meta charset='utf-8'><title>{file.name}</title>"
        copy.write_text(f"{head}<h1>{file.name}</h1><ul>{items}</ul>\n", encoding="utf-8")

    def finish(self, html: str) -> str:
        """Put the equations back."""
        pattern = _PLACEHOLDER.format(r"(\d+)")
        return re.sub(pattern, lambda match: self.equations[int(match[1])], html)


def write_pages(pages: Pages) -> str:
    """Write the pages of the manual where FORD reads them; return the text of the front page."""
    for folder in (SOURCES, COPIES):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    front = ""
    for page in manual_pages():
        text = re.sub(r"^# .*\n", "", pages.convert(page), count=1)  # FORD has a title of its own
        if page.parent == ROOT:
            front = text
            continue
        head = f"title: {title_of(page)}\n"
        if page.stem == "index":  # which has the pages in their order
            names = [target for _, target in links_of(page) if re.fullmatch(r"\w+\.md", target)]
            head += "".join(f"ordered_subpage: {name}\n" for name in dict.fromkeys(names))
        (SOURCES / page.name).write_text(f"---\n{head}---\n{text}", "utf-8")
    return front


def local_file(url: str, digest: str) -> Path:
    """The file that a page would take from the network, if it is the one that FORD means."""
    for file in ("css/bootstrap.min.css", "js/bootstrap.bundle.min.js"):
        if url.endswith(file):
            data = (BOOTSTRAP / file).read_bytes()
            if digest == "sha384-" + base64.b64encode(hashlib.sha384(data).digest()).decode():
                (SITE / file).write_bytes(data)
                return SITE / file
    raise ValueError(f"{url}: FORD wants another file than the one at hand")


def cut_from_network(path: Path, html: str) -> str:
    """Styles and scripts from beside the page; no MathJax, for there are no equations left."""
    soup = BeautifulSoup(html, "html.parser")
    for tag in soup.find_all(["script", "link"]):
        url = tag.get("src") or tag.get("href") or ""
        if "mathjax" in (url + tag.get("type", "")).lower():
            tag.decompose()
        elif url.startswith("http"):
            file = local_file(url, tag["integrity"])
            tag["src" if tag.name == "script" else "href"] = os.path.relpath(file, path.parent)
            del tag["integrity"], tag["crossorigin"]
    return str(soup)


def broken_links(path: Path) -> list[str]:
    """Links of a page of the site that lead nowhere, or that a page needs from the network."""
    soup = BeautifulSoup(path.read_text(encoding="utf-8"), "html.parser")
    found = []
    for tag in soup.find_all(["a", "img", "script", "link"]):
        url = tag.get("src") or tag.get("href") or ""
        if re.match(r"[a-z]+:", url):
            if tag.name != "a":
                found.append(url)
        elif url and not (path.parent / url.partition("#")[0]).exists():
            found.append(url)
    return found


def read_settings() -> ProjectSettings:
    """FORD's settings: of its section in the manifest, and what the manifest says anyway."""
    settings = load_toml_settings(ROOT)
    manifest = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))
    settings.project, settings.version = manifest["name"], manifest["version"]
    settings.summary, settings.license = manifest["description"], manifest["license"]
    settings.page_dir, settings.output_dir = SOURCES, SITE
    return settings


def main() -> int:
    """Build the site; return 1 if something is wrong, and say what."""
    said = io.StringIO()
    shutil.rmtree(SITE, ignore_errors=True)
    pages = Pages()
    front = write_pages(pages)
    with contextlib.redirect_stdout(said):
        settings, front = ford.parse_arguments({}, front, read_settings(), ROOT)
        ford.main(settings, front)
    problems = list(pages.problems)
    shutil.copytree(COPIES, SITE, dirs_exist_ok=True)
    html = [path for path in SITE.rglob("*.html") if SITE / "files" not in path.parents]
    for path in html:
        text = cut_from_network(path, path.read_text(encoding="utf-8"))
        path.write_text(pages.finish(text), encoding="utf-8")
    for path in html:
        problems += [f"{path.relative_to(SITE)}: broken link {url}" for url in broken_links(path)]
    problems += [line for line in said.getvalue().splitlines() if line.startswith("Warning")]
    for problem in dict.fromkeys(problems):
        print(problem, file=sys.stderr)
    print(SITE.relative_to(ROOT) / "index.html")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
