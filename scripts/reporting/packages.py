"""The scripts of pages with what they use of three.js, and the npm packages that this takes.

`page/package-lock.json` says which, in the form that npm itself writes and reads. A package is
fetched once, as npm would, from the registry of its configuration (`npm_config_registry`, `.npmrc`
here or at home), verified, and kept in build/; neither npm nor node is needed.
"""

import base64
import hashlib
import io
import json
import os
import platform
import ssl
import subprocess
import tarfile
import tempfile
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = Path(__file__).resolve().parent / "page"
MODULES = ROOT / "build" / "report" / "node_modules"
"""Where packages are kept, each in the folder of its name, as programs of npm expect them."""

PUBLIC_REGISTRY = "https://registry.npmjs.org/"
PATIENCE = 60.0
"""Seconds to wait for the registry."""

PROCESSORS = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64", "arm64": "arm64"}
"""What npm calls the processors that `platform` names."""

OPTIONS = (
    *("--bundle", "--minify", "--format=iife", "--charset=utf8", "--legal-comments=none"),
    *("--target=es2022", "--log-level=warning"),
)
"""What esbuild is told; the target is the oldest browser."""


class PackageError(Exception):
    """Why a package is not to be had, in one line."""


def bundle(entry: Path) -> str:
    """A module and all that it imports, as one classic script without dependencies.

    It has the licence of three.js at its head. Raises a PackageError if what it takes is not there
    and cannot be fetched.
    """
    licence = (need("three") / "LICENSE").read_text(encoding="utf-8")
    program = need(esbuild_package()) / "bin" / "esbuild"
    command = [program, entry, *OPTIONS, f"--banner:js=/*! with three.js\n{licence}*/"]
    environment = os.environ | {"NODE_PATH": str(MODULES)}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, encoding="utf-8", env=environment, check=False
        )
    except OSError as error:
        raise PackageError(f"cannot run {program}: {error.strerror}") from error
    if done.returncode or done.stderr:
        raise PackageError(f"esbuild refused {entry.name}:\n{done.stderr.strip()}")
    return done.stdout


def esbuild_package() -> str:
    """The package with the bundler for this machine."""
    processor = platform.machine().lower()
    name = f"@esbuild/{platform.system().lower()}-{PROCESSORS.get(processor, processor)}"
    entry_of(name)
    return name


def entry_of(name: str) -> dict:
    """Version and integrity of a package."""
    lock = PAGE / "package-lock.json"
    packages = json.loads(lock.read_text(encoding="utf-8"))["packages"]
    if f"node_modules/{name}" not in packages:
        raise PackageError(f"there is no {name} in {lock}")
    return packages[f"node_modules/{name}"]


def need(name: str) -> Path:
    """The folder of a package, fetched if it is not there yet."""
    entry = entry_of(name)
    folder, integrity = MODULES / name, entry["integrity"]
    stamp = folder / ".integrity"
    if stamp.is_file() and stamp.read_text(encoding="ascii") == integrity:
        return folder
    data = fetch(tarball_of(name, entry["version"]))
    algorithm, _, expected = integrity.partition("-")
    found = base64.b64encode(hashlib.new(algorithm, data).digest()).decode("ascii")
    if found != expected:
        raise PackageError(f"{name} is not what the lock file means: {algorithm}-{found}")
    try:
        unpack(data, folder, integrity)
    except OSError as error:
        raise PackageError(f"cannot write to {folder}: {error.strerror or error}") from error
    return folder


def settings() -> dict[str, str]:
    """The configuration of npm: of this machine's user, of the project, of the environment."""
    environment = {key.lower(): value for key, value in os.environ.items()}
    user = environment.get("npm_config_userconfig") or Path("~/.npmrc").expanduser()
    known: dict[str, str] = {}
    for path in filter(Path.is_file, (Path(user), ROOT / ".npmrc")):
        for line in path.read_text(encoding="utf-8").splitlines():
            key, equals, value = line.partition("=")
            if equals and not line.lstrip().startswith(("#", ";")):
                known[key.strip()] = value.strip().strip("\"'")
    given = {key: environment.get(f"npm_config_{key}") for key in ("registry", "cafile")}
    return known | {key: value for key, value in given.items() if value}


def tarball_of(name: str, version: str) -> str:
    """Where the registry has a version of a package."""
    registry = settings().get("registry", PUBLIC_REGISTRY).rstrip("/")
    return f"{registry}/{name}/-/{name.rpartition('/')[2]}-{version}.tgz"


def fetch(address: str) -> bytes:
    """The bytes at an address."""
    host = urllib.parse.urlsplit(address).hostname
    try:
        context = ssl.create_default_context(cafile=settings().get("cafile"))
        with urllib.request.urlopen(address, timeout=PATIENCE, context=context) as answer:
            return answer.read()
    except (OSError, ValueError) as error:
        reason = getattr(error, "reason", error)
        raise PackageError(f"the npm registry ({host}) gave no {address}: {reason}") from error


def is_plain(member: tarfile.TarInfo) -> bool:
    """Whether it is a file or a folder below the place where it is unpacked."""
    path = Path(member.name)
    return (member.isfile() or member.isdir()) and not path.is_absolute() and ".." not in path.parts


def unpack(data: bytes, folder: Path, integrity: str) -> None:
    """Put the files of a package into its folder, which is complete or not there."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            # Python 3.11.2, that of Debian 12, has no filters: it gets what they let through.
            archive.extraction_filter = getattr(tarfile, "data_filter", None)
            archive.extractall(scratch, [member for member in archive if is_plain(member)])
        [fresh] = Path(scratch).iterdir()  # named as the packer liked it
        (fresh / ".integrity").write_text(integrity, encoding="ascii")
        if folder.exists():
            folder.rename(Path(scratch) / "old")
        fresh.rename(folder)
