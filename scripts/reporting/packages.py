"""The npm packages that the page is made with: fetched once, verified, kept in build/.

`page/package-lock.json` says which, in the form that npm itself writes and reads. A package is
fetched as npm would, from the registry of its configuration (`npm_config_registry`, `.npmrc` here
or at home), but neither npm nor node is needed.
"""

import base64
import hashlib
import io
import json
import os
import platform
import ssl
import tarfile
import tempfile
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = Path(__file__).resolve().parent / "page"
DICTIONARY = PAGE / "live" / "dictionary.json"
"""The words of the live top in all its languages."""
MODULES = ROOT / "build" / "report" / "node_modules"
"""Where packages are kept, each in the folder of its name, as programs of npm expect them."""

PUBLIC_REGISTRY = "https://registry.npmjs.org/"
PATIENCE = 60.0
"""Seconds to wait for the registry."""

PROCESSORS = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64", "arm64": "arm64"}
"""What npm calls the processors that `platform` names."""


class PackageError(Exception):
    """Why a package is not to be had, in one line."""


def esbuild_package() -> str:
    """The package with the bundler for this machine."""
    processor = platform.machine().lower()
    name = f"@esbuild/{platform.system().lower()}-{PROCESSORS.get(processor, processor)}"
    if name not in read_lock():
        raise PackageError(f"there is no {name} in {PAGE / 'package-lock.json'}")
    return name


def read_lock() -> dict[str, dict]:
    """Version and integrity of every package, by name."""
    lock = json.loads((PAGE / "package-lock.json").read_text(encoding="utf-8"))
    inside = "node_modules/"
    return {
        key.removeprefix(inside): entry
        for key, entry in lock["packages"].items()
        if key.startswith(inside)
    }


def need(name: str) -> Path:
    """The folder of a package, fetched if it is not there yet."""
    entry = read_lock()[name]
    folder = MODULES / name
    stamp = folder / ".integrity"
    try:
        if stamp.read_text(encoding="ascii") == entry["integrity"]:
            return folder
    except FileNotFoundError:
        pass
    data = fetch(tarball_of(name, entry["version"]))
    check_integrity(name, data, entry["integrity"])
    try:
        unpack(data, folder, entry["integrity"])
    except OSError as error:
        raise PackageError(f"cannot write to {folder}: {error.strerror or error}") from error
    return folder


def settings() -> dict[str, str]:
    """The configuration of npm: of this machine's user, of the project, of the environment."""
    environment = {key.lower(): value for key, value in os.environ.items()}
    user = environment.get("npm_config_userconfig") or str(Path("~/.npmrc").expanduser())
    known: dict[str, str] = {}
    for path in (Path(user), ROOT / ".npmrc"):
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except OSError:
            continue
        for line in lines:
            key, equals, value = line.partition("=")
            if equals and not line.lstrip().startswith(("#", ";")):
                known[key.strip()] = value.strip().strip("\"'")
    for key in ("registry", "cafile"):
        if value := environment.get(f"npm_config_{key}"):
            known[key] = value
    return known


def tarball_of(name: str, version: str) -> str:
    """Where the registry has a version of a package."""
    registry = settings().get("registry", PUBLIC_REGISTRY).rstrip("/")
    return f"{registry}/{name}/-/{name.rpartition('/')[2]}-{version}.tgz"


def fetch(address: str) -> bytes:
    """The bytes at an address."""
    cafile = settings().get("cafile")
    host = urllib.parse.urlsplit(address).hostname
    try:
        context = ssl.create_default_context(cafile=cafile)
        with urllib.request.urlopen(address, timeout=PATIENCE, context=context) as answer:
            return answer.read()
    except (OSError, ValueError) as error:
        reason = getattr(error, "reason", error)
        raise PackageError(f"the npm registry ({host}) gave no {address}: {reason}") from error


def check_integrity(name: str, data: bytes, integrity: str) -> None:
    """Raise an error unless the bytes are those that the lock file means."""
    algorithm, _, expected = integrity.partition("-")
    found = base64.b64encode(hashlib.new(algorithm, data).digest()).decode("ascii")
    if found != expected:
        raise PackageError(f"{name} is not what the lock file means: {algorithm}-{found}")


def unpack(data: bytes, folder: Path, integrity: str) -> None:
    """Put the files of a package into its folder, which is complete or not there."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
        fresh, old = Path(scratch) / "new", Path(scratch) / "old"
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            for member in archive:
                extract(archive, member, fresh)
        (fresh / ".integrity").write_text(integrity, encoding="ascii")
        if folder.exists():
            folder.rename(old)
        fresh.rename(folder)


def extract(archive: tarfile.TarFile, member: tarfile.TarInfo, folder: Path) -> None:
    """Put a plain file of an archive into a folder, without the first part of its path."""
    parts = PurePosixPath(member.name).parts[1:]
    if not member.isfile() or not parts or ".." in parts:
        return
    path = folder.joinpath(*parts)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(archive.extractfile(member).read())
    path.chmod(0o755 if member.mode & 0o100 else 0o644)
