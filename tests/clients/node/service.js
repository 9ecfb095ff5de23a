// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the test of the Node client stands on: a real server, simulated scans, checksums.
'use strict';
const { execFileSync, spawn } = require('node:child_process');
const fs = require('node:fs');
const path = require('node:path');
const { setTimeout: sleep } = require('node:timers/promises');

// A curvereg-server on free loopback ports, with a data folder of its own.
async function startServer(program, folder) {
  const portsFile = path.join(folder, 'ports.json');
  const logFile = path.join(folder, 'server.log');
  const log = fs.openSync(logFile, 'w');
  const child = spawn(program, ['--listen', '127.0.0.1:0', '--ops-listen', '127.0.0.1:0', '--data-dir',
    path.join(folder, 'data'), '--drain-delay-ms', '0', '--grace-seconds', '5', '--ports-file', portsFile],
    { stdio: ['ignore', log, log] });
  const exited = new Promise((resolve) => child.on('exit', (code, signal) => resolve(code ?? signal)));
  const deadline = Date.now() + 60_000;
  while (!fs.existsSync(portsFile)) {
    if (child.exitCode !== null || Date.now() > deadline) {
      child.kill('SIGKILL');
      throw new Error(`the server did not start:\n${fs.readFileSync(logFile, 'utf8')}`);
    }
    await sleep(20);
  }
  return {
    address: `127.0.0.1:${JSON.parse(fs.readFileSync(portsFile, 'utf8')).grpc_port}`,
    log: () => fs.readFileSync(logFile, 'utf8'),
    stop: () => { child.kill('SIGTERM'); return exited; }, // resolves to the exit status
  };
}

// Two small scans three metres apart: the packed float32 x y z of each, and the positions they were taken from.
function simulate(curvereg, folder) {
  execFileSync(curvereg, ['simulate', '--out', folder, '--preset', 'sparse', '--scans', '2', '--columns', '700',
    '--rows', '40', '--step', '3', '--threads', '1']);
  const clouds = ['0000.pcd', '0001.pcd'].map((name) => {
    const file = fs.readFileSync(path.join(folder, name));
    const marker = 'DATA binary\n';
    return file.subarray(file.indexOf(marker) + marker.length);
  });
  const lines = fs.readFileSync(path.join(folder, 'poses.txt'), 'utf8').trim().split('\n');
  const positions = lines.filter((line) => !line.startsWith('#')).map((line) => line.split(' ').slice(1, 4).map(Number));
  return { clouds, positions };
}

const table = Array.from({ length: 256 }, (_, value) => {
  for (let bit = 0; bit < 8; ++bit) value = (value >>> 1) ^ (value & 1 ? 0x82f63b78 : 0);
  return value >>> 0;
});

// CRC-32C (Castagnoli).
function crc32c(data) {
  let value = 0xffffffff;
  for (const byte of data) value = (value >>> 8) ^ table[(value ^ byte) & 0xff];
  return (value ^ 0xffffffff) >>> 0;
}

module.exports = { startServer, simulate, crc32c };
