#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Holds docs/operations.md equal to the code, the alarms and a running server.

usage: operations_test.py CURVEREG_SERVER CURVEREG
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
SERVER, CURVEREG = sys.argv[1:3] if len(sys.argv) > 2 else ("", "")
DOCUMENT = (ROOT / "docs/operations.md").read_text()


def rows(heading, table=0):
    """Cells of the table-th table of a section, without its two header lines."""
    section = DOCUMENT.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    tables = re.findall(r"(?:^\|.*\n?)+", section, re.M)
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in tables[table].splitlines()[2:]]


def names(cells):
    return [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]


def sources(folder, pattern="*.cc"):
    return "\n".join(path.read_text() for path in sorted((ROOT / folder).rglob(pattern)))


def base_name(sample):
    return re.sub(r"_(bucket|sum|count)$", "", sample)


class Documents(unittest.TestCase):
    maxDiff = None

    def test_error_reasons_and_codes(self):
        registry = re.findall(
            r"// ([A-Z_]+): [^\n]*\n(?:  //[^\n]*\n)*  ERROR_REASON_([A-Z_]+) = [1-9]",
            (ROOT / "proto/curvereg/v1/error_reason.proto").read_text(),
        )
        self.assertGreater(len(registry), 25)
        self.assertEqual([(names([row[0]])[0], row[1]) for row in rows("Errors")], [(b, a) for a, b in registry])

    def test_limits(self):
        section = re.search(r"struct LimitsConfig \{(.*?)\n\};", (ROOT / "server/settings/server_config.h").read_text(), re.S)
        fields = re.findall(r"(\w+) = ", section.group(1))
        self.assertEqual(names(row[0] for row in rows("Limits")), [f"limits.{field}" for field in fields])
        reasons = {names([row[0]])[0] for row in rows("Errors")}
        tests = sources("tests/server")
        for row in rows("Limits"):
            for reason in re.findall(r"`([A-Z_]{5,})`", row[1]):
                self.assertIn(reason, reasons)
                self.assertRegex(tests, f"ERROR_REASON_{reason}\\b|\"{reason}\"", "no test goes beyond this limit")

    def test_log_events(self):
        logged = set(re.findall(r'\b[Ll]ogger_?\)?(?:\.|->)(?:Debug|Info|Warning|Error)\(\s*"(\w+)"', sources("server")))
        logged |= set(re.findall(r'\bWrite\([^"]*"(\w+)"', sources("server", "logging.cc")))
        self.assertGreater(len(logged), 5)
        self.assertEqual(set(names(row[0] for row in rows("Log", 1))), logged)

    def test_log_fields(self):
        told = {names([row[0]])[0]: set(names([row[2]])) for row in rows("Log", 1)}
        lines = re.findall(r'\b(?:[Ll]ogger_?\)?(?:\.|->)(?:Debug|Info|Warning|Error)|Write)\((?:[\w:]+, )?\s*"(\w+)",\s*'
                           r"\{(\{.*?\})\}\);", sources("server"), re.S)
        self.assertGreater(len(lines), 15)
        for event, fields in lines:
            self.assertEqual(told[event], set(re.findall(r'\{"(\w+)",', fields)), event)

    def test_options_of_the_client(self):
        code = (ROOT / "cli/service_access.cc").read_text()
        section = DOCUMENT.split("**Clients.**")[1].split("\n## ")[0]
        told = set(re.findall(r"`--([a-z-]+)", section))
        self.assertEqual(told, set(re.findall(r'Add(?:Option|Flag)\("--([a-z-]+)', code)))
        self.assertEqual(set(re.findall(r"CURVEREG_\w+", section)), set(re.findall(r'"(CURVEREG_\w+)"', code)))

    def test_alarms(self):
        alerts = (ROOT / "docker/alerts.yml").read_text()
        defined = list(zip(re.findall(r"alert: (\w+)", alerts), re.findall(r"severity: (\w+)", alerts)))
        self.assertEqual([(names([row[0]])[0], row[1]) for row in rows("Alarms")], defined)
        documented = set(names(row[0] for row in rows("Metrics")))
        expressions = re.sub(r"(?m)^\s*(#|summary:).*$", "", alerts)
        used = {base_name(name) for name in re.findall(r"\b(?:curvereg|grpc|process)_\w+\b", expressions)}
        used -= {"grpc_method", "grpc_code", "grpc_service"}
        self.assertGreater(len(used), 15)
        self.assertEqual(used - documented, set())

    def test_metrics_are_in_the_code(self):
        code = sources("server")
        for name in names(row[0] for row in rows("Metrics")):
            self.assertIn(f'"{name}"', code)

    def test_image_variables(self):
        dockerfile = (ROOT / "docker/Dockerfile").read_text()
        set_there = dict(re.findall(r"\b(CURVEREG_\w+)=(\S+)", re.search(r"(?s)\nENV .*?\nUSER", dockerfile).group(0)))
        told = {names([row[0]])[0]: names([row[1]])[0] for row in rows("Run")}
        self.assertEqual(told, set_there)


class RunningServer(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        folder = cls.folder.name
        environment = {name: value for name, value in os.environ.items() if not name.startswith("CURVEREG_")}
        cls.log = open(f"{folder}/log", "w+")
        cls.server = subprocess.Popen(
            [SERVER, "--listen=127.0.0.1:0", "--ops-listen=127.0.0.1:0", f"--ports-file={folder}/ports",
             f"--data-dir={folder}/data", "--log-format=json", "--drain-delay-ms=0"],
            env=environment, stderr=cls.log)
        ports = pathlib.Path(folder, "ports")
        for _ in range(300):
            if ports.exists() or cls.server.poll() is not None:
                break
            time.sleep(0.1)
        if not ports.exists():
            cls.tearDownClass()
            raise AssertionError("the server is not ready within 30 s")
        port, cls.ops_port = json.loads(ports.read_text()).values()
        run = lambda *arguments: subprocess.run([CURVEREG, *arguments], env=environment, check=True,
                                                stdout=subprocess.DEVNULL)
        run("simulate", "--preset", "sparse", "--scans", "2", "--out", f"{folder}/scans")
        run("register", f"{folder}/scans/0001.pcd", f"{folder}/scans/0000.pcd", "--server", f"127.0.0.1:{port}")
        # A name that no scan has: an error with a reason.
        subprocess.run([CURVEREG, "register", "scans/" + 32 * "0", f"{folder}/scans/0000.pcd", "--server",
                        f"127.0.0.1:{port}"], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.metrics = cls.get("/metrics")
        cls.server.send_signal(signal.SIGTERM)
        cls.exit_status = cls.server.wait(60)
        cls.log.seek(0)
        cls.lines = [json.loads(line) for line in cls.log]

    @classmethod
    def tearDownClass(cls):
        cls.server.kill()
        cls.server.wait()
        cls.log.close()
        cls.folder.cleanup()

    @classmethod
    def get(cls, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{cls.ops_port}{path}", timeout=10) as answer:
            return answer.read().decode()

    def test_exit_status(self):
        self.assertEqual(self.exit_status, 0)

    def test_metrics(self):
        documented = {names([row[0]])[0]: row for row in rows("Metrics")}
        served = dict(re.findall(r"# TYPE (\w+) (\w+)", self.metrics))
        # A family appears with its first event; no call was rejected here because of a limit.
        self.assertEqual(set(served) | {"curvereg_rejected_total"}, set(documented))
        self.assertEqual(served, {name: documented[name][1] for name in served})
        for name in served:
            samples = re.findall(rf"(?m)^{name}(?:_bucket|_sum|_count)?(?:{{(.*?)}})? ", self.metrics)
            labels = {label for sample in samples for label in re.findall(r'(\w+)="', sample)} - {"le"}
            self.assertEqual(labels, set(filter(None, documented[name][2].split(", "))), name)

    def test_promtool_finds_no_fault(self):
        if shutil.which("promtool") is None:
            self.skipTest("promtool (Debian: prometheus) is missing")
        check = subprocess.run(["promtool", "check", "metrics"], input=self.metrics, capture_output=True, text=True)
        self.assertEqual((check.returncode, check.stdout + check.stderr), (0, ""))

    def test_log(self):
        events = {line["event"] for line in self.lines}
        self.assertEqual(events - set(names(row[0] for row in rows("Log", 1))), set())
        documented = set(names(row[0] for row in rows("Log")))
        calls = [line for line in self.lines if line["event"] == "call"]
        self.assertGreaterEqual(len(calls), 2)
        self.assertEqual({field for line in calls for field in line}, documented)

    def test_settings(self):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("CURVEREG_")}
        printed = subprocess.run([SERVER, "--print-config"], env=environment, check=True, capture_output=True, text=True)
        section, keys = "", []
        for line in printed.stdout.splitlines():
            if header := re.match(r"\[(\w+)\]", line):
                section = header.group(1) + "."
            elif key := re.match(r"(\w+) = ", line):
                keys.append(section + key.group(1))
        self.assertEqual([key for key in keys if key.startswith("limits.")], names(row[0] for row in rows("Limits")))
        told = re.findall(r"(?m)^\| `([a-z_.]+)` \|", (ROOT / "docs/settings.md").read_text())
        self.assertEqual(told, keys)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
