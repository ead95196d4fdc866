# SPDX-License-Identifier: GPL-3.0-or-later
"""Sources from the archives that this machine's apt and pip are configured for, pinned by SHA-256."""

import hashlib
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

from component import BuildError, Component

APT_HELPER = "/usr/lib/apt/apt-helper"


def sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def archives() -> list[str]:
    """Roots of the Debian archives in apt's configuration.  The pool of one holds all its releases."""
    listing = subprocess.run(
        ["apt-get", "indextargets", "--format", "$(REPO_URI)", "Created-By: Packages"],
        capture_output=True,
        text=True,
    ).stdout.split()
    roots = list(dict.fromkeys(root.rstrip("/") for root in listing if "debian" in root))
    if not roots:
        raise BuildError(
            "apt is not configured for a Debian archive (apt-get indextargets lists none)"
        )
    return roots


def fetch(source: str, digest: str, target: Path) -> None:
    """Make `target` the file that `source` names, unless it is there.  Raises BuildError."""
    if target.is_file() and sha256(target) == digest:
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(target.name + ".part")
    part.unlink(missing_ok=True)
    kind, _, place = source.partition(":")
    complaint = _from_debian(place, part) if kind == "debian" else _from_pypi(place, digest, part)
    if not part.is_file():
        raise BuildError(
            f"{source} cannot be fetched:\n{complaint}\n"
            f"Put a file with SHA-256 {digest} at {target} and run this again."
        )
    found = sha256(part)
    if found != digest:
        part.unlink()
        raise BuildError(f"{source} has SHA-256 {found}, not the pinned {digest}")
    part.rename(target)


def _from_debian(place: str, part: Path) -> str:
    complaints = []
    for root in archives():
        # apt takes files of a local archive where they lie; `copy:` makes it fetch them.
        root = "copy:" + root.removeprefix("file:") if root.startswith("file:") else root
        # A pool of updates has the path below it too.
        for uri in (f"{root}/pool/main/{place}", f"{root}/pool/updates/main/{place}"):
            run = subprocess.run(
                [APT_HELPER, "download-file", uri, str(part)], capture_output=True, text=True
            )
            if run.returncode == 0 and part.is_file():
                return ""
            complaints += [line for line in run.stderr.splitlines() if line.startswith("E:")][:1]
    return "\n".join(complaints)


def _from_pypi(requirement: str, digest: str, part: Path) -> str:
    folder = part.with_suffix(".folder")
    folder.mkdir(exist_ok=True)
    wanted = folder / "requirements.txt"
    wanted.write_text(f"{requirement} --hash=sha256:{digest}\n")
    run = subprocess.run(
        [sys.executable, "-m", "pip", "download", "-q", "--disable-pip-version-check", "--no-deps"]
        + ["--only-binary=:all:", "--require-hashes", "-d", str(folder), "-r", str(wanted)],
        capture_output=True,
        text=True,
    )
    for wheel in folder.glob("*.whl"):
        wheel.rename(part)
    shutil.rmtree(folder)
    return run.stderr.strip()


def unpack(archive: Path, folder: Path) -> None:
    """The content of `archive` in `folder`, without the one folder around it."""
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as wheel:
            wheel.extractall(folder)
        return
    with tarfile.open(archive) as tar:
        tops = {member.name.split("/")[0] for member in tar}
        tar.extractall(folder)  # pinned: nothing in it is hostile
    if len(tops) == 1:
        top = folder / tops.pop()
        inner = top.rename(folder / ".unpacked")
        for entry in list(inner.iterdir()):
            entry.rename(folder / entry.name)
        inner.rmdir()


def prepare(component: Component, downloads: Path, folder: Path) -> None:
    """Fetch, unpack, patch and edit the component's source into the empty `folder`."""
    archive = downloads / component.file()
    fetch(component.source, component.sha256, archive)
    patches = None
    if component.patches:
        patches = downloads / component.patches.rpartition("/")[2]
        fetch(component.patches, component.patches_sha256, patches)
    unpack(archive, folder)
    if patches:
        unpack(patches, folder / "debian")
        series = (folder / "debian/patches/series").read_text().splitlines()
        for name in [line.split("#")[0].strip() for line in series]:
            if name:
                with (folder / "debian/patches" / name).open() as patch:
                    run = ["patch", "-s", "-p1", "--no-backup-if-mismatch"]
                    subprocess.run(run, cwd=folder, stdin=patch, check=True)
    for edit in component.edits:
        paths = sorted(folder.glob(edit["file"]))
        if not paths:
            raise BuildError(f"{component.name}: there is no {edit['file']}")
        for path in paths:
            path.write_text(edited(path.read_text(), edit, f"{component.name}: {path.name}"))


def edited(text: str, edit: dict, name: str) -> str:
    """Without the lines in which the expression `drop` is found, or with `to` in the place of `from`."""
    if drop := edit.get("drop"):
        kept = [line for line in text.splitlines(keepends=True) if not re.search(drop, line)]
        if "".join(kept) == text:
            raise BuildError(f"{name} has no line with {drop}")
        return "".join(kept)
    if text.count(edit["from"]) != 1:
        raise BuildError(f"{name} does not hold once: {edit['from']}")
    return text.replace(edit["from"], edit["to"])
