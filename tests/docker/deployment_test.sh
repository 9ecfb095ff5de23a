#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# The files beside the image: Prometheus takes its configuration, each alarm is raised by its cause and no other time,
# compose takes its file. Skipped (status 77) without promtool.
set -euo pipefail
cd "$(dirname "$0")/../.."

if ! command -v promtool >/dev/null; then
  echo 'SKIPPED: promtool is not installed (scripts/install_dependencies.sh server)' >&2
  exit 77
fi
promtool check config docker/prometheus.yml
promtool test rules tests/docker/alerts_test.yml

# Every alarm is raised in some test: its name comes with labels.
sed -nE 's/^ *- alert: //p' docker/alerts.yml | while read -r alert; do
  grep -A 2 "alertname: $alert\$" tests/docker/alerts_test.yml | grep -q exp_labels ||
    { echo "FAILED: no test raises $alert" >&2; exit 1; }
done

if command -v docker-compose >/dev/null; then
  docker-compose -f docker/compose.yaml config -q
elif command -v docker >/dev/null && docker compose version >/dev/null 2>&1; then
  docker compose -f docker/compose.yaml config -q
else
  echo 'compose.yaml was not checked: there is no docker-compose'
fi
