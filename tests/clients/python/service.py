# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""What the test of the Python client stands on: generated code, a real server, simulated scans, checksums."""
import json
import pathlib
import subprocess
import sys
import time


def generate(proto_root, grpc_proto_root, plugin, folder):
    """Python modules of the contract, made by Debian's protoc and plugin, and puts them on the path."""
    ours = sorted(str(path.relative_to(proto_root)) for path in proto_root.glob("**/*.proto"))
    common = ["protoc", f"--plugin=protoc-gen-grpc_python={plugin}", f"--python_out={folder}",
              f"--grpc_python_out={folder}"]
    subprocess.run([*common, f"--proto_path={proto_root}", *ours], check=True)
    standard = ["grpc/health/v1/health.proto", "grpc/reflection/v1alpha/reflection.proto"]
    subprocess.run([*common, f"--proto_path={grpc_proto_root}", *standard], check=True)
    sys.path.insert(0, str(folder))
    # grpcio owns the package grpc, and may own google: let both reach the generated code, too.
    import google
    import grpc
    for package in (google, grpc):
        package.__path__.append(str(pathlib.Path(folder) / package.__name__))


class Server:
    """A curvereg-server on free loopback ports, with a data folder of its own."""

    def __init__(self, program, folder):
        self.log_path = folder / "server.log"
        ports_file = folder / "ports.json"
        arguments = [program, "--listen", "127.0.0.1:0", "--ops-listen", "127.0.0.1:0", "--data-dir", folder / "data",
                     "--drain-delay-ms", "0", "--grace-seconds", "5", "--ports-file", ports_file]
        with open(self.log_path, "wb") as log:
            self._process = subprocess.Popen([str(argument) for argument in arguments], stdout=log, stderr=log)
        deadline = time.monotonic() + 60
        while not ports_file.exists():
            if self._process.poll() is not None or time.monotonic() > deadline:
                self._process.kill()
                raise RuntimeError(f"the server did not start:\n{self.log()}")
            time.sleep(0.02)
        self.address = f"127.0.0.1:{json.loads(ports_file.read_text())['grpc_port']}"

    def log(self):
        return self.log_path.read_text(errors="replace")

    def stop(self):
        """SIGTERM; returns the exit status."""
        self._process.terminate()
        try:
            return self._process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self._process.kill()
            raise


def simulate(curvereg, folder):
    """Two small scans three metres apart: the packed float32 x y z of each, and their poses (x y z qx qy qz qw)."""
    subprocess.run([str(curvereg), "simulate", "--out", str(folder), "--preset", "sparse", "--scans", "2", "--columns",
                    "700", "--rows", "40", "--step", "3", "--threads", "1"], check=True, stdout=subprocess.DEVNULL)
    clouds = [(folder / name).read_bytes().split(b"DATA binary\n", 1)[1] for name in ("0000.pcd", "0001.pcd")]
    lines = (folder / "poses.txt").read_text().splitlines()
    return clouds, [[float(word) for word in line.split()[1:]] for line in lines if not line.startswith("#")]


def _crc32c_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


_CRC32C = _crc32c_table()


def crc32c(data):
    """CRC-32C (Castagnoli)."""
    value = 0xFFFFFFFF
    for byte in data:
        value = value >> 8 ^ _CRC32C[(value ^ byte) & 0xFF]
    return value ^ 0xFFFFFFFF


def rotate(q, v):
    """The vector v turned by the unit quaternion q = x y z w."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    cross = [y * t[2] - z * t[1], z * t[0] - x * t[2], x * t[1] - y * t[0]]
    return [v[i] + w * t[i] + cross[i] for i in range(3)]
