#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Writes what a package of adit is made of as a bill of materials in SPDX 2.3 (JSON).

bill_of_materials.py TARBALL FILE.spdx.json

TARBALL is what `./dev package` made. Its COMPONENTS.txt has a line for each part: a Debian package with its version and
its source, or a package of npm. The document names the tarball by its SHA-256, so that it can be checked against it. The
licences of the parts lie in the tarball as Debian has written them, which is not SPDX's form: NOASSERTION stands for each.
"""
import datetime
import hashlib
import json
import pathlib
import re
import sys
import tarfile

DEBIAN = re.compile(r"(?P<name>\S+) (?P<version>\S+) \(source (?P<source>\S+) (?P<source_version>[^)]+)\)")
NPM = re.compile(r"\S+ \S+ \(npm package (?P<name>\S+) (?P<version>[^,]+), (?P<license>\S+) licence\)")


def fail(message):
    print(f"bill_of_materials.py: {message}", file=sys.stderr)
    sys.exit(1)


def components(text, distribution):
    """A package of SPDX for each line that names a part, in their order."""
    found = []
    for line in text.splitlines():
        if debian := DEBIAN.fullmatch(line):
            purl = f"pkg:deb/debian/{debian['name']}@{debian['version']}?distro={distribution}"
            more = {"sourceInfo": f"Debian source package {debian['source']} {debian['source_version']}",
                    "supplier": "Organization: Debian", "licenseDeclared": "NOASSERTION"}
            name, version = debian["name"], debian["version"]
        elif npm := NPM.fullmatch(line):
            name, version = npm["name"], npm["version"]
            purl = f"pkg:npm/{name}@{version}"
            more = {"licenseDeclared": npm["license"]}
        else:
            continue
        found.append({
            "SPDXID": "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", f"{purl.split('/')[0][4:]}-{name}"),
            "name": name, "versionInfo": version, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "copyrightText": "NOASSERTION",
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": purl}],
            **more})
    return found


def document(tarball):
    content = tarball.read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    with tarfile.open(tarball) as archive:
        names = [name for name in archive.getnames() if name.endswith("/COMPONENTS.txt")]
        if len(names) != 1:
            fail(f"{tarball} has no COMPONENTS.txt: what `./dev package` made is expected")
        text = archive.extractfile(names[0]).read().decode()
        stamp = archive.getmember(names[0]).mtime
    version = tarball.name.split("-")[1]
    parts = components(text, "debian-12")
    if not parts:
        fail(f"{names[0]} of {tarball} names no part")
    created = datetime.datetime.fromtimestamp(stamp, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    program = {
        "SPDXID": "SPDXRef-adit", "name": "adit", "versionInfo": version, "packageFileName": tarball.name,
        "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "supplier": "Organization: The adit authors",
        "checksums": [{"algorithm": "SHA256", "checksumValue": digest}],
        "licenseConcluded": "GPL-3.0-only", "licenseDeclared": "Apache-2.0",
        "licenseComments": "The source is under the Apache License; the program also has CHOLMOD's supernodal "
                           "factorisation, which is under the GPL, version 2 or later.",
        "copyrightText": "2026 The adit authors"}
    relationships = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-adit"}]
    relationships += [{"spdxElementId": "SPDXRef-adit", "relationshipType": "CONTAINS", "relatedSpdxElement": part["SPDXID"]}
                      for part in parts]
    return {
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
        "name": tarball.name.removesuffix(".tar.gz"),
        "documentNamespace": f"https://spdx.org/spdxdocs/{tarball.name.removesuffix('.tar.gz')}-{digest[:32]}",
        "creationInfo": {"created": created, "creators": ["Tool: adit-bill_of_materials"]},
        "packages": [program, *parts], "relationships": relationships}


def main():
    if len(sys.argv) != 3:
        fail("TARBALL and FILE.spdx.json are expected")
    tarball = pathlib.Path(sys.argv[1])
    if not tarball.is_file():
        fail(f"{tarball} is not there")
    pathlib.Path(sys.argv[2]).write_text(json.dumps(document(tarball), indent=1) + "\n")


if __name__ == "__main__":
    main()
