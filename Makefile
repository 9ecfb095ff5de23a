# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# Thin: every target is one or two commands that can be typed by hand. CMakePresets.json holds the build settings.
JOBS ?= $(shell nproc)
FUZZ_SECONDS ?= 60

.DEFAULT_GOAL := help
.PHONY: help deps build demo paper pictures test check slim bench build-time sanitizers coverage fuzz fuzz-smoke image format
.PHONY: lint tidy clean

help: ## This list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## */\1\t/' | expand -t 12

deps: ## Install the Debian packages that are missing
	@scripts/install_dependencies.sh build server baselines plots

build: ## Build everything; the executables are in build/release/bin
	cmake --preset release
	cmake --build --preset release -j $(JOBS)

demo: deps ## Simulate a rover's drive, register its scans, draw the report into out/demo
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target bin/curvereg bin/curvereg-server
	scripts/demo.sh

paper: deps ## The paper's tables and figures for its method, its baselines and ours, into out/paper (an hour)
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target bin/curvereg
	scripts/paper.sh

pictures: deps ## Draw the pictures of docs/method.md again, and print the figures beside them (a minute)
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target bin/curvereg
	scripts/method_pictures.sh

test: deps build ## Build and run every test
	ctest --test-dir build/release --output-on-failure --no-tests=error -j $(JOBS)

check: ## What CI runs, and clang-tidy on what changed, the build without PCL and gRPC, a fuzz smoke (an hour)
	.ci/run all

slim: ## Build without PCL, gRPC and precompiled headers, and run the tests that are left
	@scripts/install_dependencies.sh build
	cmake --preset slim
	cmake --build --preset slim -j $(JOBS)
	ctest --preset slim -j $(JOBS) -L unit

coverage: ## Build with coverage, run the unit tests, print the share of lines per folder
	@scripts/install_dependencies.sh build server baselines
	scripts/coverage.sh $(JOBS)

build-time: ## Processor time of clean builds here and of commit BASE, one after the other (an hour)
	scripts/build_time.sh $(BASE)

bench: build ## Run the benchmarks; what they print is kept in out/bench
	scripts/bench.sh build/release/bench out/bench

sanitizers: ## Run every test under ASan and UBSan, and the server's under TSan (hours); scripts/sanitizers.sh last: the record
	@scripts/install_dependencies.sh build server
	scripts/sanitizers.sh asan $(JOBS)
	scripts/sanitizers.sh tsan $(JOBS)

fuzz: ## Fuzz every file reader and message decoder for FUZZ_SECONDS (60) each; needs clang
	@scripts/install_dependencies.sh build server fuzz
	cmake --preset fuzz
	cmake --build --preset fuzz -j $(JOBS) --target fuzzers
	scripts/fuzz.sh build/fuzz $(FUZZ_SECONDS)

fuzz-smoke: ## The same, FUZZ_SECONDS=5 each
	$(MAKE) fuzz FUZZ_SECONDS=5

image: ## Build the container image with docker, buildah or podman
	scripts/build_image.sh --jobs $(JOBS)

format: ## Format the sources in place
	@scripts/install_dependencies.sh format
	git ls-files '*.h' '*.cc' | xargs clang-format -i

lint: ## Check format, licence lines, paths, documents and layout (seconds)
	@scripts/install_dependencies.sh format
	scripts/lint.sh

tidy: ## Run clang-tidy on the sources that differ from BASE (default: all of them)
	@scripts/install_dependencies.sh build lint
	cmake --preset dev
	scripts/tidy.sh build/dev $(BASE)

clean: ## Remove what was built and drawn
	rm -rf build out
