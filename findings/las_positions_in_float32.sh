#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# @loaders.gl/las 4.3.4 (a LAS reader for the browser and Node): positions are 32-bit floats by default.
#
# The usual guess: LAS stores integers with scale and offset, often in millimetres, and a reader returns them with that
# resolution.
# Observed: the reader adds the file's offset and stores the absolute coordinates as float32, without a warning. In UTM the
# northing has seven digits before the point, where a float32 has steps of 0.25 or 0.5 m. A smooth surface becomes terraces.
# `las: {fp64: true}` returns the exact values.
#
# Why it matters: two scans read like this align to the terraces instead of the ground. The error of 0.25 m is not visible in
# a viewer that covers kilometres.
# What to do: ask for doubles, subtract a local origin, and only then convert to floats. The same holds for other readers:
# check the type of the coordinates, not only their values.
set -euo pipefail

core=@loaders.gl/core@4.3.4 las=@loaders.gl/las@4.3.4
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  echo 'cannot be shown: node and npm are needed' && exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true, "type": "module"}' >package.json
if ! npm install --silent --no-audit --no-fund --ignore-scripts --cache "$work/cache" "$core" "$las" >npm.log 2>&1; then
  echo "cannot be shown: npm cannot install $core and $las: $(tail -n 1 npm.log)" && exit 77
fi

cat >show.js <<'C'
import {parse} from '@loaders.gl/core';
import {LASLoader} from '@loaders.gl/las';

// A valid LAS 1.2 file of point format 0: points in a square of 20 m in UTM, resolution 1 mm.
const numPoints = 1000, headerBytes = 227, pointBytes = 20;
const offset = [500000, 4649776, 120], scale = 0.001;
const file = Buffer.alloc(headerBytes + pointBytes * numPoints);
file.write('LASF', 0);
file[24] = 1;
file[25] = 2;
file.writeUInt16LE(headerBytes, 94);
file.writeUInt32LE(headerBytes, 96);  // offset of the points
file[104] = 0;                        // point format
file.writeUInt16LE(pointBytes, 105);
file.writeUInt32LE(numPoints, 107);
file.writeUInt32LE(numPoints, 111);   // points by return
const points = [];
let state = 1;
for (let i = 0; i < numPoints; ++i) {
  points.push([0, 1, 2].map((axis) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    const integer = Math.floor(state / 4294967296 * 20000);
    file.writeInt32LE(integer, headerBytes + pointBytes * i + 4 * axis);
    return integer * scale + offset[axis];
  }));
}
for (let axis = 0; axis < 3; ++axis) {
  file.writeDoubleLE(scale, 131 + 8 * axis);
  file.writeDoubleLE(offset[axis], 155 + 8 * axis);
  file.writeDoubleLE(Math.max(...points.map((point) => point[axis])), 179 + 16 * axis);
  file.writeDoubleLE(Math.min(...points.map((point) => point[axis])), 187 + 16 * axis);
}

async function read(title, las) {
  const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.length);
  const {value} = (await parse(bytes, LASLoader, {worker: false, las})).attributes.POSITION;
  const error = [0, 0, 0], distinct = [new Set(), new Set(), new Set()];
  points.forEach((point, i) => point.forEach((coordinate, axis) => {
    error[axis] = Math.max(error[axis], Math.abs(value[3 * i + axis] - coordinate));
    distinct[axis].add(value[3 * i + axis]);
  }));
  console.log(`${title}: ${value.constructor.name}, largest error ${error.map((e) => e.toFixed(4)).join(' ')} m, ` +
              `distinct values ${distinct.map((set) => set.size).join(' ')} of ${numPoints} points (x y z)`);
  return {error, distinct: distinct.map((set) => set.size)};
}

const byDefault = await read('by default', {});
const doubles = await read('las: {fp64: true}', {fp64: true});
const asDescribed = byDefault.error[1] > 0.2 && byDefault.distinct[1] < 50 && Math.max(...doubles.error) < 1e-6;
process.exit(asDescribed ? 0 : 1);
C
echo "$(node -p "const p = JSON.parse(require('fs').readFileSync('node_modules/@loaders.gl/las/package.json')); p.name + ' ' + p.version") with node $(node --version)"
if node show.js; then echo 'as described'; else echo 'NOT as described' && exit 1; fi
