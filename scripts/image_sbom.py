#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Writes the software bill of materials of a container image: an SPDX 2.3 document in JSON that lists Curvereg and every
Debian package installed in the image, with its version, architecture and source package.

The packages are read from the image's own /var/lib/dpkg/status. IMAGE is the archive that `docker save`, `podman save` or
`buildah push docker-archive:` writes; scripts/build_image.sh leaves one in build/image/curvereg.tar. With docker:
  docker save curvereg:latest -o curvereg.tar
--status takes a dpkg status file instead. The creation time is SOURCE_DATE_EPOCH, if set, else the present.

Exit status: 0 written, 1 the image or file cannot be read or lists no packages, 2 usage.
"""
import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import sys
import tarfile
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
STATUS_PATH = "var/lib/dpkg/status"
OPAQUE_MARKER = ".wh..wh..opq"  # in a layer: the folder's content of the layers below is gone


class UnusableInput(Exception):
    """The image or the status file cannot be used; the message says why."""


def project_version():
    found = re.search(r"^ *VERSION ([0-9.]+)$", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), re.M)
    if found is None:
        raise UnusableInput("CMakeLists.txt: no line with the project's VERSION")
    return found.group(1)


def normalised(name):
    return os.path.normpath(name).lstrip("/")


def status_in_layer(layer, status):
    """The status file after this layer: its own, None if the layer deletes it, else the one before."""
    for member in layer:
        folder, name = os.path.split(normalised(member.name))
        is_above = STATUS_PATH.startswith(folder + "/") or folder == ""
        if name == OPAQUE_MARKER and is_above:
            status = None
        elif name.startswith(".wh.") and (STATUS_PATH + "/").startswith(f"{folder}/{name[4:]}/".lstrip("/")):
            status = None
    for member in layer:
        if normalised(member.name) == STATUS_PATH and member.isfile():
            status = layer.extractfile(member).read()
    return status


def status_of_image(path):
    """The bytes of the dpkg status file that a container of the image would see."""
    try:
        with tarfile.open(path) as image:
            manifest = json.load(image.extractfile("manifest.json"))
            if len(manifest) != 1:
                raise UnusableInput(f"{path}: holds {len(manifest)} images, expected one")
            status = None
            for name in manifest[0]["Layers"]:
                with tarfile.open(fileobj=image.extractfile(name)) as layer:
                    status = status_in_layer(layer, status)
    except (OSError, tarfile.TarError, KeyError, ValueError) as error:
        raise UnusableInput(f"{path}: not an image archive of docker save: {error}") from error
    if status is None:
        raise UnusableInput(f"{path}: no /{STATUS_PATH} in the image")
    return status


def installed_packages(status):
    """The installed packages of a dpkg status file, as dictionaries of its fields, in order of name and architecture."""
    packages = []
    for paragraph in re.split(r"\n\s*\n", status.decode("utf-8", "replace")):
        fields = dict(re.findall(r"(?m)^([A-Za-z0-9-]+):[ \t]*(.*)$", paragraph))
        if fields.get("Status", "").split()[-1:] == ["installed"]:
            packages.append(fields)
    missing = [fields for fields in packages if not {"Package", "Version", "Architecture"} <= fields.keys()]
    if missing:
        raise UnusableInput(f"the dpkg status file has a package without name, version or architecture: {missing[0]}")
    if not packages:
        raise UnusableInput("the dpkg status file lists no installed package")
    return sorted(packages, key=lambda fields: (fields["Package"], fields["Architecture"]))


def source_of(package):
    """Name and version of the source package: "Source: NAME (VERSION)", each part only where it differs."""
    name, _, version = package.get("Source", package["Package"]).partition(" ")
    return name, version.strip("()") or package["Version"]


def package_url(package):
    quote = lambda text: urllib.parse.quote(text, safe="")
    name, version = source_of(package)
    return (f"pkg:deb/debian/{quote(package['Package'])}@{quote(package['Version'])}"
            f"?arch={quote(package['Architecture'])}&distro=debian-12&upstream={quote(f'{name}@{version}')}")


def spdx_package(package):
    name, version = source_of(package)
    return {
        "SPDXID": "SPDXRef-deb-" + re.sub(r"[^A-Za-z0-9.-]", "-", f"{package['Package']}-{package['Architecture']}"),
        "name": package["Package"],
        "versionInfo": package["Version"],
        "supplier": "Organization: Debian",
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "sourceInfo": f"built from source package {name} {version}",
        "licenseConcluded": "NOASSERTION",
        "licenseDeclared": "NOASSERTION",
        "copyrightText": "NOASSERTION",
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                          "referenceLocator": package_url(package)}],
    }


def spdx_document(packages, version, created):
    curvereg = {"SPDXID": "SPDXRef-curvereg", "name": "curvereg", "versionInfo": version,
                "supplier": "Organization: The Curvereg authors", "downloadLocation": "NOASSERTION",
                "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": "Apache-2.0",
                "copyrightText": "Copyright 2026 The Curvereg authors"}
    listed = [curvereg] + [spdx_package(package) for package in packages]
    digest = hashlib.sha256(json.dumps(listed, sort_keys=True).encode()).hexdigest()
    contained = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                  "relatedSpdxElement": package["SPDXID"]} for package in listed]
    return {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"curvereg-{version}-image",
        "documentNamespace": f"https://spdx.org/spdxdocs/curvereg-{version}-image-{digest}",
        "creationInfo": {"created": created.strftime("%Y-%m-%dT%H:%M:%SZ"),
                         "creators": ["Organization: The Curvereg authors", "Tool: curvereg-image_sbom"]},
        "packages": listed,
        "relationships": contained,
    }


def creation_time():
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    now = datetime.datetime.now(datetime.timezone.utc)
    return now if epoch is None else datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("image", nargs="?", metavar="IMAGE", help="archive of the image, as docker save writes it")
    source.add_argument("--status", metavar="FILE", help="a dpkg status file instead of an image")
    parser.add_argument("--out", metavar="FILE", help="default: standard output")
    arguments = parser.parse_args()
    try:
        status = status_of_image(arguments.image) if arguments.image else pathlib.Path(arguments.status).read_bytes()
        document = spdx_document(installed_packages(status), project_version(), creation_time())
        text = json.dumps(document, indent=1) + "\n"
        if arguments.out:
            pathlib.Path(arguments.out).write_text(text, encoding="utf-8")
        else:
            sys.stdout.write(text)
    except (OSError, UnusableInput) as error:
        sys.exit(f"image_sbom.py: {error}")


if __name__ == "__main__":
    main()
