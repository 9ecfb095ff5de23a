#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""The bill of materials of made-up images, and of this machine's own packages as dpkg-query lists them."""
import io
import json
import os
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts/image_sbom.py"
STATUS = """\
Package: libpng16-16
Status: install ok installed
Architecture: amd64
Source: libpng1.6
Version: 1.6.39-2

Package: removed
Status: deinstall ok config-files
Architecture: amd64
Version: 1

Package: libstdc++6
Status: install ok installed
Architecture: amd64
Source: gcc-12 (12.2.0-14)
Version: 12.2.0-14+deb12u1
Description: GNU Standard C++ Library v3
 Version: 99 in a long description is not the version.

Package: zlib1g
Status: hold ok installed
Architecture: amd64
Source: zlib
Version: 1:1.2.13.dfsg-1
"""


def tar_of(files):
    """An archive of {name: bytes}."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as archive:
        for name, content in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
    return buffer.getvalue()


def image_of(*layers):
    names = [f"layer{i}.tar" for i in range(len(layers))]
    manifest = json.dumps([{"Config": "config.json", "RepoTags": ["curvereg:latest"], "Layers": names}]).encode()
    return tar_of({"manifest.json": manifest, **dict(zip(names, map(tar_of, layers)))})


class ImageSbom(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_script(self, *arguments, **environment):
        return subprocess.run([SCRIPT, *arguments], env={**os.environ, **environment}, capture_output=True, text=True)

    def write(self, name, content):
        (self.folder / name).write_bytes(content)
        return str(self.folder / name)

    def versions(self, run):
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        return {package["name"]: package["versionInfo"] for package in json.loads(run.stdout)["packages"]}

    def test_lists_what_is_installed_with_its_source(self):
        run = self.run_script("--status", self.write("status", STATUS.encode()), SOURCE_DATE_EPOCH="86400")
        versions = self.versions(run)
        del versions["curvereg"]
        self.assertEqual(versions, {"libpng16-16": "1.6.39-2", "libstdc++6": "12.2.0-14+deb12u1",
                                    "zlib1g": "1:1.2.13.dfsg-1"})
        document = json.loads(run.stdout)
        self.assertEqual(document["spdxVersion"], "SPDX-2.3")
        self.assertEqual(document["creationInfo"]["created"], "1970-01-02T00:00:00Z")
        urls = [package["externalRefs"][0]["referenceLocator"] for package in document["packages"][1:]]
        self.assertEqual(urls, [
            "pkg:deb/debian/libpng16-16@1.6.39-2?arch=amd64&distro=debian-12&upstream=libpng1.6%401.6.39-2",
            "pkg:deb/debian/libstdc%2B%2B6@12.2.0-14%2Bdeb12u1?arch=amd64&distro=debian-12&upstream=gcc-12%4012.2.0-14",
            "pkg:deb/debian/zlib1g@1%3A1.2.13.dfsg-1?arch=amd64&distro=debian-12&upstream=zlib%401%3A1.2.13.dfsg-1"])
        ids = [package["SPDXID"] for package in document["packages"]]
        self.assertEqual(len(set(ids)), len(ids))
        self.assertEqual([relation["relatedSpdxElement"] for relation in document["relationships"]], ids)

    def test_the_version_of_curvereg_is_the_projects(self):
        run = self.run_script("--status", self.write("status", STATUS.encode()))
        self.assertIn(f"VERSION {self.versions(run)['curvereg']}\n", (ROOT / "CMakeLists.txt").read_text())

    def test_the_last_layer_counts(self):
        old = STATUS.replace("1.6.39-2", "1.6.37-1").encode()
        image = image_of({"var/lib/dpkg/status": old}, {"./var/lib/dpkg/status": STATUS.encode()}, {"etc/motd": b""})
        self.assertEqual(self.versions(self.run_script(self.write("image.tar", image)))["libpng16-16"], "1.6.39-2")

    def test_a_deleted_status_file_is_an_error(self):
        for marker in ["var/lib/dpkg/.wh.status", "var/lib/.wh.dpkg", "var/lib/dpkg/.wh..wh..opq", ".wh.var"]:
            image = image_of({"var/lib/dpkg/status": STATUS.encode()}, {marker: b""})
            run = self.run_script(self.write("image.tar", image))
            self.assertEqual((run.returncode, run.stdout), (1, ""), marker)
            self.assertIn("no /var/lib/dpkg/status in the image", run.stderr)

    def test_deleting_something_else_leaves_it(self):
        image = image_of({"var/lib/dpkg/status": STATUS.encode()}, {"var/lib/dpkg/.wh.status-old": b"", "var/.wh.log": b""})
        self.assertIn("zlib1g", self.versions(self.run_script(self.write("image.tar", image))))

    def test_unusable_input_names_the_file(self):
        for name, content in [("empty", b""), ("text", b"no archive"), ("other.tar", tar_of({"a": b"b"}))]:
            path = self.write(name, content)
            run = self.run_script(path)
            self.assertEqual(run.returncode, 1)
            self.assertIn(f"{path}: not an image archive", run.stderr)
        run = self.run_script("--status", self.write("status", b"Package: a\nStatus: deinstall ok config-files\n"))
        self.assertEqual(run.returncode, 1)
        self.assertIn("lists no installed package", run.stderr)

    def test_this_machine_as_dpkg_query_lists_it(self):
        if shutil.which("dpkg-query") is None:
            self.skipTest("dpkg-query is missing")
        listed = subprocess.run(["dpkg-query", "-W", "-f", "${Package} ${Version} ${db:Status-Status}\n"], check=True,
                                capture_output=True, text=True).stdout.splitlines()
        expected = {tuple(line.split()[:2]) for line in listed if line.endswith(" installed")}
        out = self.folder / "sbom.json"
        run = self.run_script("--status", "/var/lib/dpkg/status", "--out", str(out))
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))
        packages = json.loads(out.read_text())["packages"][1:]
        self.assertEqual({(package["name"], package["versionInfo"]) for package in packages}, expected)


if __name__ == "__main__":
    unittest.main()
