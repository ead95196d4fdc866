# SPDX-License-Identifier: GPL-3.0-or-later
"""What the zips say of the libraries in the module: licences, and a list for machines.

notices.py CACHE FOLDER    writes FOLDER/THIRD-PARTY.txt and FOLDER/bom.cdx.json (CycloneDX 1.5)
"""

import json
import sys
import uuid
from pathlib import Path

from component import Component
from libraries import Libraries

RULE = "=" * 78
NATIVE = Path(__file__).parents[2] / "native"


def third_party(libraries: Libraries) -> str:
    linked = [c for c in libraries.components.values() if c.linked]
    text = (
        "Granita's native module contains the libraries below.  Their notices follow the list.\n\n"
    )
    text += "".join(f"  {c.name} {c.version}  ({c.licence})\n" for c in linked)
    for component in linked:
        text += f"\n{RULE}\n{component.title or component.name} {component.version}\n{RULE}\n"
        folder = libraries.prefix(component) / "notices"
        for notice in component.notices:
            text += (folder / Path(notice).name).read_text(errors="replace").rstrip() + "\n\n"
    for notice in sorted(NATIVE.rglob("*.LICENSE.txt")):  # of data sets of others
        text += (
            f"\n{RULE}\n{notice.name.partition('.')[0]}\n{RULE}\n{notice.read_text().rstrip()}\n\n"
        )
    return text


def _entry(component: Component) -> dict:
    place = component.source.partition(":")
    entry = {
        "type": "library",
        "bom-ref": component.name,
        "name": component.name,
        "version": component.version,
        "licenses": [{"expression": component.licence}],
        # Of the archive that it was built from.
        "hashes": [{"alg": "SHA-256", "content": component.sha256}],
        "purl": f"pkg:generic/{component.name}@{component.version}",
        "properties": [{"name": "source", "value": place[2]}],
    }
    if component.patches:
        name = component.patches.partition(":")[2]
        entry["properties"] += [
            {"name": "patches", "value": name},
            {"name": "patches SHA-256", "value": component.patches_sha256},
        ]
    return entry


def bill(libraries: Libraries, version: str) -> str:
    """Without a date and with a serial number out of its content: equal builds have equal lists."""
    components = [_entry(c) for c in libraries.components.values() if c.linked]
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": "granita",
                "name": "granita",
                "version": version,
                "licenses": [{"license": {"id": "GPL-3.0-or-later"}}],
            }
        },
        "components": components,
        "dependencies": [
            {"ref": "granita", "dependsOn": [c["name"] for c in components]},
            *(
                {"ref": c.name, "dependsOn": list(c.needs)}
                for c in libraries.components.values()
                if c.linked
            ),
        ],
    }
    content = json.dumps(document, sort_keys=True)
    document["serialNumber"] = f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, content)}"
    return json.dumps(document, indent=1) + "\n"


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    libraries, folder = Libraries(Path(sys.argv[1])), Path(sys.argv[2])
    version = (Path(__file__).parents[2] / "VERSION").read_text().strip()
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "THIRD-PARTY.txt").write_text(third_party(libraries))
    (folder / "bom.cdx.json").write_text(bill(libraries, version))


if __name__ == "__main__":
    main()
