// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The contract as a Node program speaks it, with @grpc/grpc-js, against the real server.
//
// usage: node client_test.js SERVER CURVEREG PROTO_ROOT GRPC_PROTO_ROOT    (NODE_PATH holds the packages)
'use strict';
const assert = require('node:assert/strict');
const { createHash } = require('node:crypto');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const grpc = require('@grpc/grpc-js');
const protoLoader = require('@grpc/proto-loader');
const { crc32c, simulate, startServer } = require('./service.js');

const [serverProgram, curvereg, protoRoot, grpcProtoRoot] = process.argv.slice(2);
const CHUNK_BYTES = 4096;
// Numbers of 64 bits come as strings, for they do not fit into JavaScript's.
const definition = protoLoader.loadSync(
  ['curvereg/v1/registration_service.proto', 'curvereg/v1/scan_service.proto', 'google/rpc/error_details.proto',
    'google/rpc/status.proto', 'grpc/health/v1/health.proto'],
  { includeDirs: [protoRoot, grpcProtoRoot], keepCase: true, longs: String, enums: String, defaults: true, oneofs: true });
const api = grpc.loadPackageDefinition(definition);

let folder, server, clouds, positions, registration, scans, health;

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'curvereg_node_'));
  ({ clouds, positions } = simulate(curvereg, path.join(folder, 'yard')));
  server = await startServer(serverProgram, folder);
  const credentials = grpc.credentials.createInsecure();
  registration = new api.curvereg.v1.RegistrationService(server.address, credentials);
  scans = new api.curvereg.v1.ScanService(server.address, credentials);
  health = new api.grpc.health.v1.Health(server.address, credentials);
});

after(async () => {
  for (const client of [registration, scans, health]) client?.close();
  const status = await server?.stop();
  const log = server?.log();
  fs.rmSync(folder, { recursive: true });
  assert.equal(status, 0, log);
});

const deadline = () => ({ deadline: Date.now() + 60_000 });
const unary = (client, method, request) => new Promise((resolve, reject) => {
  client[method](request, deadline(), (error, response) => (error ? reject(error) : resolve(response)));
});

// The answers of a stream one by one; an error of the call is thrown.
const answers = (call) => call[Symbol.asyncIterator]();

function header(cloud) {
  const fields = ['x', 'y', 'z'].map((name, i) => ({ name, offset: 4 * i, type: 'NUMERIC_TYPE_FLOAT32' }));
  return { frame_id: 'mast', point_count: cloud.length / 12, encoding: 'POINT_ENCODING_RAW',
    layout: { fields, point_stride: 12 } };
}
const inline = (cloud) => ({ inline_scan: { header: header(cloud), data: cloud } });

function start(upload, cloud) {
  const value = createHash('sha256').update(cloud).digest();
  return { start: { upload, header: header(cloud), payload_bytes: cloud.length,
    payload_digest: { algorithm: 'DIGEST_ALGORITHM_SHA256', value } } };
}
function chunk(cloud, offset) {
  const data = cloud.subarray(offset, offset + CHUNK_BYTES);
  return { chunk: { offset, data, crc32c: crc32c(data) } };
}

// Sends what is missing; returns the offset it went on from and `done`.
async function upload(name, cloud) {
  const call = scans.UploadScan(deadline());
  const incoming = answers(call);
  call.write(start(name, cloud));
  const first = (await incoming.next()).value;
  if (first.done) return { resumedAt: cloud.length, done: first.done };
  const resumedAt = Number(first.ready.committed_offset);
  for (let offset = resumedAt; offset < cloud.length; offset += CHUNK_BYTES) call.write(chunk(cloud, offset));
  call.write({ finish: {} });
  call.end();
  let last;
  for await (const answer of incoming) last = answer;
  return { resumedAt, done: last.done };
}

// Sends a part of the scan and breaks the stream off once the server has `wanted` bytes.
async function uploadUntilCut(name, cloud, wanted) {
  const call = scans.UploadScan(deadline());
  const incoming = answers(call);
  call.write(start(name, cloud));
  for (let offset = Number((await incoming.next()).value.ready.committed_offset); offset < wanted; offset += CHUNK_BYTES) {
    call.write(chunk(cloud, offset));
  }
  while (Number((await incoming.next()).value.progress.committed_offset) < wanted);
  call.cancel();
  await assert.rejects(incoming.next(), { code: grpc.status.CANCELLED });
}

// Details of one kind from grpc-status-details-bin.
function details(error, kind) {
  const status = definition['google.rpc.Status'].deserialize(error.metadata.get('grpc-status-details-bin')[0]);
  assert.equal(status.code, error.code);
  return status.details.filter((any) => any.type_url === `type.googleapis.com/${kind}`)
    .map((any) => definition[kind].deserialize(any.value));
}

async function assertFails(code, reason, promise) {
  const error = await promise.then(() => assert.fail('no error'), (raised) => raised);
  assert.equal(error.code, code, error);
  const infos = details(error, 'google.rpc.ErrorInfo');
  assert.deepEqual(infos.map((info) => [info.domain, info.reason]), [['curvereg', reason]]);
  return error;
}

// Steps are straight enough that the distance of the scans tells a right answer from a wrong one.
function assertNearTruth(pose) {
  const step = Math.hypot(...positions[1].map((value, i) => value - positions[0][i]));
  assert.ok(Math.abs(Math.hypot(pose.translation.x, pose.translation.y, pose.translation.z) - step) < 0.1, pose);
}

test('registers inline scans', async () => {
  const { result } = await unary(registration, 'RegisterScans', { source: inline(clouds[1]), target: inline(clouds[0]) });
  assert.equal(result.verdict.accepted, true);
  assertNearTruth(result.t_target_source);
  assert.equal(Number(result.evidence.source_point_count), clouds[1].length / 12);
  assert.equal(result.covariance.upper_triangle.length, 21);
  const answer = await unary(registration, 'RegisterScans',
    { source: inline(clouds[1]), target: inline(clouds[0]), view: 'RESULT_VIEW_SUMMARY' });
  assert.equal(answer.answer, 'summary');
  assert.equal(answer.summary.accepted, true);
});

test('uploads, resumes after a cut, downloads, lists, deletes', async () => {
  const cloud = clouds[0];
  const wanted = 5 * CHUNK_BYTES;
  await uploadUntilCut('uploads/node-cut', cloud, wanted);
  const state = await unary(scans, 'GetUpload', { upload: 'uploads/node-cut' });
  assert.equal(Number(state.committed_offset), wanted);
  const { resumedAt, done } = await upload('uploads/node-cut', cloud);
  assert.equal(resumedAt, wanted);
  assert.equal(done.already_stored, false);
  const { name } = done.scan;
  assert.match(name, /^scans\/[0-9a-f]{32}$/);

  const again = await upload('uploads/node-again', cloud);
  assert.equal(again.done.already_stored, true);
  assert.equal(again.done.scan.name, name);

  for (const offset of [0, 12345]) {
    const pieces = [];
    let described;
    for await (const answer of scans.DownloadScan({ name, offset, chunk_bytes: CHUNK_BYTES }, deadline())) {
      if (answer.scan) {
        described = answer.scan;
      } else {
        assert.equal(answer.chunk.crc32c, crc32c(answer.chunk.data));
        pieces.push(answer.chunk.data);
      }
    }
    assert.deepEqual(described, done.scan);
    assert.ok(Buffer.concat(pieces).equals(cloud.subarray(offset)));
  }

  const { result } = await unary(registration, 'RegisterScans', { source: inline(clouds[1]), target: { name } });
  assertNearTruth(result.t_target_source);
  assert.equal(result.target_digest, done.scan.content_digest);

  const listed = await unary(scans, 'ListScans', {});
  assert.equal(listed.scans.filter((scan) => scan.name === name).length, 1);
  await unary(scans, 'DeleteScan', { name });
  await assertFails(grpc.status.NOT_FOUND, 'SCAN_NOT_FOUND', unary(scans, 'GetScan', { name }));
});

test('errors carry their details', async () => {
  const cut = inline(clouds[0]);
  cut.inline_scan.header.layout.point_stride = 8;
  const error = await assertFails(grpc.status.INVALID_ARGUMENT, 'INVALID_FIELD',
    unary(registration, 'RegisterScans', { source: inline(clouds[1]), target: cut }));
  const [badRequest] = details(error, 'google.rpc.BadRequest');
  assert.match(badRequest.field_violations[0].field, /^target\.inline_scan\.header\.layout/);
  const [requestInfo] = details(error, 'google.rpc.RequestInfo');
  assert.ok(requestInfo.request_id);
});

test('a corrupt chunk is refused', async () => {
  const corrupt = chunk(clouds[0], 0);
  corrupt.chunk.crc32c = (corrupt.chunk.crc32c ^ 1) >>> 0;
  const call = scans.UploadScan(deadline());
  call.write(start('uploads/node-corrupt', clouds[0]));
  call.write(corrupt);
  const receiveAll = async () => { for await (const answer of call) assert.ok(answer.ready); };
  await assertFails(grpc.status.DATA_LOSS, 'CHECKSUM_MISMATCH', receiveAll());
});

test('the services are healthy', async () => {
  for (const service of ['', 'curvereg.v1.RegistrationService', 'curvereg.v1.ScanService']) {
    assert.equal((await unary(health, 'Check', { service })).status, 'SERVING', service);
  }
});
