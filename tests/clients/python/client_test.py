#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""The contract as a Python program speaks it, with Debian's python3-grpcio, against the real server.

usage: client_test.py SERVER CURVEREG PROTO_ROOT GRPC_PROTO_ROOT GRPC_PYTHON_PLUGIN
"""
import hashlib
import math
import pathlib
import queue
import shutil
import sys
import tempfile
import unittest

try:
    import grpc
    import google.protobuf  # noqa: F401
except ImportError as error:
    print(f"SKIPPED: {error.name} is not installed (Debian: python3-grpcio, python3-protobuf)", file=sys.stderr)
    sys.exit(77)

import service

CHUNK_BYTES = 4096
TIMEOUT_S = 60


class ClientTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="curvereg_python_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        generated = cls.folder / "generated"
        generated.mkdir()
        service.generate(PROTO_ROOT, GRPC_PROTO_ROOT, PLUGIN, generated)
        cls.import_generated()
        cls.clouds, cls.poses = service.simulate(CURVEREG, cls.folder / "yard")
        cls.server = service.Server(SERVER, cls.folder)
        cls.addClassCleanup(cls.stop_server)
        cls.channel = grpc.insecure_channel(cls.server.address)
        cls.addClassCleanup(cls.channel.close)
        cls.registration = cls.registration_grpc.RegistrationServiceStub(cls.channel)
        cls.scans = cls.scan_grpc.ScanServiceStub(cls.channel)

    @classmethod
    def import_generated(cls):
        from curvereg.v1 import point_cloud_pb2, registration_pb2, registration_service_pb2, scan_service_pb2
        from curvereg.v1 import registration_service_pb2_grpc, scan_service_pb2_grpc
        from google.rpc import error_details_pb2, status_pb2
        cls.cloud_pb2, cls.result_pb2 = point_cloud_pb2, registration_pb2
        cls.registration_pb2, cls.registration_grpc = registration_service_pb2, registration_service_pb2_grpc
        cls.scan_pb2, cls.scan_grpc = scan_service_pb2, scan_service_pb2_grpc
        cls.details_pb2, cls.status_pb2 = error_details_pb2, status_pb2

    @classmethod
    def stop_server(cls):
        status = cls.server.stop()
        if status != 0:
            raise AssertionError(f"the server ended with {status}:\n{cls.server.log()}")

    # What several tests share.

    def header(self, cloud):
        float32 = self.cloud_pb2.NUMERIC_TYPE_FLOAT32
        fields = [self.cloud_pb2.PointField(name=name, offset=4 * i, type=float32) for i, name in enumerate("xyz")]
        return self.cloud_pb2.PointCloudHeader(
            frame_id="mast", point_count=len(cloud) // 12, encoding=self.cloud_pb2.POINT_ENCODING_RAW,
            layout=self.cloud_pb2.PointLayout(fields=fields, point_stride=12))

    def inline(self, cloud):
        return self.registration_pb2.ScanInput(
            inline_scan=self.cloud_pb2.PointCloud(header=self.header(cloud), data=cloud))

    def register(self, source, target, **arguments):
        request = self.registration_pb2.RegisterScansRequest(source=source, target=target, **arguments)
        return self.registration.RegisterScans(request, timeout=TIMEOUT_S)

    def assert_near_truth(self, t_target_source):
        """The second scan's pose in the frame of the first, against the simulator's."""
        target, source = self.poses
        inverse = [-target[3], -target[4], -target[5], target[6]]
        expected = service.rotate(inverse, [source[i] - target[i] for i in range(3)])
        found = t_target_source.translation
        self.assertLess(math.dist(expected, [found.x, found.y, found.z]), 0.1)
        q = t_target_source.rotation
        forward_world = service.rotate(source[3:], [1.0, 0.0, 0.0])
        self.assertLess(math.dist(service.rotate(inverse, forward_world),
                                  service.rotate([q.x, q.y, q.z, q.w], [1.0, 0.0, 0.0])), 0.02)

    def start(self, upload, cloud):
        digest = self.cloud_pb2.Digest(algorithm=self.cloud_pb2.DIGEST_ALGORITHM_SHA256,
                                       value=hashlib.sha256(cloud).digest())
        return self.scan_pb2.UploadScanRequest(start=self.scan_pb2.UploadScanStart(
            upload=upload, header=self.header(cloud), payload_bytes=len(cloud), payload_digest=digest))

    def chunk(self, cloud, offset):
        data = cloud[offset:offset + CHUNK_BYTES]
        return self.scan_pb2.UploadScanRequest(chunk=self.scan_pb2.PayloadChunk(
            offset=offset, data=data, crc32c=service.crc32c(data)))

    def upload(self, upload, cloud):
        """Sends what is missing; returns the offset it went on from and `done`."""
        to_send = queue.Queue()
        to_send.put(self.start(upload, cloud))
        call = self.scans.UploadScan(iter(to_send.get, None), timeout=TIMEOUT_S)
        first = next(call)
        if first.HasField("done"):
            return len(cloud), first.done
        for offset in range(first.ready.committed_offset, len(cloud), CHUNK_BYTES):
            to_send.put(self.chunk(cloud, offset))
        to_send.put(self.scan_pb2.UploadScanRequest(finish=self.scan_pb2.UploadScanFinish()))
        to_send.put(None)
        *progress, last = call
        self.assertEqual(progress[-1].progress.committed_offset, len(cloud))
        return first.ready.committed_offset, last.done

    def upload_until_cut(self, upload, cloud, wanted):
        """Sends a part of the scan and breaks the stream off once the server has `wanted` bytes."""
        to_send = queue.Queue()
        to_send.put(self.start(upload, cloud))
        call = self.scans.UploadScan(iter(to_send.get, None), timeout=TIMEOUT_S)
        for offset in range(next(call).ready.committed_offset, wanted, CHUNK_BYTES):
            to_send.put(self.chunk(cloud, offset))
        while next(call).progress.committed_offset < wanted:
            pass
        call.cancel()
        to_send.put(None)

    def details(self, error, kind):
        """Details of one kind from grpc-status-details-bin."""
        trailers = {item.key: item.value for item in error.trailing_metadata()}
        status = self.status_pb2.Status.FromString(trailers["grpc-status-details-bin"])
        self.assertEqual(status.code, error.code().value[0])
        found = []
        for any_detail in status.details:
            detail = kind()
            if any_detail.Unpack(detail):
                found.append(detail)
        return found

    def assert_fails(self, code, reason, call):
        with self.assertRaises(grpc.RpcError) as raised:
            call()
        self.assertEqual(raised.exception.code(), code)
        infos = self.details(raised.exception, self.details_pb2.ErrorInfo)
        self.assertEqual([(info.domain, info.reason) for info in infos], [("curvereg", reason)])
        return raised.exception

    # The tests.

    def test_registers_inline_scans(self):
        result = self.register(self.inline(self.clouds[1]), self.inline(self.clouds[0])).result
        self.assertTrue(result.verdict.accepted, result)
        self.assert_near_truth(result.t_target_source)
        self.assertEqual(result.evidence.source_point_count, len(self.clouds[1]) // 12)
        self.assertEqual(len(result.covariance.upper_triangle), 21)
        self.assertEqual(result.seed, 1)

    def test_summary_is_small(self):
        answer = self.register(self.inline(self.clouds[1]), self.inline(self.clouds[0]),
                               view=self.registration_pb2.RESULT_VIEW_SUMMARY)
        self.assertEqual(answer.WhichOneof("answer"), "summary")
        self.assertTrue(answer.summary.accepted)
        self.assertLessEqual(answer.summary.ByteSize(), 200)

    def test_uploads_resumes_downloads_lists_deletes(self):
        cloud = self.clouds[0]
        wanted = 5 * CHUNK_BYTES
        self.upload_until_cut("uploads/python-cut", cloud, wanted)
        state = self.scans.GetUpload(self.scan_pb2.GetUploadRequest(upload="uploads/python-cut"), timeout=TIMEOUT_S)
        self.assertEqual((state.committed_offset, state.payload_bytes), (wanted, len(cloud)))
        resumed_at, done = self.upload("uploads/python-cut", cloud)
        self.assertEqual(resumed_at, wanted)
        self.assertFalse(done.already_stored)
        name = done.scan.name
        self.assertRegex(name, "^scans/[0-9a-f]{32}$")
        self.assertEqual(done.scan.finite_point_count, len(cloud) // 12)

        _, again = self.upload("uploads/python-again", cloud)
        self.assertTrue(again.already_stored)
        self.assertEqual(again.scan, done.scan)

        for offset in (0, 12345):
            request = self.scan_pb2.DownloadScanRequest(name=name, offset=offset, chunk_bytes=CHUNK_BYTES)
            first, *rest = self.scans.DownloadScan(request, timeout=TIMEOUT_S)
            self.assertEqual(first.scan, done.scan)
            for answer in rest:
                self.assertEqual(answer.chunk.crc32c, service.crc32c(answer.chunk.data))
            self.assertEqual(b"".join(answer.chunk.data for answer in rest), cloud[offset:])

        result = self.register(self.inline(self.clouds[1]), self.registration_pb2.ScanInput(name=name)).result
        self.assert_near_truth(result.t_target_source)
        self.assertEqual(result.target_digest, done.scan.content_digest)

        listed = self.scans.ListScans(self.scan_pb2.ListScansRequest(), timeout=TIMEOUT_S)
        self.assertEqual([scan.name for scan in listed.scans].count(name), 1)
        self.scans.DeleteScan(self.scan_pb2.DeleteScanRequest(name=name), timeout=TIMEOUT_S)
        self.assert_fails(grpc.StatusCode.NOT_FOUND, "SCAN_NOT_FOUND",
                          lambda: self.scans.GetScan(self.scan_pb2.GetScanRequest(name=name), timeout=TIMEOUT_S))

    def test_invalid_fields_are_named(self):
        cut = self.inline(self.clouds[0])
        cut.inline_scan.header.layout.point_stride = 8
        error = self.assert_fails(grpc.StatusCode.INVALID_ARGUMENT, "INVALID_FIELD",
                                  lambda: self.register(self.inline(self.clouds[1]), cut))
        (bad_request,) = self.details(error, self.details_pb2.BadRequest)
        self.assertRegex(bad_request.field_violations[0].field, r"^target\.inline_scan\.header\.layout")
        (request_info,) = self.details(error, self.details_pb2.RequestInfo)
        self.assertTrue(request_info.request_id)

    def test_corrupt_chunks_are_refused(self):
        corrupt = self.chunk(self.clouds[0], 0)
        corrupt.chunk.crc32c ^= 1
        messages = [self.start("uploads/python-corrupt", self.clouds[0]), corrupt]
        self.assert_fails(grpc.StatusCode.DATA_LOSS, "CHECKSUM_MISMATCH",
                          lambda: list(self.scans.UploadScan(iter(messages), timeout=TIMEOUT_S)))

    def test_methods_and_pictures(self):
        answer = self.registration.ListMethods(self.registration_pb2.ListMethodsRequest(), timeout=TIMEOUT_S)
        self.assertEqual(answer.methods[0].method, self.result_pb2.METHOD_CURVELET)
        self.assertGreater(answer.limits.max_scan_points, 0)
        request = self.registration_pb2.RenderScanRequest(scan=self.inline(self.clouds[0]),
                                                          kinds=[self.registration_pb2.PICTURE_KIND_VIEWS])
        pictures = self.registration.RenderScan(request, timeout=TIMEOUT_S).pictures
        self.assertTrue(pictures)
        self.assertTrue(all(picture.png.startswith(b"\x89PNG\r\n\x1a\n") for picture in pictures))

    def test_health(self):
        from grpc.health.v1 import health_pb2, health_pb2_grpc
        stub = health_pb2_grpc.HealthStub(self.channel)
        for name in ("", "curvereg.v1.RegistrationService", "curvereg.v1.ScanService"):
            answer = stub.Check(health_pb2.HealthCheckRequest(service=name), timeout=TIMEOUT_S)
            self.assertEqual(answer.status, health_pb2.HealthCheckResponse.SERVING, name)

    def test_reflection_resolves_what_it_lists(self):
        from grpc.reflection.v1alpha import reflection_pb2, reflection_pb2_grpc
        stub = reflection_pb2_grpc.ServerReflectionStub(self.channel)
        ask = reflection_pb2.ServerReflectionRequest
        (listed,) = stub.ServerReflectionInfo(iter([ask(list_services="")]), timeout=TIMEOUT_S)
        names = {service_.name for service_ in listed.list_services_response.service}
        self.assertLessEqual({"curvereg.v1.RegistrationService", "curvereg.v1.ScanService", "grpc.health.v1.Health"},
                             names)
        for answer in stub.ServerReflectionInfo(iter([ask(file_containing_symbol=name) for name in sorted(names)]),
                                                timeout=TIMEOUT_S):
            self.assertTrue(answer.HasField("file_descriptor_response"), answer)


if __name__ == "__main__":
    SERVER, CURVEREG, PROTO_ROOT, GRPC_PROTO_ROOT, PLUGIN = (pathlib.Path(path).absolute() for path in sys.argv[1:6])
    for needed in (GRPC_PROTO_ROOT / "grpc/health/v1/health.proto", PLUGIN):
        if not needed.exists():
            print(f"SKIPPED: {needed} is not installed", file=sys.stderr)
            sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[6:], verbosity=2)
